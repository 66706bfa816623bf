// NMT, guarding, SDO transport, EMCY and the order of what is sent.
#include "option_boards/canopen/slave.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::canopen {
namespace {

constexpr std::uint8_t kNmtLength = 2;
constexpr std::uint8_t kToggleBit = 0x80;

}  // namespace

void Slave::start(Instant now, std::uint8_t node) {
  VINV_CHECK(node >= 1 && node <= kLastNode);
  state_ = State{};
  state_.node = node;
  reset_communication();
  enter(now, NmtState::kPreOperational);
}

void Slave::stop() {
  static_assert(std::is_trivially_copyable_v<State>);  // so that a copy of it is a snapshot
  state_ = State{};
}

// All that DS-301 calls the communication profile area goes back to its power-on values; the node boots.
void Slave::reset_communication() {
  const std::uint8_t node = state_.node;
  state_ = State{};
  state_.node = node;
  state_.nmt = NmtState::kInitialising;
  state_.boot_up = true;
  for (const ObjectRow& row : table_.rows()) {
    if (row.item != kCommunication) continue;
    for (std::uint32_t index = row.first; index <= row.last; ++index) {
      for (std::uint32_t sub = row.first_sub; sub <= row.last_sub; ++sub) {
        set_default(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub),
                    row.raw_default + (row.default_adds_node ? node : 0u));
      }
    }
  }
}

void Slave::handle_frame(Instant now, const CanFrame& frame) {
  if (!on_bus() || frame.extended) return;
  if (frame.id == kNmtCobId) {
    handle_nmt(now, frame);
    return;
  }
  if (frame.id == kGuardCobId + state_.node) {
    if (frame.remote) handle_guard_request(now);
    return;
  }
  if (!may_talk()) return;
  if (frame.id == kSdoRequestCobId + state_.node) {
    handle_sdo(now, frame);
    return;
  }
  if (state_.nmt != NmtState::kOperational) return;
  if (!frame.remote && frame.id == (state_.sync_cob_id & kCobIdMask)) handle_sync(now);
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    if (!frame.remote && state_.rpdos[pdo].settings.has_id(frame.id)) handle_rpdo(now, pdo, frame);
    if (frame.remote && state_.tpdos[pdo].settings.has_id(frame.id)) handle_tpdo_request(now, pdo);
  }
}

void Slave::handle_nmt(Instant now, const CanFrame& frame) {
  if (frame.remote || frame.length != kNmtLength) return;
  if (frame.data[1] != 0 && frame.data[1] != state_.node) return;
  const auto command = static_cast<NmtCommand>(frame.data[0]);
  const NmtState before = state_.nmt;
  switch (command) {
    case NmtCommand::kStart: enter(now, NmtState::kOperational); break;
    case NmtCommand::kStop: enter(now, NmtState::kStopped); break;
    case NmtCommand::kEnterPreOperational: enter(now, NmtState::kPreOperational); break;
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      if (state_.download) application_.abandon_download();
      reset_communication();
      enter(now, NmtState::kPreOperational);
      break;
    default: return;
  }
  application_.on_nmt_command(now, command, before);
}

void Slave::enter(Instant now, NmtState next) {
  const NmtState before = std::exchange(state_.nmt, next);
  if (before == next) return;
  if (next == NmtState::kOperational) {
    start_pdos(now);
  } else {
    for (Tpdo& tpdo : state_.tpdos) tpdo.transmit = false;
  }
  if (next == NmtState::kStopped) {
    if (state_.download) application_.abandon_download();
    state_.download.reset();
    state_.sdo_answers = {};
    state_.emergencies.keep_newest();
  }
}

Duration Slave::life_time() const {
  return std::chrono::milliseconds(std::uint32_t{state_.guard_time} * state_.life_time_factor);
}

void Slave::handle_guard_request(Instant now) {
  state_.guard_answer = true;
  state_.guarded = true;
  state_.life_ends_at.reset();
  if (life_time() > Duration::zero()) state_.life_ends_at = now + life_time();
  if (std::exchange(state_.guarding_lost, false)) application_.on_guarding(now, false);
}

Result<const ObjectRow*, AbortCode> Slave::find(std::uint16_t index, std::uint8_t sub) const {
  const ObjectRow* any = table_.find(index);
  if (any == nullptr || (any->item >= kFirstApplicationItem && !application_.exists(*any, index))) {
    return Unexpected(AbortCode::kNoSuchObject);
  }
  const ObjectRow* row = table_.find(index, sub);
  if (row == nullptr) return Unexpected(AbortCode::kNoSuchSubindex);
  return row;
}

void Slave::handle_sdo(Instant now, const CanFrame& frame) {
  const auto request = parse_sdo_request(frame);
  if (!request) return;
  // One transfer at a time: whatever comes now, the client gave up a download that is not decided yet.
  if (std::exchange(state_.download, std::nullopt)) application_.abandon_download();
  const std::uint32_t cob_id = kSdoAnswerCobId + state_.node;
  switch (request->kind) {
    case SdoRequest::Kind::kAbort: break;
    case SdoRequest::Kind::kUnsupported:
      state_.sdo_answers.push(emit_abort(cob_id, request->index, request->sub, AbortCode::kCommandSpecifier));
      break;
    case SdoRequest::Kind::kUpload: {
      const auto row = find(request->index, request->sub);
      const auto value =
          row ? read(**row, request->index, request->sub) : Result<std::uint32_t, AbortCode>(Unexpected(row.error()));
      state_.sdo_answers.push(
          value ? emit_upload_answer(cob_id, request->index, request->sub, *value, size_of((*row)->type))
                : emit_abort(cob_id, request->index, request->sub, value.error()));
      break;
    }
    case SdoRequest::Kind::kDownload: {
      const auto result = download(now, *request);
      if (result) {
        answer_download(request->index, request->sub, *result);
      } else {
        state_.download = Download{request->index, request->sub};
      }
      break;
    }
  }
}

void Slave::answer_download(std::uint16_t index, std::uint8_t sub, const WriteResult& result) {
  const std::uint32_t cob_id = kSdoAnswerCobId + state_.node;
  state_.sdo_answers.push(result ? emit_download_answer(cob_id, index, sub)
                                 : emit_abort(cob_id, index, sub, result.error()));
}

void Slave::complete_download(const WriteResult& result) {
  const auto download = std::exchange(state_.download, std::nullopt);
  if (download) answer_download(download->index, download->sub, result);
}

void Slave::send_emergency(const Emergency& emergency) {
  if (!on_bus() || (state_.emergency_cob_id & kCobIdInvalid) != 0) return;
  state_.emergencies.push({emergency, application_.error_register()});
  if (state_.nmt == NmtState::kStopped) state_.emergencies.keep_newest();
}

void Slave::handle_timeout(Instant now) {
  if (!on_bus()) return;
  if (state_.life_ends_at && now >= *state_.life_ends_at) {
    state_.life_ends_at.reset();
    state_.guarding_lost = true;
    application_.on_guarding(now, true);
  }
  if (state_.nmt != NmtState::kOperational) return;
  for (Tpdo& tpdo : state_.tpdos) {
    if (tpdo.inhibit_until && now >= *tpdo.inhibit_until) {
      tpdo.inhibit_until.reset();
      if (tpdo.event) trigger(now, tpdo);
    }
    if (tpdo.event_at && now >= *tpdo.event_at) {
      tpdo.event_at.reset();
      trigger(now, tpdo);
    }
  }
}

std::optional<Instant> Slave::next_deadline() const {
  std::optional<Instant> next = state_.life_ends_at;
  const auto consider = [&next](const std::optional<Instant>& at) {
    if (at && (!next || *at < *next)) next = at;
  };
  if (state_.nmt == NmtState::kOperational) {
    for (const Tpdo& tpdo : state_.tpdos) {
      if (tpdo.event) consider(tpdo.inhibit_until);
      consider(tpdo.event_at);
    }
  }
  return next;
}

std::optional<CanFrame> Slave::poll_transmit(Instant now) {
  if (!on_bus()) return std::nullopt;
  const std::uint32_t guard_cob_id = kGuardCobId + state_.node;
  if (std::exchange(state_.boot_up, false)) return CanFrame::standard(guard_cob_id, {0});
  if (may_talk() && state_.emergencies.count > 0) {
    const auto [emergency, error_register] = state_.emergencies.pop();
    const auto& m = emergency.manufacturer;
    return CanFrame::standard(
        state_.emergency_cob_id & kCobIdMask,
        {static_cast<std::uint8_t>(emergency.error_code), static_cast<std::uint8_t>(emergency.error_code >> 8),
         error_register, m[0], m[1], m[2], m[3], m[4]});
  }
  for (Tpdo& tpdo : state_.tpdos) {
    if (tpdo.transmit) return emit(now, tpdo);
  }
  if (state_.sdo_answers.count > 0) return state_.sdo_answers.pop();
  if (std::exchange(state_.guard_answer, false)) {
    const auto status = static_cast<std::uint8_t>(state_.nmt) | (state_.toggle ? kToggleBit : 0u);
    state_.toggle = !state_.toggle;
    return CanFrame::standard(guard_cob_id, {static_cast<std::uint8_t>(status)});
  }
  return std::nullopt;
}

}  // namespace vinv::canopen
