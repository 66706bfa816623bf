// Profiles of the boards that there are. Sections are those of the board's manual.
#pragma once

#include "sim/masters/profile.hpp"

namespace vinv::masters::oi_fr_e5nco {

namespace detail {

using enum Word;
using enum Act;
using enum Operand;

// Command word, 8.7.4 and 6.2.4: bit 0 STOP, 1 STF, 2 STR. Status word, 8.7.5: bit 15 ready.
inline constexpr std::uint32_t kStopCommand = 1, kForward = 2, kReverse = 4, kReady = 0x8000;
inline constexpr unsigned kRestartTime = 5000;  // ms; the inverter starts up in about one second

inline constexpr ProfileStep kModbusSteps[] = {
    {.word = kEnterNetwork, .item = 26000, .constant = 1, .source = "8.7.12"},
    {.word = kLeaveNetwork, .item = 26000, .constant = 0, .source = "8.7.12"},
    {.word = kRunForward, .item = 24000, .constant = kForward, .source = "8.7.4"},
    {.word = kRunReverse, .item = 24000, .constant = kReverse, .source = "8.7.4"},
    {.word = kStop, .item = 24000, .constant = kStopCommand, .source = "8.7.4"},
    {.word = kReferenceHz, .item = 24002, .operand = kHz, .scale = 0.01, .source = "8.7.6"},
    {.word = kReferenceRpm, .item = 24004, .operand = kRpm, .source = "8.7.7"},
    {.word = kReset, .item = 25002, .constant = 0, .source = "8.7.11"},
    {.word = kReset,
     .act = kAwait,
     .item = 24000,
     .constant = kReady,
     .mask = kReady,
     .time_ms = kRestartTime,
     .source = "8.7.5"},
    {.word = kClearAlarms, .item = 25000, .constant = 0, .source = "8.7.10"},
};
inline constexpr ParameterRule kModbusParameters[] = {
    {0, 901, 20000, 2, 0, 0, "8.7.1"},
    {906, 999, 21812, 2, 0, 0, "8.7.1"},
};
inline constexpr MonitorRow kModbusMonitors[] = {
    {.name = "output_frequency", .item = 23100, .scale = 0.01, .unit = "Hz", .source = "8.7.3"},
    {.name = "output_current", .item = 23102, .scale = 0.01, .unit = "A", .source = "8.7.3"},
    {.name = "output_voltage", .item = 23104, .scale = 0.1, .unit = "V", .source = "8.7.3"},
    {.name = "speed", .item = 24004, .unit = "rpm", .source = "8.7.7"},
    {.name = "status", .item = 24000, .source = "8.7.5"},
    {.name = "alarm", .item = 23000, .mask = 0xff, .source = "8.7.2"},
};
// 8.6.
inline constexpr CodeText kModbusExceptions[] = {
    {1, "function code unknown"},
    {2, "address not correct"},
    {3, "data not correct"},
    {4, "PLC not ready"},
    {5, "error in the writing"},
    {6, "overlap"},
    {11, "gateway target failed to respond"},
};

constexpr Item object(std::uint32_t index, std::uint32_t sub = 0) { return index << 8 | sub; }
constexpr Item rpdo(std::uint32_t number, std::uint32_t offset = 0) { return number << 8 | offset; }
inline constexpr std::uint32_t kNmtStart = 1, kNmtPreOperational = 128;
// Statusword, 7.5: bit 9 remote, which is NET mode here; the state in bits 0-3, 5 and 6.
inline constexpr std::uint32_t kRemote = 0x200, kStateMask = 0x6f;
inline constexpr std::uint32_t kReadyToSwitchOn = 0x21, kSwitchedOn = 0x23, kOperationEnabled = 0x27;
// Emergencies, 6.3: byte 3 is 21 for a refused command. A PDO is decided within some control periods.
inline constexpr ProfileStep refused(Word word) {
  return {.word = word, .act = kListen, .item = 3, .constant = 21, .time_ms = 20, .source = "6.3"};
}
inline constexpr ProfileStep send(Word word, std::uint32_t pdo) {
  return {.word = word, .act = kSend, .item = rpdo(pdo), .source = "6.5.1"};
}
inline constexpr ProfileStep start_node(Word word) {
  return {.word = word, .act = kCommand, .constant = kNmtStart, .source = "4.2"};
}
inline constexpr ProfileStep await_remote(bool on) {
  return {.word = on ? kEnterNetwork : kLeaveNetwork,
          .act = kAwait,
          .item = object(0x6041),
          .constant = on ? kRemote : 0,
          .mask = kRemote,
          .time_ms = 1000,
          .source = "7.5"};
}
inline constexpr ProfileStep pre_operational() {
  return {.word = kLeaveNetwork, .act = kCommand, .constant = kNmtPreOperational, .source = "4.2"};
}
inline constexpr ProfileStep reset_object() {
  return {.word = kReset, .item = object(0x2107), .constant = 0, .source = "6.2"};
}
inline constexpr ProfileStep await_ready() {
  return {.word = kReset,
          .act = kAwait,
          .item = object(0x4000),
          .constant = kReady,
          .mask = kReady,
          .time_ms = kRestartTime,
          .source = "6.2.4.2"};
}
inline constexpr ProfileStep clear_alarms() {
  return {.word = kClearAlarms, .item = object(0x2106), .constant = 0, .source = "6.2"};
}

// Command and speed in RPDO1 as it is mapped from the factory.
inline constexpr ProfileStep kCanopenSteps[] = {
    start_node(kEnterNetwork),
    refused(kEnterNetwork),
    await_remote(true),
    pre_operational(),
    await_remote(false),
    {.word = kRunForward, .act = kOutput, .item = rpdo(1), .constant = kForward, .source = "6.2.4"},
    send(kRunForward, 1),
    refused(kRunForward),
    {.word = kRunReverse, .act = kOutput, .item = rpdo(1), .constant = kReverse, .source = "6.2.4"},
    send(kRunReverse, 1),
    refused(kRunReverse),
    {.word = kStop, .act = kOutput, .item = rpdo(1), .constant = kStopCommand, .source = "6.2.4"},
    send(kStop, 1),
    refused(kStop),
    {.word = kReferenceHz, .act = kOutput, .item = rpdo(1, 2), .operand = kHz, .scale = 0.01, .source = "6.2.5"},
    send(kReferenceHz, 1),
    refused(kReferenceHz),
    {.word = kReferenceRpm, .item = object(0x4001, 1), .operand = kRpm, .source = "6.2.6"},
    // What RPDO1 says from now on must not start the motor again by itself.
    {.word = kReset, .act = kOutput, .item = rpdo(1), .constant = 0, .source = "6.2.4"},
    reset_object(),
    await_ready(),
    clear_alarms(),
};

// Each word as an SDO.
inline constexpr ProfileStep kCanopenSdoSteps[] = {
    start_node(kEnterNetwork),
    refused(kEnterNetwork),
    await_remote(true),
    pre_operational(),
    await_remote(false),
    {.word = kRunForward, .item = object(0x4000), .constant = kForward, .source = "6.2.4"},
    {.word = kRunReverse, .item = object(0x4000), .constant = kReverse, .source = "6.2.4"},
    {.word = kStop, .item = object(0x4000), .constant = kStopCommand, .source = "6.2.4"},
    {.word = kReferenceHz, .item = object(0x4001), .operand = kHz, .scale = 0.01, .source = "6.2.5"},
    {.word = kReferenceRpm, .item = object(0x4001, 1), .operand = kRpm, .source = "6.2.6"},
    reset_object(),
    await_ready(),
    clear_alarms(),
};

// DSP-402 velocity mode: controlword and target velocity in RPDO2, which is mapped for it before the node is started.
constexpr ProfileStep map_rpdo2(Item item, std::uint8_t size, std::uint32_t value) {
  return {.word = kEnterNetwork, .item = item, .size = size, .constant = value, .source = "6.5"};
}
constexpr ProfileStep rpdo2_cob_id(std::uint32_t flags) {
  return {.word = kEnterNetwork,
          .item = object(0x1401, 1),
          .size = 4,
          .operand = kConstantPlusNode,
          .constant = flags | 0x300,
          .source = "6.5"};
}
constexpr ProfileStep control(Word word, std::uint32_t controlword) {
  return {.word = word, .act = kOutput, .item = rpdo(2), .constant = controlword, .source = "7.5"};
}
constexpr ProfileStep reached(Word word, std::uint32_t state) {
  return {.word = word,
          .act = kAwait,
          .item = object(0x6041),
          .constant = state,
          .mask = kStateMask,
          .time_ms = 500,
          .source = "7.5"};
}
constexpr ProfileStep velocity(Word word) {
  return {.word = word, .act = kOutput, .item = rpdo(2, 2), .operand = kSignedRpm, .source = "7.6"};
}
// A drive that runs gets the new velocity and nothing else: shutdown would take the power from it.
constexpr ProfileStep unless_running(Word word, unsigned skip) {
  return {.word = word,
          .act = kSkipIf,
          .item = object(0x6041),
          .constant = kOperationEnabled,
          .mask = kStateMask,
          .skip = skip,
          .source = "7.5"};
}
inline constexpr ProfileStep kCanopen402Steps[] = {
    rpdo2_cob_id(0x80000000),  // not valid
    map_rpdo2(object(0x1601, 0), 1, 0),
    map_rpdo2(object(0x1601, 1), 4, 0x60400010),
    map_rpdo2(object(0x1601, 2), 4, 0x60420010),
    map_rpdo2(object(0x1601, 0), 1, 2),
    rpdo2_cob_id(0),
    {.word = kEnterNetwork, .item = object(0x6060), .size = 1, .constant = 2, .source = "7.13"},
    start_node(kEnterNetwork),
    refused(kEnterNetwork),
    await_remote(true),
    pre_operational(),
    await_remote(false),

    unless_running(kRunForward, 6),
    control(kRunForward, 0x06),
    send(kRunForward, 2),
    reached(kRunForward, kReadyToSwitchOn),
    control(kRunForward, 0x07),
    send(kRunForward, 2),
    reached(kRunForward, kSwitchedOn),
    velocity(kRunForward),
    control(kRunForward, 0x0f),
    send(kRunForward, 2),
    reached(kRunForward, kOperationEnabled),
    refused(kRunForward),

    unless_running(kRunReverse, 6),
    control(kRunReverse, 0x06),
    send(kRunReverse, 2),
    reached(kRunReverse, kReadyToSwitchOn),
    control(kRunReverse, 0x07),
    send(kRunReverse, 2),
    reached(kRunReverse, kSwitchedOn),
    velocity(kRunReverse),
    control(kRunReverse, 0x0f),
    send(kRunReverse, 2),
    reached(kRunReverse, kOperationEnabled),
    refused(kRunReverse),

    control(kStop, 0x07),  // disable operation
    send(kStop, 2),
    control(kQuickStop, 0x02),
    send(kQuickStop, 2),

    velocity(kReferenceHz),
    send(kReferenceHz, 2),
    refused(kReferenceHz),
    velocity(kReferenceRpm),
    send(kReferenceRpm, 2),
    refused(kReferenceRpm),

    // Fault reset is an edge; without a fault it is a disable voltage.
    control(kReset, 0x00),
    send(kReset, 2),
    control(kReset, 0x80),
    send(kReset, 2),
    control(kReset, 0x00),
    await_ready(),
    clear_alarms(),
};

inline constexpr ParameterRule kCanopenParameters[] = {
    {0, 901, object(0x3000), object(1), 0, 0, "6.2.2.2"},
    {902, 905, object(0x3386), object(1), 1, 2, "6.2.2.1"},
    {906, 999, object(0x338a), object(1), 0, 0, "6.2.2.2"},
};
inline constexpr MonitorRow kCanopenMonitors[] = {
    {.name = "output_frequency", .item = object(0x2000), .scale = 0.01, .unit = "Hz", .source = "6.2.1"},
    {.name = "output_current", .item = object(0x2001), .scale = 0.01, .unit = "A", .source = "6.2.1"},
    {.name = "output_voltage", .item = object(0x2002), .scale = 0.1, .unit = "V", .source = "6.2.1"},
    {.name = "speed", .item = object(0x6044), .is_signed = true, .unit = "rpm", .source = "7.8"},
    {.name = "status", .item = object(0x4000), .source = "6.2.4.2"},
    {.name = "statusword", .item = object(0x6041), .source = "7.5"},
    {.name = "alarm", .item = object(0x3400), .mask = 0xff, .source = "6.2.3"},
};

}  // namespace detail

inline constexpr BoardProfile kModbus{"oi-fr-e5nco",           "modbus",
                                      detail::kModbusSteps,    detail::kModbusParameters,
                                      detail::kModbusMonitors, detail::kModbusExceptions};
inline constexpr BoardProfile kCanopen{"oi-fr-e5nco", "canopen", detail::kCanopenSteps, detail::kCanopenParameters,
                                       detail::kCanopenMonitors};
inline constexpr BoardProfile kCanopenSdo{"oi-fr-e5nco", "canopen-sdo", detail::kCanopenSdoSteps,
                                          detail::kCanopenParameters, detail::kCanopenMonitors};
inline constexpr BoardProfile kCanopen402{"oi-fr-e5nco", "canopen-402", detail::kCanopen402Steps,
                                          detail::kCanopenParameters, detail::kCanopenMonitors};

}  // namespace vinv::masters::oi_fr_e5nco
