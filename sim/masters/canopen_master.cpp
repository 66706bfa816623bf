#include "sim/masters/canopen_master.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {
namespace {

constexpr std::uint32_t kEmergencyCobId = 0x80;  // + node
constexpr std::uint32_t kFirstTpdo = 0x180;      // + 100H * (n - 1) + node
constexpr std::uint32_t kFirstRpdo = 0x200;
constexpr std::uint32_t kPdoStep = 0x100;
constexpr std::uint8_t kToggleBit = 0x80;

bool is_state(std::uint8_t byte) {
  using canopen::NmtState;
  const auto state = static_cast<NmtState>(byte);
  return state == NmtState::kInitialising || state == NmtState::kStopped || state == NmtState::kOperational ||
         state == NmtState::kPreOperational;
}

}  // namespace

CanopenMaster::CanopenMaster(const CanopenMasterSettings& settings)
    : settings_(settings), state_{SdoClient(settings.sdo_timeout), {}, {}, {}, {}, {}, 0} {}

void CanopenMaster::archive_state(Archive& a) {
  VINV_MEMBERS(*this, settings, state);
  VINV_FIELDS(a, CanopenMaster, settings, state);
  a.require(settings.node >= 1 && settings.node <= canopen::kLastNode, "a CANopen master has no node");
  a.require(!state.sync_at || settings.sync_interval > Duration{}, "SYNC has no interval");
  a.require(!state.heartbeat_at || settings.heartbeat_interval > Duration{}, "a heartbeat has no interval");
  for (const auto& [node, n] : state.nodes) {
    a.require(node >= 1 && node <= canopen::kLastNode && n.guard_time >= Duration{}, "a CANopen node is none");
    for (const Output& out : n.outputs) a.require(out.length <= out.data.size(), "a PDO is longer than a frame");
  }
}

void CanopenMaster::start(Instant now) {
  if (settings_.sync_interval > Duration{}) state_.sync_at = now + settings_.sync_interval;
  if (settings_.heartbeat_interval > Duration{}) state_.heartbeat_at = now;
}

void CanopenMaster::send(const CanFrame& frame) {
  if (state_.outgoing.size() >= kMaxOutgoing)
    ++state_.lost;
  else
    state_.outgoing.push_back(frame);
}

void CanopenMaster::push(CanopenEvent event) {
  if (state_.events.size() >= kMaxEvents) {
    state_.events.pop_front();
    ++state_.lost;
  }
  state_.events.push_back(std::move(event));
}

void CanopenMaster::push(CanopenEvent::Kind kind, std::uint8_t node) {
  CanopenEvent event;
  event.kind = kind;
  event.node = node;
  push(std::move(event));
}

void CanopenMaster::command(canopen::NmtCommand command, std::uint8_t node) {
  VINV_CHECK(node <= canopen::kLastNode);
  send(CanFrame::standard(canopen::kNmtCobId, {static_cast<std::uint8_t>(command), node}));
}

void CanopenMaster::guard(Instant now, std::uint8_t node, Duration guard_time, unsigned life_time_factor) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode && life_time_factor >= 1);
  Node& n = state_.nodes[node];
  n.guard_time = guard_time;
  n.life_time_factor = life_time_factor;
  n.guard_at = now;
  n.toggle.reset();
  n.guard_lost = false;
  n.life_ends_at.reset();
  if (guard_time > Duration{}) n.life_ends_at = now + guard_time * life_time_factor;
}

void CanopenMaster::watch_heartbeat(std::uint8_t node, Duration timeout) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode);
  Node& n = state_.nodes[node];
  n.heartbeat_timeout = timeout;
  n.heartbeat_by.reset();
}

void CanopenMaster::set_output(std::uint8_t node, unsigned pdo, unsigned offset, unsigned size, std::uint32_t raw) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode && pdo >= 1 && pdo <= kPdos && size >= 1 && size <= 4);
  Output& out = state_.nodes[node].outputs[pdo - 1];
  VINV_CHECK(offset + size <= out.data.size());
  for (unsigned i = 0; i < size; ++i) out.data[offset + i] = static_cast<std::uint8_t>(raw >> 8 * i);
  out.length = std::max(out.length, static_cast<std::uint8_t>(offset + size));
}

void CanopenMaster::send_output(std::uint8_t node, unsigned pdo) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode && pdo >= 1 && pdo <= kPdos);
  const Output& out = state_.nodes[node].outputs[pdo - 1];
  CanFrame frame;
  frame.id = kFirstRpdo + kPdoStep * (pdo - 1) + node;
  frame.length = out.length;
  frame.data = out.data;
  send(frame);
}

void CanopenMaster::send_output_cyclically(std::uint8_t node, unsigned pdo, bool on) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode && pdo >= 1 && pdo <= kPdos);
  state_.nodes[node].outputs[pdo - 1].cyclic = on;
}

void CanopenMaster::request_input(std::uint8_t node, unsigned pdo, std::uint8_t length) {
  VINV_CHECK(node >= 1 && node <= canopen::kLastNode && pdo >= 1 && pdo <= kPdos && length <= 8);
  send(CanFrame::remote_request(kFirstTpdo + kPdoStep * (pdo - 1) + node, length));
}

void CanopenMaster::send_sync() {
  for (const auto& [node, n] : state_.nodes)
    for (unsigned pdo = 1; pdo <= kPdos; ++pdo)
      if (n.outputs[pdo - 1].cyclic) send_output(node, pdo);
  CanFrame sync;
  sync.id = settings_.sync_cob_id;
  send(sync);
}

void CanopenMaster::handle_frame(Instant now, const CanFrame& frame) {
  handle_timeout(now);
  if (frame.remote || frame.extended) return;
  if (state_.sdo.handle_frame(frame)) return collect_sdo_results();
  const auto node = static_cast<std::uint8_t>(frame.id & canopen::kLastNode);
  if (node == 0) return;
  const std::uint32_t function = frame.id - node;
  if (function == canopen::kGuardCobId) return handle_error_control(now, node, frame);
  if (function == kEmergencyCobId) {
    if (frame.length != 8) return;
    CanopenEvent event;
    event.kind = CanopenEvent::Kind::kEmergency;
    event.node = node;
    event.emergency.error_code = read_le16(frame.bytes(), 0);
    event.emergency.error_register = frame.data[2];
    std::copy_n(frame.data.begin() + 3, 5, event.emergency.manufacturer.begin());
    Node& n = state_.nodes[node];
    n.emergency = event.emergency;
    ++n.emergencies;
    return push(std::move(event));
  }
  for (unsigned pdo = 1; pdo <= kPdos; ++pdo) {
    if (function != kFirstTpdo + kPdoStep * (pdo - 1)) continue;
    CanopenEvent event;
    event.kind = CanopenEvent::Kind::kPdo;
    event.node = node;
    event.pdo = frame;
    return push(std::move(event));
  }
}

void CanopenMaster::set_state(std::uint8_t node, Node& n, canopen::NmtState state) {
  if (std::exchange(n.state, state) == state) return;
  CanopenEvent event;
  event.kind = CanopenEvent::Kind::kState;
  event.node = node;
  event.state = state;
  push(std::move(event));
}

void CanopenMaster::handle_error_control(Instant now, std::uint8_t node, const CanFrame& frame) {
  if (frame.length != 1) return;
  const bool toggle = (frame.data[0] & kToggleBit) != 0;
  const auto byte = static_cast<std::uint8_t>(frame.data[0] & ~kToggleBit);
  if (!is_state(byte)) return;
  Node& n = state_.nodes[node];
  const auto state = static_cast<canopen::NmtState>(byte);
  if (state == canopen::NmtState::kInitialising) {  // boot-up; the toggle bit starts anew
    n.toggle = false;
    n.state = canopen::NmtState::kPreOperational;
    return push(CanopenEvent::Kind::kBootUp, node);
  }
  if (n.guard_time > Duration{}) {
    handle_guard_answer(now, node, n, toggle);
  } else if (n.heartbeat_timeout > Duration{}) {
    n.heartbeat_by = now + n.heartbeat_timeout;
  }
  set_state(node, n, state);
}

void CanopenMaster::handle_guard_answer(Instant now, std::uint8_t node, Node& n, bool toggle) {
  if (n.toggle && *n.toggle != toggle) push(CanopenEvent::Kind::kGuardToggle, node);
  n.toggle = !toggle;
  if (std::exchange(n.guard_lost, false)) push(CanopenEvent::Kind::kGuardBack, node);
  n.life_ends_at = now + n.guard_time * n.life_time_factor;
}

void CanopenMaster::handle_timeout(Instant now) {
  state_.sdo.handle_timeout(now);
  collect_sdo_results();
  if (state_.heartbeat_at && now >= *state_.heartbeat_at) {
    *state_.heartbeat_at +=
        settings_.heartbeat_interval * ((now - *state_.heartbeat_at) / settings_.heartbeat_interval + 1);
    send(CanFrame::standard(canopen::kGuardCobId + settings_.node,
                            {static_cast<std::uint8_t>(canopen::NmtState::kOperational)}));
  }
  if (state_.sync_at && now >= *state_.sync_at) {
    *state_.sync_at += settings_.sync_interval * ((now - *state_.sync_at) / settings_.sync_interval + 1);
    send_sync();
  }
  for (auto& [node, n] : state_.nodes) {
    if (n.guard_time > Duration{} && now >= n.guard_at) {
      n.guard_at += n.guard_time * ((now - n.guard_at) / n.guard_time + 1);
      send(CanFrame::remote_request(canopen::kGuardCobId + node, 1));
    }
    if (n.life_ends_at && now >= *n.life_ends_at) {
      n.life_ends_at.reset();
      n.guard_lost = true;
      push(CanopenEvent::Kind::kGuardLost, node);
    }
    if (n.heartbeat_by && now >= *n.heartbeat_by) {
      n.heartbeat_by.reset();
      push(CanopenEvent::Kind::kHeartbeatLost, node);
    }
  }
}

std::optional<Instant> CanopenMaster::next_deadline() const {
  std::optional<Instant> next = state_.sdo.next_deadline();
  const auto consider = [&](const std::optional<Instant>& at) {
    if (at && (!next || *at < *next)) next = at;
  };
  consider(state_.heartbeat_at);
  consider(state_.sync_at);
  for (const auto& [node, n] : state_.nodes) {
    if (n.guard_time > Duration{}) consider(n.guard_at);
    consider(n.life_ends_at);
    consider(n.heartbeat_by);
  }
  return next;
}

std::optional<CanFrame> CanopenMaster::poll_transmit(Instant now) {
  if (!state_.outgoing.empty()) {
    const CanFrame frame = state_.outgoing.front();
    state_.outgoing.pop_front();
    return frame;
  }
  return state_.sdo.poll_transmit(now);
}

void CanopenMaster::collect_sdo_results() {
  while (auto result = state_.sdo.poll_result()) {
    CanopenEvent event;
    event.kind = CanopenEvent::Kind::kSdo;
    event.node = result->transfer.node;
    event.sdo = std::move(result);
    push(std::move(event));
  }
}

std::optional<CanopenEvent> CanopenMaster::poll_event() {
  if (state_.events.empty()) return std::nullopt;
  CanopenEvent first = std::move(state_.events.front());
  state_.events.pop_front();
  return first;
}

canopen::NmtState CanopenMaster::state_of(std::uint8_t node) const {
  const auto it = state_.nodes.find(node);
  return it == state_.nodes.end() ? canopen::NmtState::kOff : it->second.state;
}

std::optional<CanopenEmergency> CanopenMaster::emergency_of(std::uint8_t node) const {
  const auto it = state_.nodes.find(node);
  return it == state_.nodes.end() ? std::nullopt : it->second.emergency;
}

std::uint64_t CanopenMaster::emergencies_of(std::uint8_t node) const {
  const auto it = state_.nodes.find(node);
  return it == state_.nodes.end() ? 0 : it->second.emergencies;
}

}  // namespace vinv::masters
