// Reads and writes of the dictionary; the objects of the communication profile. CiA DS-301 v4.0, 9.6.3.
#include <utility>

#include "option_boards/canopen/slave.hpp"
#include "sim/base/check.hpp"

namespace vinv::canopen {
namespace {

enum Index : std::uint16_t {
  kCobIdSync = 0x1005,
  kNodeId = 0x100b,
  kGuardTime = 0x100c,
  kLifeTimeFactor = 0x100d,
  kCobIdEmergency = 0x1014,
  kRpdoCommunication = 0x1400,
  kRpdoMapping = 0x1600,
  kTpdoCommunication = 0x1800,
  kTpdoMapping = 0x1a00,
  kPastTpdoMapping = 0x1c00,
};

enum PdoSub : std::uint8_t { kEntries, kCobId, kTransmissionType, kInhibitTime, kReserved, kEventTimer };

constexpr std::uint8_t kRpdoEntries = 2, kTpdoEntries = 5;

struct PdoObject {
  PdoDirection direction;
  bool mapping;
  std::size_t pdo;
};

// The identifier of an object that exists must not change; taking the object away and giving it another identifier
// may be one step.
bool moves_while_valid(std::uint32_t before, std::uint32_t after) {
  return ((before | after) & kCobIdInvalid) == 0 && ((before ^ after) & kCobIdMask) != 0;
}

// Empty: not an object of a PDO.
std::optional<PdoObject> pdo_object(std::uint16_t index) {
  if (index < kRpdoCommunication || index >= kPastTpdoMapping) return std::nullopt;
  const auto direction = index < kTpdoCommunication ? PdoDirection::kReceive : PdoDirection::kTransmit;
  const bool mapping = (index & 0x200) != 0;
  return PdoObject{direction, mapping, static_cast<std::size_t>(index & 0x1ff)};
}

}  // namespace

PdoSettings& Slave::settings(PdoDirection direction, std::size_t pdo) {
  VINV_CHECK(pdo < kPdos);
  return direction == PdoDirection::kReceive ? state_.rpdos[pdo].settings : state_.tpdos[pdo].settings;
}

const PdoSettings& Slave::settings(PdoDirection direction, std::size_t pdo) const {
  VINV_CHECK(pdo < kPdos);
  return direction == PdoDirection::kReceive ? state_.rpdos[pdo].settings : state_.tpdos[pdo].settings;
}

Result<std::uint32_t, AbortCode> Slave::read(const ObjectRow& row, std::uint16_t index, std::uint8_t sub) const {
  if (!row.readable) return Unexpected(AbortCode::kWriteOnly);
  switch (row.item) {
    case kCommunication: return read_communication(index, sub);
    case kConstant: return row.raw_default;
    case kErrorRegister: return std::uint32_t{application_.error_register()};
    default: return application_.read(row, index, sub);
  }
}

std::optional<WriteResult> Slave::download(Instant now, const SdoRequest& request) {
  const auto found = find(request.index, request.sub);
  if (!found) return WriteResult(Unexpected(found.error()));
  const ObjectRow& row = **found;
  if (!row.writable) return WriteResult(Unexpected(AbortCode::kReadOnly));
  const unsigned size = size_of(row.type);
  // Without an indicated size the client means the object's own.
  if (request.size != 0 && request.size != size) return WriteResult(Unexpected(AbortCode::kLengthMismatch));
  const std::uint32_t raw = size < 4 ? request.raw_value & ((1u << 8 * size) - 1) : request.raw_value;
  const std::int64_t value = row.value_of(raw);
  if (value < row.min || value > row.max) return WriteResult(Unexpected(AbortCode::kValueRange));
  if (row.item == kCommunication) return write_communication(now, request.index, request.sub, raw);
  return application_.write(now, Origin::kSdo, row, request.index, request.sub, raw);
}

std::uint32_t Slave::read_communication(std::uint16_t index, std::uint8_t sub) const {
  switch (index) {
    case kCobIdSync: return state_.sync_cob_id;
    case kNodeId: return state_.node;
    case kGuardTime: return state_.guard_time;
    case kLifeTimeFactor: return state_.life_time_factor;
    case kCobIdEmergency: return state_.emergency_cob_id;
    default: break;
  }
  const auto object = pdo_object(index);
  VINV_CHECK(object.has_value());
  const PdoSettings& s = settings(object->direction, object->pdo);
  if (object->mapping) return sub == kEntries ? s.mapped : s.mapping[sub - 1u];
  switch (sub) {
    case kEntries: return object->direction == PdoDirection::kReceive ? kRpdoEntries : kTpdoEntries;
    case kCobId: return s.cob_id;
    case kTransmissionType: return s.transmission_type;
    case kInhibitTime: return s.inhibit_time;
    case kReserved: return s.reserved;
    default: return s.event_timer;
  }
}

WriteResult Slave::write_communication(Instant now, std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  switch (index) {
    case kCobIdSync:
      // A consumer with 11-bit identifiers: bits 30 (producer) and 29 (29 bits) cannot be set, bit 31 has no meaning.
      if (!is_cob_id(value & ~kCobIdInvalid, 0)) return Unexpected(AbortCode::kValueRange);
      state_.sync_cob_id = value;
      return {};
    case kCobIdEmergency:
      if (!is_cob_id(value, kCobIdInvalid)) return Unexpected(AbortCode::kValueRange);
      if (moves_while_valid(state_.emergency_cob_id, value)) return Unexpected(AbortCode::kDeviceState);
      state_.emergency_cob_id = value;
      if ((value & kCobIdInvalid) != 0) state_.emergencies = {};
      return {};
    case kGuardTime:
    case kLifeTimeFactor:
      if (index == kGuardTime) {
        state_.guard_time = static_cast<std::uint16_t>(value);
      } else {
        state_.life_time_factor = static_cast<std::uint8_t>(value);
      }
      // A new life time counts from now, if the master guards at all.
      state_.life_ends_at.reset();
      if (state_.guarded && !state_.guarding_lost && life_time() > Duration::zero()) {
        state_.life_ends_at = now + life_time();
      }
      return {};
    default: break;
  }
  const auto object = pdo_object(index);
  VINV_CHECK(object.has_value());
  return object->mapping ? write_pdo_mapping(object->direction, object->pdo, sub, value)
                         : write_pdo_communication(now, object->direction, object->pdo, sub, value);
}

WriteResult Slave::write_pdo_communication(Instant now, PdoDirection direction, std::size_t pdo, std::uint8_t sub,
                                           std::uint32_t value) {
  PdoSettings& s = settings(direction, pdo);
  switch (sub) {
    case kCobId: {
      if (!is_cob_id(value, kCobIdInvalid | kCobIdNoRtr)) return Unexpected(AbortCode::kValueRange);
      if (moves_while_valid(s.cob_id, value)) return Unexpected(AbortCode::kDeviceState);
      s.cob_id = value;
      break;
    }
    case kTransmissionType:
      if (!is_transmission_type(direction, static_cast<std::uint8_t>(value))) return Unexpected(AbortCode::kValueRange);
      s.transmission_type = static_cast<std::uint8_t>(value);
      break;
    case kInhibitTime:
      if (s.valid()) return Unexpected(AbortCode::kDeviceState);
      s.inhibit_time = static_cast<std::uint16_t>(value);
      break;
    case kReserved: s.reserved = static_cast<std::uint8_t>(value); break;
    default: s.event_timer = static_cast<std::uint16_t>(value); break;
  }
  if (direction == PdoDirection::kTransmit) {
    restart_tpdo(now, pdo);
  } else {
    Rpdo& rpdo = state_.rpdos[pdo];
    rpdo.buffered = false;
    // Set up anew: what was wrong with it is over.
    if (std::exchange(rpdo.too_short, false)) {
      application_.on_pdo_fault(now, PdoFault::kRpdoGoodAgain, static_cast<unsigned>(pdo));
    }
  }
  return {};
}

// The order of DS-301: PDO not valid, sub-index 0 to 0, entries, sub-index 0 to their number, PDO valid.
WriteResult Slave::write_pdo_mapping(PdoDirection direction, std::size_t pdo, std::uint8_t sub, std::uint32_t value) {
  PdoSettings& s = settings(direction, pdo);
  if (s.valid()) return Unexpected(AbortCode::kDeviceState);
  if (sub == kEntries) return activate_mapping(direction, pdo, static_cast<std::uint8_t>(value));
  if (s.mapped != 0) return Unexpected(AbortCode::kDeviceState);
  if (value != 0) {  // 0 empties the entry
    const auto object = resolve_mapping(table_, direction, value);
    if (!object) return Unexpected(object.error());
    const ObjectRow& row = table_.rows()[object->row];
    if (row.item >= kFirstApplicationItem && !application_.exists(row, object->index)) {
      return Unexpected(AbortCode::kNoSuchObject);
    }
  }
  s.mapping[sub - 1u] = value;
  return {};
}

WriteResult Slave::activate_mapping(PdoDirection direction, std::size_t pdo, std::uint8_t count) {
  PdoSettings& s = settings(direction, pdo);
  std::array<MappedObject, kMaxMapped> objects{};
  unsigned length = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (s.mapping[i] == 0) return Unexpected(AbortCode::kNotMappable);
    const auto object = resolve_mapping(table_, direction, s.mapping[i]);
    if (!object) return Unexpected(object.error());
    objects[i] = *object;
    length += object->size;
  }
  if (length > kMaxPdoLength) return Unexpected(AbortCode::kPdoLengthExceeded);
  s.objects = objects;
  s.length = static_cast<std::uint8_t>(length);
  s.mapped = count;
  return {};
}

void Slave::set_default(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  switch (index) {
    case kCobIdSync: state_.sync_cob_id = value; return;
    case kNodeId: return;
    case kGuardTime: state_.guard_time = static_cast<std::uint16_t>(value); return;
    case kLifeTimeFactor: state_.life_time_factor = static_cast<std::uint8_t>(value); return;
    case kCobIdEmergency: state_.emergency_cob_id = value; return;
    default: break;
  }
  const auto object = pdo_object(index);
  VINV_CHECK(object.has_value());
  PdoSettings& s = settings(object->direction, object->pdo);
  if (object->mapping) {
    if (sub == kEntries) {
      s.mapped = static_cast<std::uint8_t>(value);
      return;
    }
    VINV_CHECK(sub <= kMaxMapped);
    s.mapping[sub - 1u] = value;
    // The number came first; with its last entry the mapping is complete.
    if (sub == s.mapped) VINV_CHECK(activate_mapping(object->direction, object->pdo, s.mapped).has_value());
    return;
  }
  switch (sub) {
    case kEntries: break;
    case kCobId: s.cob_id = value; break;
    case kTransmissionType: s.transmission_type = static_cast<std::uint8_t>(value); break;
    case kInhibitTime: s.inhibit_time = static_cast<std::uint16_t>(value); break;
    case kReserved: s.reserved = static_cast<std::uint8_t>(value); break;
    default: s.event_timer = static_cast<std::uint16_t>(value); break;
  }
}

}  // namespace vinv::canopen
