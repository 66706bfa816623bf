// When PDOs are taken and sent. CiA DS-301 v4.0, 9.2.1.
#include <utility>

#include "option_boards/canopen/slave.hpp"

namespace vinv::canopen {

// Unspecified: what an event-driven TPDO does when the node becomes OPERATIONAL. It is sent once, so that consumers
// have a first value.
void Slave::start_pdos(Instant now) {
  for (Rpdo& rpdo : state_.rpdos) rpdo.buffered = false;
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) restart_tpdo(now, pdo);
}

void Slave::restart_tpdo(Instant now, std::size_t pdo) {
  Tpdo& tpdo = state_.tpdos[pdo];
  Tpdo fresh;
  fresh.settings = tpdo.settings;
  tpdo = fresh;
  if (state_.nmt != NmtState::kOperational || !tpdo.settings.active()) return;
  if (is_event_driven(tpdo.settings.transmission_type)) trigger(now, tpdo);
}

void Slave::handle_sync(Instant now) {
  for (Rpdo& rpdo : state_.rpdos) {
    if (!rpdo.buffered) continue;
    rpdo.buffered = false;
    apply(now, rpdo);
  }
  for (Tpdo& tpdo : state_.tpdos) {
    const PdoSettings& s = tpdo.settings;
    if (!s.active()) continue;
    if (s.transmission_type == kAcyclicSynchronous) {
      const auto data = sample(s);
      if (tpdo.sent && data == tpdo.last_sent) continue;
      tpdo.sample = data;
      tpdo.transmit = true;
    } else if (is_synchronous(s.transmission_type)) {
      if (++tpdo.syncs < s.transmission_type) continue;
      tpdo.syncs = 0;
      tpdo.sample = sample(s);
      tpdo.transmit = true;
    } else if (s.transmission_type == kSynchronousRtrOnly) {
      tpdo.sample = sample(s);
      tpdo.sampled = true;
    }
  }
}

void Slave::handle_rpdo(Instant now, std::size_t pdo, const CanFrame& frame) {
  Rpdo& rpdo = state_.rpdos[pdo];
  const bool too_short = frame.length < rpdo.settings.length;
  if (too_short != rpdo.too_short) {
    rpdo.too_short = too_short;
    application_.on_pdo_fault(now, too_short ? PdoFault::kRpdoTooShort : PdoFault::kRpdoGoodAgain,
                              static_cast<unsigned>(pdo));
  }
  if (too_short) return;
  rpdo.data = frame.data;
  if (is_synchronous(rpdo.settings.transmission_type)) {
    rpdo.buffered = true;
  } else {
    apply(now, rpdo);
  }
}

void Slave::apply(Instant now, const Rpdo& rpdo) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < rpdo.settings.mapped; ++i) {
    const MappedObject& object = rpdo.settings.objects[i];
    std::uint32_t raw = 0;
    for (std::size_t n = object.size; n-- > 0;) raw = raw << 8 | rpdo.data[at + n];
    at += object.size;
    const ObjectRow& row = table_.rows()[object.row];
    if (row.item < kFirstApplicationItem) continue;  // a dummy entry
    application_.write(now, Origin::kPdo, row, object.index, object.sub, raw);
  }
}

// Types 252 to 255 may be asked for; synchronous ones go with the SYNC only. Bit 30 of the COB-ID forbids all requests.
void Slave::handle_tpdo_request(Instant now, std::size_t pdo) {
  Tpdo& tpdo = state_.tpdos[pdo];
  const PdoSettings& s = tpdo.settings;
  if ((s.cob_id & kCobIdNoRtr) != 0 || is_synchronous(s.transmission_type)) return;
  if (s.transmission_type == kSynchronousRtrOnly) {
    if (!tpdo.sampled) {
      if (!std::exchange(tpdo.asked_early, true)) {
        application_.on_pdo_fault(now, PdoFault::kTpdoNotSampled, static_cast<unsigned>(pdo));
      }
      return;
    }
  } else {
    tpdo.sample = sample(s);
  }
  tpdo.transmit = true;
}

std::array<std::uint8_t, kMaxPdoLength> Slave::sample(const PdoSettings& settings) const {
  std::array<std::uint8_t, kMaxPdoLength> data{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < settings.mapped; ++i) {
    const MappedObject& object = settings.objects[i];
    // What cannot be read now (start-up, reset) is sent as 0.
    std::uint32_t raw = read(table_.rows()[object.row], object.index, object.sub).value_or(0u);
    for (unsigned n = 0; n < object.size; ++n, raw >>= 8) data[at++] = static_cast<std::uint8_t>(raw);
  }
  return data;
}

void Slave::trigger(Instant now, Tpdo& tpdo) {
  tpdo.event = true;
  if (tpdo.inhibit_until && now < *tpdo.inhibit_until) return;
  tpdo.event = false;
  tpdo.sample = sample(tpdo.settings);
  tpdo.transmit = true;
}

void Slave::handle_new_data(Instant now) {
  if (state_.nmt != NmtState::kOperational) return;
  for (Tpdo& tpdo : state_.tpdos) {
    const PdoSettings& s = tpdo.settings;
    if (!s.active() || !is_event_driven(s.transmission_type) || tpdo.event) continue;
    const auto& known = tpdo.transmit || !tpdo.sent ? tpdo.sample : tpdo.last_sent;
    if (sample(s) != known) trigger(now, tpdo);
  }
}

CanFrame Slave::emit(Instant now, Tpdo& tpdo) {
  const PdoSettings& s = tpdo.settings;
  CanFrame frame;
  frame.id = s.cob_id & kCobIdMask;
  frame.length = s.length;
  frame.data = tpdo.sample;
  tpdo.transmit = false;
  tpdo.sent = true;
  tpdo.last_sent = tpdo.sample;
  if (is_event_driven(s.transmission_type)) {
    tpdo.inhibit_until.reset();
    tpdo.event_at.reset();
    if (s.inhibit() > Duration::zero()) tpdo.inhibit_until = now + s.inhibit();
    if (s.event_interval() > Duration::zero()) tpdo.event_at = now + s.event_interval();
  }
  return frame;
}

}  // namespace vinv::canopen
