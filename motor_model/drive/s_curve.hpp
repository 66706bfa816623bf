// Closed forms of the S-shaped ramps.
#pragma once

namespace vinv::drive {

// S-curve A (E500 Pr.29 = 1; main spindles): the inflection is at the base frequency fb, which is reached from 0 Hz
// after T; above it t = 4/9 T (f/fb)^2 + 5/9 T. Both functions are monotonous and each other's inverse. Unspecified:
// the shape below fb. Chosen: a parabola up to fb/8, then straight with the slope that the curve above fb starts with,
// 9/8 fb/T; this reaches fb after exactly T. frequency_hz, time_s >= 0; total_s, base_hz > 0.
double s_curve_a_time_s(double frequency_hz, double total_s, double base_hz);
double s_curve_a_frequency_hz(double time_s, double total_s, double base_hz);

// S-curve B (E500 Pr.29 = 2; conveyors): half a cosine between present and target frequency, in the time that the
// straight ramp would take. Remaining fraction of the change at progress 0 ... 1.
double s_curve_b_remaining(double progress);

// S-curve C (A700 Pr.29 = 4): the rate rises and falls evenly at both ends. Remaining fraction of the change at
// progress 0 ... 1; share of the whole time that each end takes, 0 ... 0.5.
double s_curve_c_remaining(double progress, double share);

// S-curve D (A700 Pr.29 = 5): as C with a time of its own for each end, in addition to half of which the straight ramp
// takes its time. A way too short for both is rounded with the same slope of the rate.
struct SCurveD {
  double total_s = 0;
  double begin_share = 0;  // of the whole time
  double end_share = 0;
};
// straight_s: what the straight ramp would take for this way.
SCurveD s_curve_d_of(double straight_s, double begin_s, double end_s);
double s_curve_d_remaining(double progress, const SCurveD& curve);

}  // namespace vinv::drive
