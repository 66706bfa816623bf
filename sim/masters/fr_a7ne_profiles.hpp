// Profiles of the FR-A7NE on EtherNet/IP: by the I/O connection with one of the four pairs of assemblies, or by
// explicit messages alone. Sections are those of the FR-A7NE manual.
#pragma once

#include <array>

#include "sim/masters/eip_item.hpp"
#include "sim/masters/profile.hpp"

namespace vinv::masters::fr_a7ne {

namespace detail {

using enum Word;
using enum Act;
using enum Operand;
using eip::attribute;
using eip::image;
using eip::image_bits;
using eip::item;
using eip::ItemKind;

inline constexpr unsigned kRestartTime = 5000;  // ms; a reset takes about 1 s (4.6), then connections are made anew
inline constexpr double kHzPerRpm = 1.0 / 30;   // four poles (4.7): Pr.37 = 0 and Pr.144 = 4 or 0
inline constexpr std::uint32_t kForward = 0x01, kReverse = 0x02, kResetBit = 0x04, kNetCtrl = 0x20, kNetRef = 0x40;
// Of byte 0, what run, stop and fault reset set; in output 20 there is no permission bit.
inline constexpr std::uint32_t kControlBits = kForward | kReverse | kResetBit | kNetCtrl,
                               kControlBits20 = kForward | kResetBit;

constexpr ProfileStep connection(Word word) {
  return {.word = word, .item = item(ItemKind::kConnection), .source = "7.3"};
}
constexpr ProfileStep produce(Word word) {
  return {.word = word, .item = item(ItemKind::kProduction), .source = "6.2.1"};
}
constexpr ProfileStep bits(Word word, std::uint32_t mask, std::uint32_t value) {
  return {.word = word, .act = kOutput, .item = image_bits(0, mask), .size = 1, .constant = value, .source = "7.2.1"};
}
constexpr ProfileStep speed(Word word) {
  return {.word = word,
          .act = kOutput,
          .item = image(2),
          .operand = word == kReferenceHz ? kHz : kRpm,
          .scale = word == kReferenceHz ? kHzPerRpm : 1,
          .source = "7.2.1"};
}
constexpr ProfileStep set(Word word, Item where, std::uint32_t value, std::string_view source, std::uint8_t size = 2) {
  return {.word = word, .item = where, .size = size, .constant = value, .source = source};
}
inline constexpr Item kMode = attribute(0x2A, 1, 120);
constexpr ProfileStep await_mode(Word word, std::uint32_t mode) {
  return {.word = word, .act = kAwait, .item = kMode, .constant = mode, .time_ms = 1000, .source = "7.6"};
}
inline constexpr ProfileStep enter = set(kEnterNetwork, kMode, 0x14, "7.6"), entered = await_mode(kEnterNetwork, 4),
                             leave = set(kLeaveNetwork, kMode, 0x10, "7.6"), left = await_mode(kLeaveNetwork, 0);
inline constexpr ProfileStep clear_alarms = set(kClearAlarms, attribute(0x2A, 1, 141), 0, "7.6");
inline constexpr ProfileStep reset_inverter = set(kReset, attribute(0x2A, 1, 101), 1, "4.6");
// It is ready until the reset has begun.
constexpr ProfileStep begun(Word word) { return {.word = word, .act = kListen, .time_ms = 50, .source = "4.6"}; }
constexpr ProfileStep await_ready(Word word) {
  return {.word = word,
          .act = kAwait,
          .item = attribute(0x29, 1, 9),
          .size = 1,
          .constant = 1,
          .mask = 1,
          .time_ms = kRestartTime,
          .source = "7.5"};
}

// By I/O: mode, parameters, monitors and the inverter reset are explicit messages. What the image says from a reset on
// must not start the motor again by itself.
inline constexpr ProfileStep kIoSteps[] = {
    enter,
    entered,
    leave,
    left,
    connection(kRunForward),
    bits(kRunForward, kControlBits, kNetCtrl | kForward),
    produce(kRunForward),
    connection(kRunReverse),
    bits(kRunReverse, kControlBits, kNetCtrl | kReverse),
    produce(kRunReverse),
    connection(kStop),
    bits(kStop, kControlBits, kNetCtrl),
    produce(kStop),
    connection(kReferenceHz),
    speed(kReferenceHz),
    bits(kReferenceHz, kNetRef, kNetRef),
    produce(kReferenceHz),
    connection(kReferenceRpm),
    speed(kReferenceRpm),
    bits(kReferenceRpm, kNetRef, kNetRef),
    produce(kReferenceRpm),
    connection(kFaultReset),
    bits(kFaultReset, kControlBits, kNetCtrl),
    produce(kFaultReset),
    bits(kFaultReset, kControlBits, kNetCtrl | kResetBit),
    produce(kFaultReset),
    bits(kFaultReset, kControlBits, kNetCtrl),
    begun(kFaultReset),
    await_ready(kFaultReset),
    bits(kReset, kControlBits, kNetCtrl),
    reset_inverter,
    begun(kReset),
    await_ready(kReset),
    clear_alarms,
};
inline constexpr ProfileStep kIo20Steps[] = {
    enter,
    entered,
    leave,
    left,
    connection(kRunForward),
    bits(kRunForward, kControlBits20, kForward),
    produce(kRunForward),
    connection(kStop),
    bits(kStop, kControlBits20, 0),
    produce(kStop),
    connection(kReferenceHz),
    speed(kReferenceHz),
    produce(kReferenceHz),
    connection(kReferenceRpm),
    speed(kReferenceRpm),
    produce(kReferenceRpm),
    connection(kFaultReset),
    bits(kFaultReset, kControlBits20, 0),
    produce(kFaultReset),
    bits(kFaultReset, kControlBits20, kResetBit),
    produce(kFaultReset),
    bits(kFaultReset, kControlBits20, 0),
    begun(kFaultReset),
    await_ready(kFaultReset),
    bits(kReset, kControlBits20, 0),
    reset_inverter,
    begun(kReset),
    await_ready(kReset),
    clear_alarms,
};
// Run command, 7.6: bit 1 STF, bit 2 STR.
inline constexpr ProfileStep kExplicitSteps[] = {
    enter,
    entered,
    leave,
    left,
    set(kRunForward, attribute(0x2A, 1, 114), 2, "7.6"),
    set(kRunReverse, attribute(0x2A, 1, 114), 4, "7.6"),
    set(kStop, attribute(0x2A, 1, 114), 0, "7.6"),
    {.word = kReferenceHz, .item = attribute(0x2A, 1, 112), .operand = kHz, .scale = 0.01, .source = "7.6"},
    {.word = kReferenceRpm, .item = attribute(0x2A, 1, 8), .operand = kRpm, .source = "7.6"},
    set(kFaultReset, attribute(0x29, 1, 12), 0, "7.5", 1),
    set(kFaultReset, attribute(0x29, 1, 12), 1, "7.5", 1),
    begun(kFaultReset),
    await_ready(kFaultReset),
    reset_inverter,
    begun(kReset),
    await_ready(kReset),
    clear_alarms,
};

// Classes 0x70 to 0x79: a hundred parameters each, the first at attribute 10. Instance 2 of the last one: analog
// values.
constexpr ParameterRule hundred(std::uint16_t n, std::uint16_t count, ItemKind kind = ItemKind::kAttribute) {
  return {static_cast<std::uint16_t>(100 * n),
          static_cast<std::uint16_t>(100 * n + count - 1),
          item(kind, attribute(0x70u + n, 1, 10)),
          1,
          0,
          0,
          "7.12.1"};
}
// With sub 1 or 2 the item is the base plus the sub.
constexpr ParameterRule calibration(std::uint8_t sub, ItemKind kind = ItemKind::kAttribute) {
  return {900, 939, item(kind, attribute(0x79, sub, 10) - sub), 1, sub, sub, "7.12.1"};
}
inline constexpr ParameterRule kParameters[] = {
    hundred(0, 100), hundred(1, 100), hundred(2, 100), hundred(3, 100), hundred(4, 100), hundred(5, 100),
    hundred(6, 100), hundred(7, 100), hundred(8, 100), calibration(1),  calibration(2),  hundred(9, 100),
};
constexpr ItemKind kByIo = ItemKind::kParameter;
inline constexpr ParameterRule kIoParameters[] = {
    hundred(0, 100, kByIo), hundred(1, 100, kByIo), hundred(2, 100, kByIo), hundred(3, 100, kByIo),
    hundred(4, 100, kByIo), hundred(5, 100, kByIo), hundred(6, 100, kByIo), hundred(7, 100, kByIo),
    hundred(8, 100, kByIo), calibration(1, kByIo),  calibration(2, kByIo),  hundred(9, 100, kByIo),
};

// 7.6, 7.13; units of models up to 55K.
struct Monitor {
  std::string_view name;
  std::uint8_t number;
  double scale;
  std::string_view unit;
};
inline constexpr Monitor kMonitors[] = {
    {"output_frequency", 1, 0.01, "Hz"},
    {"output_current", 2, 0.01, "A"},
    {"output_voltage", 3, 0.1, "V"},
    {"set_frequency", 5, 0.01, "Hz"},
    {"speed", 6, 1, "rpm"},
    {"torque", 7, 0.1, "%"},
    {"dc_link", 8, 0.1, "V"},
    {"brake_duty", 9, 0.1, "%"},
    {"motor_thermal", 10, 0.1, "%"},
    {"peak_current", 11, 0.01, "A"},
    {"peak_dc_link", 12, 0.1, "V"},
    {"input_power", 13, 0.01, "kW"},
    {"output_power", 14, 0.01, "kW"},
    {"input_terminals", 15, 1, "-"},
    {"output_terminals", 16, 1, "-"},
    {"load_meter", 17, 0.1, "%"},
    {"excitation_current", 18, 0.01, "A"},
    {"energization_time", 20, 1, "h"},
    {"operation_time", 23, 1, "h"},
    {"load_factor", 24, 0.1, "%"},
    {"energy", 25, 1, "kWh"},
};
inline constexpr Monitor kMoreMonitors[] = {
    {"torque_command", 32, 0.1, "%"}, {"torque_current", 33, 0.1, "%"}, {"motor_output", 34, 0.01, "kW"},
    {"pid_set_point", 52, 0.1, "%"},  {"pid_measured", 53, 0.1, "%"},   {"pid_deviation", 54, 0.1, "%"},
};
inline constexpr MonitorRow kOtherRows[] = {
    {.name = "speed_actual", .item = attribute(0x2A, 1, 7), .unit = "rpm", .source = "7.6"},
    {.name = "status", .item = attribute(0x2A, 1, 114), .unit = "-", .source = "7.6"},
    {.name = "mode", .item = attribute(0x2A, 1, 120), .unit = "-", .source = "7.6"},
    {.name = "alarm", .item = attribute(0x2A, 1, 141), .unit = "-", .mask = 0xff, .source = "7.6"},
    {.name = "state", .item = attribute(0x29, 1, 6), .size = 1, .unit = "-", .mask = 0xff, .source = "7.5"},
    {.name = "control_from_net", .item = attribute(0x29, 1, 15), .size = 1, .unit = "-", .mask = 1, .source = "7.5"},
    {.name = "reference_from_net", .item = attribute(0x2A, 1, 29), .size = 1, .unit = "-", .mask = 1, .source = "7.6"},
};
inline constexpr std::size_t kMonitorRows = std::size(kMonitors) + std::size(kMoreMonitors) + std::size(kOtherRows);
// Monitor n is attribute 10 + n of class 0x80; by I/O its number is the selection.
constexpr std::array<MonitorRow, kMonitorRows> monitor_rows(bool by_io) {
  std::array<MonitorRow, kMonitorRows> rows{};
  std::size_t at = 0;
  const auto add = [&](const Monitor& m) {
    rows[at++] = {.name = m.name,
                  .item = by_io ? item(ItemKind::kMonitor, m.number) : attribute(0x80, 1, 10u + m.number),
                  .scale = m.scale,
                  .unit = m.unit,
                  .source = by_io ? "7.2.1" : "7.13.1"};
  };
  for (const Monitor& m : kMonitors) add(m);
  for (const Monitor& m : kMoreMonitors) add(m);
  for (const MonitorRow& row : kOtherRows) rows[at++] = row;
  return rows;
}
inline constexpr auto kExplicitMonitors = monitor_rows(false), kIoMonitors = monitor_rows(true);

inline constexpr std::uint16_t kInputOnly = 238, kListenOnly = 237;

}  // namespace detail

// By Pr.346: bits 2-6 the output, bits 7-11 the input (4.2.1).
inline constexpr BoardProfile k21{.board = "fr-a7ne",
                                  .protocol = "ethernet-ip",
                                  .steps = detail::kIoSteps,
                                  .parameters = detail::kParameters,
                                  .monitors = detail::kExplicitMonitors,
                                  .io = {21, 71, 4, 4, detail::kInputOnly, detail::kListenOnly}};
inline constexpr BoardProfile k20{.board = "fr-a7ne",
                                  .protocol = "ethernet-ip-20",
                                  .steps = detail::kIo20Steps,
                                  .parameters = detail::kParameters,
                                  .monitors = detail::kExplicitMonitors,
                                  .io = {20, 70, 4, 4, detail::kInputOnly, detail::kListenOnly}};
inline constexpr BoardProfile k126{.board = "fr-a7ne",
                                   .protocol = "ethernet-ip-126",
                                   .steps = detail::kIoSteps,
                                   .parameters = detail::kIoParameters,
                                   .monitors = detail::kExplicitMonitors,
                                   .io = {126, 176, 6, 6, detail::kInputOnly, detail::kListenOnly}};
inline constexpr BoardProfile k129{.board = "fr-a7ne",
                                   .protocol = "ethernet-ip-129",
                                   .steps = detail::kIoSteps,
                                   .parameters = detail::kParameters,
                                   .monitors = detail::kIoMonitors,
                                   .io = {129, 179, 6, 6, detail::kInputOnly, detail::kListenOnly}};
inline constexpr BoardProfile kExplicit{.board = "fr-a7ne",
                                        .protocol = "ethernet-ip-explicit",
                                        .steps = detail::kExplicitSteps,
                                        .parameters = detail::kParameters,
                                        .monitors = detail::kExplicitMonitors,
                                        .io = {21, 71, 4, 4, detail::kInputOnly, detail::kListenOnly}};

}  // namespace vinv::masters::fr_a7ne
