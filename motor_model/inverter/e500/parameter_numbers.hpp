// FR-E500 parameter numbers by name (motor_model/families/mitsubishi_e500/parameters.csv).
#pragma once

#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::e500::pr {

using namespace mitsubishi::pr;

enum : unsigned {
  kPattern = 29,
  kRegenerative = 30,
  kVoltageInputGain = 38,
  kCurrentInputGain = 39,
  kSecondThermal = 48,
  kShortestMode = 60,
  kShortestReference = 61,
  kShortestAcceleration = 62,
  kShortestDeceleration = 63,
  kBrakeDuty = 70,
  kVoltageRange = 73,
  kAmSelection = 158,
  kGroup1Add = 173,
  kGroup1Remove = 174,
  kGroup2Add = 175,
  kGroup2Remove = 176,
  kRlFunction = 180,
  kRmFunction = 181,
  kRhFunction = 182,
  kMrsFunction = 183,
  kRunFunction = 190,
  kFuFunction = 191,
  kAbcFunction = 192,
  kEarthFaultAtStart = 249,
  kAmCalibration = 901,
};

}  // namespace vinv::inverter::e500::pr
