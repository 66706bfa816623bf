#include "sim/transports/can/error_frame.hpp"

#include <algorithm>

namespace vinv::transports {
namespace {

constexpr std::uint32_t kController = 0x004;  // CAN_ERR_CRTL, data[1]
constexpr std::uint32_t kProtocol = 0x008;    // CAN_ERR_PROT, data[2] type and data[3] place
constexpr std::uint32_t kAcknowledge = 0x020;
constexpr std::uint32_t kBusOff = 0x040;
constexpr std::uint32_t kBusError = 0x080;
constexpr std::uint32_t kRestarted = 0x100;
constexpr std::uint32_t kCounters = 0x200;  // data[6] TEC, data[7] REC

constexpr std::uint8_t kRxWarning = 0x04;
constexpr std::uint8_t kTxWarning = 0x08;
constexpr std::uint8_t kRxPassive = 0x10;
constexpr std::uint8_t kTxPassive = 0x20;
constexpr std::uint8_t kActive = 0x40;

constexpr std::uint8_t kBitError = 0x01;
constexpr std::uint8_t kStuffError = 0x04;
constexpr std::uint8_t kPlaceAckSlot = 0x19;
constexpr std::uint8_t kPlaceData = 0x0a;

}  // namespace

CanErrorFrame error_frame_of(const CanStatus& status) {
  CanErrorFrame f;
  f.error_class = kController | kCounters;
  f.data[6] = static_cast<std::uint8_t>(std::min(status.counters.tec, 255));
  f.data[7] = static_cast<std::uint8_t>(std::min(status.counters.rec, 255));
  const bool tx = status.counters.tec >= status.counters.rec;
  switch (status.state) {
    case CanState::kErrorActive: f.data[1] = kActive; break;
    case CanState::kErrorWarning: f.data[1] = tx ? kTxWarning : kRxWarning; break;
    case CanState::kErrorPassive: f.data[1] = tx ? kTxPassive : kRxPassive; break;
    case CanState::kBusOff:
    case CanState::kOffline: f.error_class = kBusOff | kCounters; break;
  }
  return f;
}

CanErrorFrame error_frame_of(CanErrorCause cause) {
  CanErrorFrame f;
  f.error_class = kProtocol | kBusError;
  switch (cause) {
    case CanErrorCause::kNoAcknowledge:
      f.error_class |= kAcknowledge;
      f.data[3] = kPlaceAckSlot;
      break;
    case CanErrorCause::kCorrupted:
    case CanErrorCause::kCollision:
      f.data[2] = kBitError;
      f.data[3] = kPlaceData;
      break;
    case CanErrorCause::kErrorFrame:
    case CanErrorCause::kOtherBitrate: f.data[2] = kStuffError; break;
  }
  return f;
}

CanErrorNews news_of(const CanErrorFrame& frame) {
  CanErrorNews news;
  if ((frame.error_class & kCounters) != 0) {
    news.has_counters = true;
    news.counters = {frame.data[6], frame.data[7]};
  }
  const auto tell = [&](CanState state) {
    news.has_state = true;
    news.state = state;
  };
  if ((frame.error_class & kController) != 0) {
    if ((frame.data[1] & (kRxPassive | kTxPassive)) != 0)
      tell(CanState::kErrorPassive);
    else if ((frame.data[1] & (kRxWarning | kTxWarning)) != 0)
      tell(CanState::kErrorWarning);
    else if ((frame.data[1] & kActive) != 0)
      tell(CanState::kErrorActive);
  }
  if ((frame.error_class & kRestarted) != 0) tell(CanState::kErrorActive);
  if ((frame.error_class & kBusOff) != 0) tell(CanState::kBusOff);
  return news;
}

}  // namespace vinv::transports
