// A frequency setting input: first-order filter and a line through bias and gain points.
#pragma once

#include <algorithm>

#include "sim/base/archive.hpp"

namespace vinv::inverter {

struct AnalogLine {
  double bias_percent = 0;  // of full scale
  double bias_hz = 0;
  double gain_percent = 100;
  double gain_hz = 50;

  // Frequency at an input in percent of full scale; never negative. Points too close together give a step.
  double frequency(double percent) const {
    const double span = gain_percent - bias_percent;
    if (span < 0.1 && span > -0.1) return percent >= gain_percent ? gain_hz : bias_hz;
    return std::max(0.0, bias_hz + (gain_hz - bias_hz) * (percent - bias_percent) / span);
  }
};

struct AnalogFilter {
  double output = 0;

  double step(double input, double period_s, double time_constant_s) {
    output += (input - output) * std::min(1.0, period_s / std::max(time_constant_s, period_s));
    return output;
  }
  VINV_ARCHIVE(AnalogFilter, output);
};

}  // namespace vinv::inverter
