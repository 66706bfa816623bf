// The motor that runs: the first one (Pr.71, 80 to 94, 800) or with RT the second one (Pr.450 to 463), its control
// method, and what both come to in the control core. Typical for the family.
#pragma once

#include "motor_model/drive/drive_types.hpp"
#include "motor_model/inverter/mitsubishi/settings.hpp"

namespace vinv::inverter::a700 {

// Parameters that each motor has.
struct MotorNumbers {
  unsigned applied, method, capacity, poles, exciting_current, voltage, frequency;
  unsigned r1, r2, l1, l2, x, tuning, torque_current, speed_gain, thermal;
  unsigned p_gain, integral, speed_filter, torque_filter;
};
const MotorNumbers& motor_numbers(bool second);

enum class ControlMethod : std::uint8_t { kVf, kFluxVector, kSpeed, kTorque };

struct MotorSelection {
  bool second = false;  // RT chose the second motor
  bool vf_by_x18 = false;
  bool torque_by_mc = false;  // signal MC
};

ControlMethod control_method(const ParameterStore& parameters, const MotorSelection& selection);
// Methods that need an encoder: their option is not fitted.
bool needs_encoder(unsigned number, int raw);

// Changes what the common settings assume of the first motor; vector control where it is on. motor_start_s: rest to
// rated speed with the rated torque, of the motor alone.
void set_motor(drive::DriveSettings& settings, const ParameterStore& parameters, const MotorSelection& selection,
               const mitsubishi::SettingsSurroundings& around, double motor_start_s);

// Pr.22 and Pr.812 to 815; with TL (Pr.815) one for all.
void set_torque_limits(drive::VectorSettings& vector, const ParameterStore& parameters, bool by_tl);

// Pr.821 or 831.
double speed_integral_s(const ParameterStore& parameters, bool second);

// Torque of the motor's name plate.
double rated_torque_nm(const ParameterStore& parameters, const MotorNumbers& motor, double slip_share);

}  // namespace vinv::inverter::a700
