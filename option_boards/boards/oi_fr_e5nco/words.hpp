// Words that the board exchanges with any master: command, status, alarms, speed in rpm. The same on Modbus and
// CANopen. OI-FR-E5NCO manual: 8.7.4 and 6.2.4.1 command, 8.7.5 and 6.2.4.2 status, 8.7.2 and 6.2.3 alarms, 8.7.7 speed
// in rpm.
#pragma once

#include <cstdint>

#include "motor_model/port/drive_port.hpp"

namespace vinv::boards::oi_fr_e5nco {

inline constexpr std::uint32_t kMaxWord = 0xffff;

// Bits without a meaning in the table are ignored.
port::NetTerminals terminals_of_command(std::uint16_t raw_command);
// Deviation: the table of 8.7.5 has a dash at bit 15, its sample 804BH has the bit set; sister models have READY there.
std::uint16_t raw_status(const port::Status& status);

// Two alarms a word, the newer in the low byte. pair: 0-3, 0 has the newest.
std::uint16_t raw_alarm_pair(const port::AlarmHistory& history, std::size_t pair);

// The number of poles that the formula of 8.7.7 uses for a value of Pr.144.
// Unspecified: what 0 and values above 100 mean. As on sister models: 0 is 4 poles, 102-110 is 2-10 poles.
std::uint32_t poles_of(std::uint32_t raw_pr144);
std::uint32_t poles_of(const port::DrivePort& drive);
// speed [0.01 Hz] = speed [rpm] * ((10 * poles) / 4) / 3, each division rounding down; may exceed 16 bits.
std::uint32_t raw_frequency_of_rpm(std::uint32_t rpm, std::uint32_t poles);
// The inverse, rounding down; saturates at 65535.
std::uint16_t rpm_of_raw_frequency(std::uint32_t raw_frequency, std::uint32_t poles);
// The rpm that gives this frequency, so that a value read is the value written; saturates at 65535.
std::uint16_t nearest_rpm_of_raw_frequency(std::uint32_t raw_frequency, std::uint32_t poles);

}  // namespace vinv::boards::oi_fr_e5nco
