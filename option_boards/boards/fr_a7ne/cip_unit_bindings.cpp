// What the rows of objects.csv and services.csv are bound to. FR-A7NE manual, 7.
#include <algorithm>
#include <string>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "option_boards/boards/fr_a7ne/refusal_codes.hpp"
#include "option_boards/cip/identity_object.hpp"
#include "vinv_boards_data.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using cip::Attribute;
using cip::GeneralStatus;
using cip::Got;
using cip::Handled;
using cip::SetRequest;
using cip::SetResult;
using port::NetTerminal;
using Kind = port::WriteRequest::Kind;

constexpr std::uint16_t kPr9999 = 0xFFFF, kPr8888 = 0xFFF0;

SetResult refuse(GeneralStatus status) { return Unexpected(cip::Status(status)); }

port::WriteRequest request_of(Kind kind, std::int64_t value = 0) {
  port::WriteRequest request;
  request.kind = kind;
  request.value = static_cast<std::uint32_t>(value);
  return request;
}
port::WriteRequest parameter_request(port::ParameterId id, std::int64_t value) {
  port::WriteRequest request = request_of(Kind::kParameter, value);
  request.parameter = id;
  return request;
}
port::ParameterId parameter_of(const Attribute& a) {
  return {static_cast<std::uint16_t>(a.argument()), static_cast<std::uint8_t>(a.row.detail)};
}

// Bits of attribute 114, Set (7.6).
constexpr std::pair<unsigned, NetTerminal> kCommandBits[] = {
    {1, NetTerminal::kStf}, {2, NetTerminal::kStr},  {3, NetTerminal::kRh},    {4, NetTerminal::kRm},
    {5, NetTerminal::kRl},  {6, NetTerminal::kJog},  {7, NetTerminal::kRt},    {8, NetTerminal::kAu},
    {9, NetTerminal::kCs},  {10, NetTerminal::kMrs}, {11, NetTerminal::kStop}, {12, NetTerminal::kRes}};

// Of kResetInverter.
constexpr std::int64_t kAtAnyTime = 0, kAsPr75Permits = 1;

// Values of attribute 120 that a master writes (7.6).
constexpr std::int64_t kSetExternal = 0x0010, kSetPanel = 0x0011, kSetNetwork = 0x0014;

}  // namespace

struct CipUnit::Bindings {
  using Unit = CipUnit;

  static Got monitor(const Unit& unit, unsigned number) {
    const auto value = unit.drive_.read_monitor(number);
    if (!value) return Unexpected(status_of(value.error()));
    return *value;
  }
  static Got parameter(const Unit& unit, port::ParameterId id) {
    const auto value = unit.drive_.read_parameter(id);
    if (!value) return Unexpected(status_of(value.error()));
    return *value;
  }

  // --- assembly ---
  static GeneralStatus append_assembly(const Unit& unit, const Attribute& a, Bytes& out) {
    unit.append_assembly(a.row.instance, out);
    return GeneralStatus::kSuccess;
  }

  // --- motor data (7.4) ---
  static Got get_motor_type(const Unit&, const Attribute& a) { return a.row.max; }
  static SetResult set_motor_type(Unit&, const SetRequest&) { return Handled::kAnswered; }
  // 0.1 A; Pr.9 has 0.01 A in models up to 55K.
  static Got get_rated_current(const Unit& unit, const Attribute&) {
    const Got raw = parameter(unit, {9, 0});
    if (!raw || unit.drive_.facts().coarse) return raw;
    return cip::SpeedScale::ratio(*raw, 1, 10);
  }
  static SetResult set_rated_current(Unit& unit, const SetRequest& s) {
    const std::int64_t raw = unit.drive_.facts().coarse ? s.number : s.number * 10;
    return unit.post(s.now, parameter_request({9, 0}, raw), s.ticket);
  }
  // V; Pr.19 has 0.1 V.
  static Got get_rated_voltage(const Unit& unit, const Attribute&) {
    const Got raw = parameter(unit, {19, 0});
    if (!raw) return raw;
    if (*raw == kPr9999 || *raw == kPr8888) return unit.drive_.facts().voltage_class_v;
    return cip::SpeedScale::ratio(*raw, 1, 10);
  }
  static SetResult set_rated_voltage(Unit& unit, const SetRequest& s) {
    constexpr std::int64_t kMost = 1000;
    const bool special = s.number == kPr9999 || s.number == kPr8888;
    if (!special && s.number > kMost) return refuse(GeneralStatus::kInvalidAttributeValue);
    return unit.post(s.now, parameter_request({19, 0}, special ? s.number : s.number * 10), s.ticket);
  }

  // --- control supervisor (7.5) ---
  // argument: 0 RUN1, 1 RUN2
  static Got get_run(const Unit& unit, const Attribute& a) {
    return (a.argument() == 0 ? unit.state_.run.forward : unit.state_.run.reverse) ? 1 : 0;
  }
  static SetResult set_run(Unit& unit, const SetRequest& s) {
    if (const auto refused = unit.refuses_explicit(s.now)) return refuse(*refused);
    cip::RunSignals run = unit.state_.run;
    (s.attribute.argument() == 0 ? run.forward : run.reverse) = s.number != 0;
    port::WriteRequest request = request_of(Kind::kCommand);
    request.terminals = unit.with_run(run);
    return unit.post(s.now, request, s.ticket);
  }
  // Pr.338 and 339: 0 is the network; attribute 1 is the network.
  static Got get_source(const Unit& unit, const Attribute& a) {
    const Got raw = parameter(unit, parameter_of(a));
    if (!raw) return raw;
    return *raw == 0 ? 1 : 0;
  }
  static SetResult set_source(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, parameter_request(parameter_of(s.attribute), s.number == 0 ? 1 : 0), s.ticket);
  }
  static Got get_state(const Unit& unit, const Attribute&) {
    return static_cast<std::int64_t>(cip::supervisor_state(unit.drive_, unit.state_.started));
  }
  // argument: 0 forward, 1 reverse
  static Got get_running(const Unit& unit, const Attribute& a) {
    const port::Status status = unit.drive_.status();
    return status.running && (a.argument() == 0 ? status.forward : status.reverse) ? 1 : 0;
  }
  static Got get_ready(const Unit& unit, const Attribute&) {
    return unit.drive_.ready() && !unit.drive_.status().alarm ? 1 : 0;
  }
  static Got get_faulted(const Unit& unit, const Attribute&) { return unit.drive_.status().alarm ? 1 : 0; }
  static Got get_fault_reset(const Unit& unit, const Attribute&) { return unit.state_.explicit_reset.value() ? 1 : 0; }
  // *1: acts again only after a 0. Without an alarm it has no function.
  static SetResult set_fault_reset(Unit& unit, const SetRequest& s) {
    if (const auto refused = unit.refuses_explicit(s.now)) return refuse(*refused);
    if (s.number != 0 && unit.drive_.status().alarm && !unit.fault_reset_allowed()) {
      return refuse(GeneralStatus::kObjectStateConflict);
    }
    const bool acts = unit.state_.explicit_reset.write(s.number != 0) && unit.drive_.status().alarm;
    if (!acts) return Handled::kAnswered;
    return unit.post(s.now, request_of(Kind::kErrorReset), s.ticket);
  }
  static Got get_control_from_net(const Unit& unit, const Attribute&) {
    return unit.state_.control_from_net_at_start ? 1 : 0;
  }
  // argument: 0 input, 1 output. *2: the value changes with the next start.
  static Got get_assembly(const Unit& unit, const Attribute& a) {
    return a.argument() == 0 ? unit.state_.assemblies.input : unit.state_.assemblies.output;
  }
  static SetResult set_assembly(Unit& unit, const SetRequest& s) {
    const Got pr346 = parameter(unit, {346, 0});
    if (!pr346) return refuse(pr346.error());
    const auto before = static_cast<std::uint16_t>(*pr346);
    const auto instance = static_cast<std::uint8_t>(std::min<std::int64_t>(s.number, 0xFF));
    const auto after =
        s.attribute.argument() == 0 ? pr346_with_input(before, instance) : pr346_with_output(before, instance);
    if (!after) return refuse(GeneralStatus::kInvalidAttributeValue);
    return unit.post(s.now, parameter_request({346, 0}, *after), s.ticket);
  }

  // --- AC drive (7.6) ---
  static Got get_at_reference(const Unit& unit, const Attribute&) {
    return unit.drive_.status().up_to_frequency ? 1 : 0;
  }
  static Got get_speed_actual(const Unit& unit, const Attribute&) { return unit.speed_actual(); }
  static Got speed_of(const Unit& unit, const Got& frequency, std::int64_t most) {
    if (!frequency) return frequency;
    return std::min(most, unit.speed_scale().speed_of(*frequency));
  }
  static Got get_speed_reference(const Unit& unit, const Attribute& a) {
    return speed_of(unit, get_frequency(unit, a), 32767);
  }
  static SetResult set_speed_reference(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, request_of(Kind::kFrequency, unit.speed_scale().frequency_of(s.number)), s.ticket);
  }
  static Got get_current_actual(const Unit& unit, const Attribute&) {
    const Got raw = monitor(unit, 2);
    if (!raw) return raw;
    return std::min<std::int64_t>(32767, unit.drive_.facts().coarse ? *raw : cip::SpeedScale::ratio(*raw, 1, 10));
  }
  static Got get_power_actual(const Unit& unit, const Attribute&) {
    const Got raw = monitor(unit, 14);
    if (!raw) return raw;
    return std::min<std::int64_t>(0xFFFF, *raw * (unit.drive_.facts().coarse ? 100 : 10));
  }
  static Got get_output_voltage(const Unit& unit, const Attribute&) {
    const Got raw = monitor(unit, 3);
    if (!raw) return raw;
    return cip::SpeedScale::ratio(*raw, 1, 10);
  }
  // ms per step of Pr.7 and Pr.8, by Pr.21.
  static std::int64_t ramp_step_ms(const Unit& unit) { return unit.parameter_or(21, 0) == 0 ? 100 : 10; }
  // Time = Pr.7 (8) * Pr.1 / Pr.20. Unspecified: longer times than the word has; here its largest.
  static Got get_ramp_time(const Unit& unit, const Attribute& a) {
    const Got steps = parameter(unit, parameter_of(a)), most = parameter(unit, {1, 0}),
              reference = parameter(unit, {20, 0});
    if (!steps || !most || !reference) return !steps ? steps : !most ? most : reference;
    const std::int64_t ms =
        cip::SpeedScale::ratio(*steps * ramp_step_ms(unit), *most, std::max<std::int64_t>(1, *reference));
    return std::min<std::int64_t>(0xFFFF, ms);
  }
  static SetResult set_ramp_time(Unit& unit, const SetRequest& s) {
    const Got most = parameter(unit, {1, 0}), reference = parameter(unit, {20, 0});
    if (!most || !reference) return refuse(!most ? most.error() : reference.error());
    // Pr.1 = 0: no time comes to anything.
    if (*most == 0) return refuse(GeneralStatus::kObjectStateConflict);
    const std::int64_t steps = cip::SpeedScale::ratio(s.number, *reference, *most * ramp_step_ms(unit));
    return unit.post(s.now, parameter_request(parameter_of(s.attribute), steps), s.ticket);
  }
  static Got get_speed_limit(const Unit& unit, const Attribute& a) {
    return speed_of(unit, parameter(unit, parameter_of(a)), 0xFFFF);
  }
  static SetResult set_speed_limit(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, parameter_request(parameter_of(s.attribute), unit.speed_scale().frequency_of(s.number)),
                     s.ticket);
  }
  static Got get_reference_from_net(const Unit& unit, const Attribute&) { return unit.reference_from_net() ? 1 : 0; }
  // 4.6: in NET operation, not while a line error lasts.
  static SetResult set_reset(Unit& unit, const SetRequest& s) {
    if (!unit.network_mode() || unit.line_error()) return refuse(GeneralStatus::kObjectStateConflict);
    return unit.post(s.now, request_of(Kind::kResetInverter, kAtAnyTime), s.ticket);
  }
  // argument: value of kRestoreDefaults
  static SetResult set_restore(Unit& unit, const SetRequest& s) {
    ExplicitJob job;
    job.add(request_of(Kind::kRestoreDefaults, s.attribute.argument()));
    job.clears = true;
    return unit.post(s.now, job, s.ticket);
  }
  static Got get_frequency(const Unit& unit, const Attribute&) { return unit.drive_.network_frequency(); }
  static SetResult set_frequency(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, request_of(Kind::kFrequency, s.number), s.ticket);
  }
  static SetResult set_stored_frequency(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, request_of(Kind::kStoredFrequency, s.number), s.ticket);
  }
  static Got get_status_word(const Unit& unit, const Attribute&) {
    const port::Status s = unit.drive_.status();
    constexpr unsigned kReady = 15;
    std::int64_t word = s.ready ? 1 << kReady : 0;
    unsigned bit = 0;
    for (const bool on : {s.running, s.forward, s.reverse, s.up_to_frequency, s.overload, s.power_failure,
                          s.frequency_detected, s.alarm}) {
      word |= std::int64_t{on} << bit++;
    }
    return word;
  }
  // The terminals themselves, not the profile's Run1 and Run2: both start signals at once are the inverter's matter.
  static SetResult set_run_command(Unit& unit, const SetRequest& s) {
    if (const auto refused = unit.refuses_explicit(s.now)) return refuse(*refused);
    port::WriteRequest request = request_of(Kind::kCommand);
    for (const auto& [bit, terminal] : kCommandBits) request.terminals.set(terminal, (s.number >> bit & 1) != 0);
    unit.want(request.terminals, cip::run_signals_of(request.terminals));
    return unit.post(s.now, request, s.ticket);
  }
  static Got get_mode(const Unit& unit, const Attribute&) {
    const bool jogs = unit.drive_.jog_operation();
    switch (unit.drive_.operation_mode()) {
      case port::OperationMode::kExternal: return jogs ? 2 : 0;
      case port::OperationMode::kPu: return jogs ? 3 : 1;
      case port::OperationMode::kNetwork: return 4;
      default: return 5;
    }
  }
  static SetResult set_mode(Unit& unit, const SetRequest& s) {
    constexpr std::uint32_t kSwitchWhileRunning = 6;
    switch (s.number) {
      case kSetExternal: return unit.post(s.now, request_of(Kind::kOperationMode, 0), s.ticket);
      case kSetNetwork: return unit.post(s.now, request_of(Kind::kOperationMode, 1), s.ticket);
      case kSetPanel:
        if (unit.parameter_or(79, 0) != kSwitchWhileRunning) return refuse(GeneralStatus::kObjectStateConflict);
        return unit.post(s.now, request_of(Kind::kOperationMode, 2), s.ticket);
      default: return refuse(GeneralStatus::kInvalidAttributeValue);
    }
  }
  // argument: 0 is the latest alarm
  static Got get_alarm(const Unit& unit, const Attribute& a) {
    return unit.drive_.alarm_history()[static_cast<std::size_t>(a.argument())];
  }
  static SetResult clear_alarms(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, request_of(Kind::kClearAlarmHistory), s.ticket);
  }

  // --- monitors and parameters (7.6, 7.10 to 7.13) ---
  static Got get_monitor(const Unit& unit, const Attribute& a) {
    return monitor(unit, static_cast<unsigned>(a.argument()));
  }
  static Got get_not_fitted(const Unit&, const Attribute&) { return Unexpected(GeneralStatus::kAttributeNotSupported); }
  static Got get_parameter(const Unit& unit, const Attribute& a) { return parameter(unit, parameter_of(a)); }
  static SetResult set_parameter(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, parameter_request(parameter_of(s.attribute), s.number), s.ticket);
  }
  // Pr.900 and above in instance 1: a parameter of two words gives its first.
  static port::ParameterId calibration_of(const Unit& unit, const Attribute& a) {
    port::ParameterId id = parameter_of(a);
    const auto whole = unit.drive_.read_parameter(id);
    if (!whole && whole.error() == port::Refusal::kNoSuchItem) id.sub = 1;
    return id;
  }
  static Got get_calibration(const Unit& unit, const Attribute& a) { return parameter(unit, calibration_of(unit, a)); }
  static SetResult set_calibration(Unit& unit, const SetRequest& s) {
    return unit.post(s.now, parameter_request(calibration_of(unit, s.attribute), s.number), s.ticket);
  }
  // 7.11 *1: settable with the FR-A7AP only.
  static SetResult set_without_option(Unit&, const SetRequest&) { return refuse(GeneralStatus::kAttributeNotSettable); }

  // --- network (7.7 to 7.9) ---
  // Attribute 7 of the port: port 2 with the address as text.
  static GeneralStatus append_node_address(const Unit& unit, const Attribute&, Bytes& out) {
    const std::uint32_t ip = unit.state_.network.ip.address;
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) {
      text += (text.empty() ? "" : ".") + std::to_string(ip >> shift & 0xFF);
    }
    const ByteView address(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    cip::append_segment(out, cip::PortSegment{2, true, address}, cip::PathForm::kPadded);
    return GeneralStatus::kSuccess;
  }
  static Got get_configuration_control(const Unit& unit, const Attribute&) {
    const bool set_by_parameters = settings_from_parameters(unit.state_.startup.pr540);
    return (set_by_parameters ? unit.state_.network.dhcp : unit.state_.flash.dhcp) ? 2 : 0;
  }
  static SetResult set_configuration_control(Unit& unit, const SetRequest& s) {
    if (s.number != 0 && s.number != 2) return refuse(GeneralStatus::kInvalidAttributeValue);
    unit.state_.flash.dhcp = s.number == 2;
    return Handled::kAnswered;
  }
  // What is configured; what came by DHCP while that is in use.
  static GeneralStatus append_interface_configuration(const Unit& unit, const Attribute&, Bytes& out) {
    const bool from_flash = !settings_from_parameters(unit.state_.startup.pr540) && !unit.state_.flash.dhcp;
    fr_a7ne::append_interface_configuration(out, from_flash ? unit.state_.flash.ip : unit.state_.network.ip);
    return GeneralStatus::kSuccess;
  }
  // CIP Vol 2, 5-3.3.2.5: not while the address comes by DHCP.
  static SetResult set_interface_configuration(Unit& unit, const SetRequest& s) {
    if (get_configuration_control(unit, s.attribute).value() == 2) return refuse(GeneralStatus::kObjectStateConflict);
    const auto ip = parse_interface_configuration(s.bytes);
    if (!ip) return refuse(ip.error());
    unit.state_.flash.ip = *ip;
    return Handled::kAnswered;
  }
  static GeneralStatus append_host_name(const Unit& unit, const Attribute&, Bytes& out) {
    cip::append_padded_string(out, unit.state_.flash.host_name);
    return GeneralStatus::kSuccess;
  }
  static SetResult set_host_name(Unit& unit, const SetRequest& s) {
    const std::size_t length = read_le16(s.bytes, 0);
    if (length > kMostNameCharacters) return refuse(GeneralStatus::kInvalidAttributeValue);
    const ByteView name = s.bytes.subspan(2, length);
    unit.state_.flash.host_name.assign(name.begin(), name.end());
    return Handled::kAnswered;
  }
  static Got get_interface_speed(const Unit& unit, const Attribute&) { return unit.line().mbit_per_s; }
  static Got get_interface_flags(const Unit& unit, const Attribute&) {
    constexpr std::int64_t kManualSettingNeedsReset = 1 << 5;
    const LineState line = unit.line();
    return std::int64_t{line.link} | std::int64_t{line.full_duplex} << 1 | std::int64_t{line.negotiation} << 2 |
           kManualSettingNeedsReset;
  }
  static GeneralStatus append_physical_address(const Unit& unit, const Attribute&, Bytes& out) {
    out.insert(out.end(), unit.config_.ethernet.mac.begin(), unit.config_.ethernet.mac.end());
    return GeneralStatus::kSuccess;
  }
  static const LineSetting& line_setting(const Unit& unit) {
    return settings_from_parameters(unit.state_.startup.pr540) ? unit.state_.network.line : unit.state_.flash.line;
  }
  static GeneralStatus append_interface_control(const Unit& unit, const Attribute&, Bytes& out) {
    fr_a7ne::append_interface_control(out, line_setting(unit));
    return GeneralStatus::kSuccess;
  }
  static SetResult set_interface_control(Unit& unit, const SetRequest& s) {
    const auto line = parse_interface_control(s.bytes);
    if (!line) return refuse(line.error());
    unit.state_.flash.line = *line;
    return Handled::kAnswered;
  }

  // --- identity (7.1.2) ---
  // 0: restart. 1: all parameter clear, flash clear, restart. *1: the inverter judges by Pr.75.
  static Handled reset(Unit& unit, Instant now, const cip::Request& request, cip::Reply& reply) {
    const auto answer = [&](GeneralStatus status) {
      reply.refuse(status);
      return Handled::kAnswered;
    };
    if (request.data.size() > 1) return answer(GeneralStatus::kTooMuchData);
    const unsigned type = request.data.empty() ? 0 : request.data[0];
    if (type > 1) return answer(GeneralStatus::kInvalidParameter);
    // 4.6: no reset from the network while a line error lasts.
    if (unit.line_error()) return answer(GeneralStatus::kObjectStateConflict);
    ExplicitJob job;
    if (type == 1) {
      // Unspecified: the parts of an order that the inverter does not accept as a whole. Here nothing is cleared then.
      constexpr std::uint32_t kOnlyWithAlarm = 1;  // the last bit of Pr.75, 0-3 and 14-17
      if (!unit.network_mode()) return answer(GeneralStatus::kObjectStateConflict);
      const bool needs_alarm = (unit.parameter_or(75, 0) & kOnlyWithAlarm) != 0;
      if (needs_alarm && !unit.drive_.status().alarm) return answer(GeneralStatus::kDeviceStateConflict);
      job.add(request_of(Kind::kRestoreDefaults, 1));
      job.effect = Effect::kFlashClear;
      job.clears = true;
    }
    job.add(request_of(Kind::kResetInverter, kAsPr75Permits));
    const SetResult posted = unit.post(now, job, request.ticket);
    return posted ? *posted : answer(posted.error().general);
  }

  static constexpr cip::Binding<Unit> kRows[] = {
      {"identity", cip::get_identity<Unit>, cip::append_identity<Unit>},
      {"assembly", nullptr, append_assembly},
      {"motor_type", get_motor_type, nullptr, set_motor_type},
      {"rated_current", get_rated_current, nullptr, set_rated_current},
      {"rated_voltage", get_rated_voltage, nullptr, set_rated_voltage},
      {"run", get_run, nullptr, set_run},
      {"source", get_source, nullptr, set_source},
      {"state", get_state},
      {"running", get_running},
      {"ready", get_ready},
      {"faulted", get_faulted},
      {"fault_reset", get_fault_reset, nullptr, set_fault_reset},
      {"control_from_net", get_control_from_net},
      {"assembly_selection", get_assembly, nullptr, set_assembly},
      {"at_reference", get_at_reference},
      {"speed_actual", get_speed_actual},
      {"speed_reference", get_speed_reference, nullptr, set_speed_reference},
      {"current_actual", get_current_actual},
      {"power_actual", get_power_actual},
      {"output_voltage", get_output_voltage},
      {"ramp_time", get_ramp_time, nullptr, set_ramp_time},
      {"speed_limit", get_speed_limit, nullptr, set_speed_limit},
      {"reference_from_net", get_reference_from_net},
      {"reset", nullptr, nullptr, set_reset},
      {"restore", nullptr, nullptr, set_restore},
      {"frequency", get_frequency, nullptr, set_frequency},
      {"stored_frequency", nullptr, nullptr, set_stored_frequency},
      {"status_word", get_status_word, nullptr, set_run_command},
      {"mode", get_mode, nullptr, set_mode},
      {"alarm", get_alarm, nullptr, clear_alarms},
      {"monitor", get_monitor},
      {"not_fitted", get_not_fitted},
      {"parameter", get_parameter, nullptr, set_parameter},
      {"calibration", get_calibration, nullptr, set_calibration},
      {"parameter_of_option", get_parameter, nullptr, set_without_option},
      {"node_address", nullptr, append_node_address},
      {"configuration_control", get_configuration_control, nullptr, set_configuration_control},
      {"interface_configuration", nullptr, append_interface_configuration, set_interface_configuration},
      {"host_name", nullptr, append_host_name, set_host_name},
      {"interface_speed", get_interface_speed},
      {"interface_flags", get_interface_flags},
      {"physical_address", nullptr, append_physical_address},
      {"interface_control", nullptr, append_interface_control, set_interface_control},
  };
  static constexpr cip::OwnService<Unit> kServices[] = {{"reset", reset}};
};

const cip::AttributeTable& CipUnit::objects() {
  using Rows = std::span<const cip::Binding<CipUnit>>;
  using Services = std::span<const cip::OwnService<CipUnit>>;
  static const cip::AttributeTable kTable = [] {
    cip::AttributeTable table(data::FR_A7NE_OBJECTS, cip::names_of<CipUnit>(Rows(Bindings::kRows)),
                              data::FR_A7NE_SERVICES, cip::names_of<CipUnit>(Services(Bindings::kServices)));
    VINV_CHECK(cip::bindings_fit<CipUnit>(table, Bindings::kRows));
    return table;
  }();
  return kTable;
}

// 7.1.2: vendor, device type, product code, product name. The revision is of the form that it prints (1.010).
CipUnit::CipUnit(port::DrivePort& drive, const CipUnitConfig& config)
    : drive_(drive),
      config_(config),
      identity_{161, 2, 56, 1, 10, config.serial_number, "A700"},
      objects_(objects(), *this, Bindings::kRows, Bindings::kServices) {
  state_.link.set_timing(config_.timing);
  state_.flash = config_.ethernet.flash;
  for (const std::uint16_t class_id : objects().classes()) router_.add(class_id, objects_);
}

}  // namespace vinv::boards::fr_a7ne
