#include "option_boards/canopen/pdo.hpp"

namespace vinv::canopen {
namespace {

constexpr std::uint16_t kLastDataType = 0x1f;  // indices up to here are data types: dummy entries

}  // namespace

Result<MappedObject, AbortCode> resolve_mapping(const ObjectTable& table, PdoDirection direction, std::uint32_t entry) {
  const auto index = static_cast<std::uint16_t>(entry >> 16);
  const auto sub = static_cast<std::uint8_t>(entry >> 8);
  const std::uint32_t bits = entry & 0xff;
  if (table.find(index) == nullptr) return Unexpected(AbortCode::kNoSuchObject);
  const ObjectRow* row = table.find(index, sub);
  if (row == nullptr) return Unexpected(AbortCode::kNoSuchSubindex);
  const bool mappable = direction == PdoDirection::kReceive ? row->in_rpdo : row->in_tpdo;
  // A data type's value is its own length in bits.
  const std::uint32_t bits_of_object = index <= kLastDataType ? row->raw_default : 8 * size_of(row->type);
  if (!mappable || bits != bits_of_object) return Unexpected(AbortCode::kNotMappable);
  const auto position = static_cast<std::uint16_t>(row - table.rows().data());
  return MappedObject{position, index, sub, static_cast<std::uint8_t>(bits / 8)};
}

}  // namespace vinv::canopen
