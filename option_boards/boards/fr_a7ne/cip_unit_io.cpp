// Polled data: assemblies 20, 21, 126, 129 and 70, 71, 176, 179 bit by bit. FR-A7NE manual, 6.2.1 and 7.2.
#include <algorithm>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using port::NetTerminal;
using Kind = port::WriteRequest::Kind;

enum : std::uint32_t {
  kOutput20 = 20,
  kOutput21 = 21,
  kOutput126 = 126,
  kOutput129 = 129,
  kInput70 = 70,
  kInput71 = 71,
  kInput176 = 176,
  kInput179 = 179,
};

// Byte 0 of the output instances.
constexpr std::uint8_t kRunForward = 1u << 0, kRunReverse = 1u << 1, kFaultReset = 1u << 2, kNetControl = 1u << 5,
                       kNetReference = 1u << 6, kWriteParameter = 1u << 7 /* 126 */, kMrs = 1u << 7 /* 129 */;
// Byte 0 of the input instances.
constexpr std::uint8_t kFaulted = 1u << 0, kRunCommandMode = 1u << 1, kRunningForward = 1u << 2,
                       kRunningReverse = 1u << 3, kReady = 1u << 4, kControlFromNet = 1u << 5,
                       kReferenceFromNet = 1u << 6, kAtReference = 1u << 7;
constexpr std::uint8_t kParameterEnd = 1u << 7;

// Byte 1 of 129, from bit 0.
constexpr NetTerminal kSignals[] = {NetTerminal::kAu, NetTerminal::kRt,  NetTerminal::kRl,  NetTerminal::kRm,
                                    NetTerminal::kRh, NetTerminal::kJog, NetTerminal::kMrs, NetTerminal::kStop};

// Monitor selection of 129 (7.2.1): what the list has.
constexpr bool is_monitor(unsigned number) {
  return (number >= 1 && number <= 3) || (number >= 5 && number <= 20) || (number >= 22 && number <= 25) ||
         (number >= 32 && number <= 35) || (number >= 50 && number <= 54) || (number >= 58 && number <= 60);
}
constexpr unsigned kInputTerminals = 15;  // monitor

std::size_t size_of_assembly(std::uint32_t instance) {
  constexpr std::size_t kShort = 4;
  const bool is_long =
      instance == kOutput126 || instance == kOutput129 || instance == kInput176 || instance == kInput179;
  return is_long ? CipUnit::kMostIoBytes : kShort;
}

}  // namespace

std::optional<std::size_t> CipUnit::consumed_size(std::uint32_t point) const {
  if (!online()) return std::nullopt;
  if (point == kInputOnlyPoint || point == kListenOnlyPoint) return 0;
  return point == state_.assemblies.output ? std::optional(size_of_assembly(point)) : std::nullopt;
}

std::optional<std::size_t> CipUnit::produced_size(std::uint32_t point) const {
  if (!online() || point != state_.assemblies.input) return std::nullopt;
  return size_of_assembly(point);
}

// Unspecified: the manual lists no configuration assembly. Scanners name one all the same; any will do that has no
// data.
std::optional<std::size_t> CipUnit::configuration_size(std::uint32_t) const { return 0; }

bool CipUnit::is_heartbeat(std::uint32_t point, cip::IoRole role) const {
  return (role == cip::IoRole::kInputOnly && point == kInputOnlyPoint) ||
         (role == cip::IoRole::kListenOnly && point == kListenOnlyPoint);
}

// 20 with 70, 21 with 71, 126 with 176, 129 with 179 (7.2.1).
bool CipUnit::goes_with(std::uint32_t consumed_point, std::uint32_t produced_point) const {
  constexpr std::uint32_t kDistance = 50;
  if (consumed_point == kInputOnlyPoint || consumed_point == kListenOnlyPoint) return true;
  return consumed_point + kDistance == produced_point;
}

cip::Status CipUnit::configure(Instant, std::uint32_t, ByteView data) {
  return data.empty() ? cip::Status() : cip::Status(cip::GeneralStatus::kTooMuchData);
}

void CipUnit::consume(Instant now, std::uint32_t point, ByteView data, cip::RunMode mode) {
  if (!online() || point != state_.assemblies.output || data.size() != size_of_assembly(point)) return;
  std::copy(data.begin(), data.end(), state_.output.begin());
  const bool idle = mode == cip::RunMode::kIdle;
  if (state_.acted_before && state_.output == state_.acted && idle == state_.acted_idle) return;
  act_on_output(now, mode);
  state_.acted = state_.output;
  state_.acted_idle = idle;
  state_.acted_before = true;
}

void CipUnit::act_on_output(Instant now, cip::RunMode mode) {
  const std::uint8_t control = state_.output[0];
  const bool runs = mode == cip::RunMode::kRun;
  const bool gated = state_.assemblies.output != kOutput20;
  const bool controls = runs && (!gated || (control & kNetControl) != 0);
  poll_reset(controls && (control & kFaultReset) != 0);
  poll_terminals(mode);
  if (runs && (!gated || (control & kNetReference) != 0)) poll_speed();
  if (runs) {
    poll_parameter();
    poll_outputs();
  }
  advance(now);
}

void CipUnit::poll_reset(bool bit) {
  if (!state_.polled_reset.write(bit) || !drive_.status().alarm || !fault_reset_allowed()) return;
  port::WriteRequest request;
  request.kind = Kind::kErrorReset;
  state_.link.put(PolledTopic::kFaultReset, request);
}

// With NetCtrl = 0 the run bits have no function: what other commands have on stays on. Unspecified: what becomes of
// run bits that were on under NetCtrl = 1; here they go off with it. Idle takes them away as well.
void CipUnit::poll_terminals(cip::RunMode mode) {
  const std::uint32_t instance = state_.assemblies.output;
  const bool runs = mode == cip::RunMode::kRun;
  const std::uint8_t control = runs ? state_.output[0] : std::uint8_t{0};
  const bool gate = instance == kOutput20 || (control & kNetControl) != 0;
  const bool had_control = std::exchange(state_.polled_control, gate);
  const bool has_signals = instance == kOutput129 && runs;
  if (!state_.polled_control && !had_control && !has_signals) return;
  port::WriteRequest request;
  request.kind = Kind::kCommand;
  if (state_.polled_control || had_control) {
    cip::RunSignals run;
    // Start signals that are the terminals' (Pr.338) must not keep the others of 129 away.
    const bool starts = state_.polled_control && parameter_or(338, 0) == 0;
    run.forward = starts && (control & kRunForward) != 0;
    run.reverse = starts && instance != kOutput20 && (control & kRunReverse) != 0;
    with_run(run);
  }
  request.terminals = state_.wanted;
  if (has_signals) {
    request.terminals.set(NetTerminal::kOutputStop, (control & kMrs) != 0);
    unsigned bit = 0;
    for (const NetTerminal signal : kSignals) request.terminals.set(signal, (state_.output[1] >> bit++ & 1) != 0);
  }
  state_.wanted = request.terminals;
  state_.link.put(PolledTopic::kRun, request);
}

void CipUnit::poll_speed() {
  if (state_.assemblies.output == kOutput126 && (state_.output[0] & kWriteParameter) != 0) return;
  constexpr std::int64_t kMost = 40000;  // 400 Hz; 0 to 0x9C40 (7.6, attribute 112)
  const std::int64_t frequency = speed_scale().frequency_of(read_le16(state_.output, 2));
  port::WriteRequest request;
  request.kind = Kind::kFrequency;
  request.value = static_cast<std::uint32_t>(std::min(kMost, frequency));
  state_.link.put(PolledTopic::kFrequency, request);
}

// Bytes 1, 4 and 5 of 126; instance 0 stands for 1.
cip::ObjectPath CipUnit::parameter_path() const {
  return {state_.output[4], state_.output[1] == 0 ? 1u : state_.output[1], state_.output[5], std::nullopt};
}

void CipUnit::poll_parameter() {
  if (state_.assemblies.output != kOutput126 || (state_.output[0] & kWriteParameter) == 0) return;
  state_.parameter_write = PolledParameter{parameter_path(), read_le16(state_.output, 2)};
}

// The object that the bytes name takes it like an explicit write; nobody hears of a refusal.
void CipUnit::write_polled_parameter(Instant now) {
  if (!state_.parameter_write || state_.link.explicit_busy(now)) return;
  const PolledParameter write = *std::exchange(state_.parameter_write, std::nullopt);
  const cip::AttributeRow* const row =
      objects().find(write.path.class_id, write.path.instance, write.path.attribute.value_or(0));
  const auto type = row != nullptr ? row->type.integer() : std::nullopt;
  if (!type || cip::size_of(*type) > sizeof write.raw) return;
  std::array<std::uint8_t, 2> data{static_cast<std::uint8_t>(write.raw), static_cast<std::uint8_t>(write.raw >> 8)};
  cip::Request request;
  request.service = cip::code_of(cip::Service::kSetAttributeSingle);
  request.path = write.path;
  request.data = ByteView(data).first(cip::size_of(*type));
  cip::Reply reply;
  objects_.handle(now, request, reply);
}

// Pr.496 is written when it differs from byte 5 (7.2.1).
void CipUnit::poll_outputs() {
  constexpr std::uint16_t kRemoteOutputs = 496;
  if (state_.assemblies.output != kOutput129) return;
  const std::uint32_t wanted = state_.output[5];
  const auto is = drive_.read_parameter({kRemoteOutputs, 0});
  if (!is || *is == wanted) return;
  port::WriteRequest request;
  request.kind = Kind::kParameter;
  request.parameter = {kRemoteOutputs, 0};
  request.value = wanted;
  state_.link.put(PolledTopic::kOutputs, request);
}

void CipUnit::produce(Instant now, std::uint32_t point, std::span<std::uint8_t> out) {
  if (point == state_.assemblies.input && out.size() == size_of_assembly(point)) fill_input(now, point, out);
}

// Only connections that send changes ask: it costs as much as the data.
std::uint32_t CipUnit::produced_version(std::uint32_t) const {
  Image image{};
  fill_input(state_.now, state_.assemblies.input, image);
  if (image != input_version_.image) ++input_version_.number;
  input_version_.image = image;
  return input_version_.number;
}

std::uint8_t CipUnit::status_byte(std::uint32_t instance) const {
  const port::Status status = drive_.status();
  const auto bit = [](bool on, std::uint8_t mask) { return on ? mask : std::uint8_t{0}; };
  std::uint8_t byte = bit(status.alarm, kFaulted) | bit(status.running && status.forward, kRunningForward);
  if (instance == kInput70) return byte;
  byte |= bit(status.running && status.reverse, kRunningReverse) | bit(online(), kReady) |
          bit(control_from_net(), kControlFromNet) | bit(reference_from_net(), kReferenceFromNet) |
          bit(status.up_to_frequency, kAtReference);
  if (instance == kInput71) return byte;
  // Pr.339 = 2 is not in the manual's table; only both sources at 0 make 1.
  const bool commands = control_from_net() && parameter_or(339, 0) == 0;
  return byte | bit(commands, kRunCommandMode);
}

std::uint16_t CipUnit::parameter_read_data() const {
  const cip::ObjectPath path = parameter_path();
  const cip::AttributeRow* const row = objects().find(path.class_id, path.instance, *path.attribute);
  const auto type = row != nullptr && row->gettable ? row->type.integer() : std::nullopt;
  if (!type || cip::size_of(*type) > sizeof(std::uint16_t)) return 0;
  scratch_.clear();
  if (objects_.append_value({*row, *path.attribute}, scratch_) != cip::GeneralStatus::kSuccess) return 0;
  return static_cast<std::uint16_t>(cip::read_integer(*type, scratch_));
}

std::uint16_t CipUnit::selected_monitor() const {
  const unsigned number = state_.output[4];
  const auto value = is_monitor(number) ? drive_.read_monitor(number) : Unexpected(port::Refusal::kNoSuchItem);
  return value ? *value : std::uint16_t{0};
}

void CipUnit::fill_input(Instant now, std::uint32_t instance, std::span<std::uint8_t> out) const {
  const auto word = [&](std::size_t at, std::uint16_t value) {
    out[at] = static_cast<std::uint8_t>(value);
    out[at + 1] = static_cast<std::uint8_t>(value >> 8);
  };
  out[0] = status_byte(instance);
  out[1] = 0;
  word(2, speed_actual());
  if (instance == kInput176) {
    if (state_.link.explicit_busy(now)) out[1] = kParameterEnd;
    word(4, parameter_read_data());
  } else if (instance == kInput179) {
    // The monitor begins with STF and STR.
    const auto terminals = drive_.read_monitor(kInputTerminals);
    out[1] = static_cast<std::uint8_t>((terminals ? *terminals : 0) >> 2);
    word(4, selected_monitor());
  }
}

// Attribute 3 of any instance, whether it is the selected one or not.
void CipUnit::append_assembly(std::uint32_t instance, Bytes& out) const {
  Image image{};
  const bool is_input = instance == kInput70 || instance == kInput71 || instance == kInput176 || instance == kInput179;
  if (is_input) {
    fill_input(state_.now, instance, image);
  } else if (instance == state_.assemblies.output) {
    image = state_.output;
  }
  out.insert(out.end(), image.begin(), image.begin() + static_cast<std::ptrdiff_t>(size_of_assembly(instance)));
}

}  // namespace vinv::boards::fr_a7ne
