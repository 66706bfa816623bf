// Items (profile.hpp) of boards on EtherNet/IP: attributes that explicit messages reach, and what lies in the data of
// the I/O connection.
#pragma once

#include <cstdint>

#include "sim/masters/profile.hpp"

namespace vinv::masters::eip {

enum class ItemKind : std::uint8_t {
  kAttribute = 0,   // class << 16 | instance << 8 | attribute: Get_ and Set_Attribute_Single
  kInput = 1,       // offset in the input data; read from a packet that comes after the question
  kParameter = 2,   // as kAttribute, by the parameter bytes of output 126 and input 176
  kMonitor = 3,     // its number, by the monitor selection of output 129 and input 179
  kConnection = 4,  // written: the I/O connection, opened if there is none
  kProduction = 5,  // written: done when the output image has been sent
};

constexpr Item item(ItemKind kind, std::uint32_t rest = 0) { return static_cast<std::uint32_t>(kind) << 24 | rest; }
constexpr ItemKind kind_of(Item item) { return static_cast<ItemKind>(item >> 24); }
constexpr Item attribute(std::uint32_t class_id, std::uint32_t instance, std::uint32_t number) {
  return item(ItemKind::kAttribute, class_id << 16 | instance << 8 | number);
}
// For kOutput: bytes at an offset of the output image, or some bits of one byte.
constexpr Item image(std::uint32_t offset) { return offset; }
constexpr Item image_bits(std::uint32_t offset, std::uint32_t mask) { return mask << 8 | offset; }

}  // namespace vinv::masters::eip
