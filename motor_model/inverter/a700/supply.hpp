// What an FR-A700 remembers of its supply functions; lost with the control supply.
#pragma once

#include "motor_model/drive/load_speed.hpp"
#include "motor_model/drive/power_failure_stop.hpp"
#include "motor_model/drive/regeneration_avoidance.hpp"
#include "motor_model/drive/voltage_saving.hpp"
#include "motor_model/inverter/a700/commercial_switch.hpp"
#include "motor_model/inverter/a700/saving_monitor.hpp"

namespace vinv::inverter::a700 {

struct Supply {
  drive::PowerFailureStop failure_stop;
  drive::OnDelay phase_lost;
  CommercialSwitch contactors;
  bool drives_contactors = false;  // it has put the motor somewhere
  bool operation_enabled = false;  // MRS, as the switch-over takes it
  bool inverter_wanted = false;    // CS, likewise
  double last_direction = 1;
  drive::RegenerationAvoidance regeneration;
  drive::VoltageSaving voltage_saving;
  SavingMonitor saving;
  drive::LoadSpeed load_speed;
  bool by_load = false;  // this run's speed follows its load (X19 was on at the start)
  VINV_ARCHIVE(Supply, failure_stop, phase_lost, contactors, drives_contactors, operation_enabled, inverter_wanted,
               last_direction, regeneration, voltage_saving, saving, load_speed, by_load);
};

}  // namespace vinv::inverter::a700
