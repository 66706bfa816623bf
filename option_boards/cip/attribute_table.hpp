// Objects as tables: one CSV row per attribute or range of attributes, as a manual prints them, and one per service.
//
// Attribute columns: class, instance, attribute, last_attribute (a range), name, type, access (Get, Set, Get/Set), min,
// max, default, binding, argument, detail; further columns (section, test, notes) are for people.
//   binding  the name of what gives and takes the value; "constant": the default is the value
//   argument, detail  what the binding needs to know (a parameter's number); of a range for the first attribute
//   min, max  what may be written, where the attribute is one whole number; empty: the type's range
// Service columns: class, last_class (a range), instance, last_instance, service, name, binding; further ones for
// people.
//   binding  get_single, set_single, get_all: served from the attributes; any other: the device's own
// Instance 0 is the class. Numbers are decimal or 0x.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "option_boards/cip/data_types.hpp"

namespace vinv::cip {

struct AttributeRow {
  std::uint16_t class_id = 0;
  std::uint32_t instance = 0;
  std::uint16_t first = 0, last = 0;
  std::string_view name;
  TypeSpec type;
  bool gettable = false, settable = false;
  std::int64_t min = 0, max = 0;
  std::string_view constant;  // the default column
  Bytes value;                // the same as it travels, where it is the value
  std::uint8_t binding = 0;   // position in the list of names; 0 is constant
  std::int32_t argument = 0, detail = 0;
};

// A row and which of its attributes is meant.
struct Attribute {
  const AttributeRow& row;
  std::uint16_t number = 0;
  std::int32_t argument() const { return row.argument + (number - row.first); }
};

struct ServiceRow {
  std::uint16_t first_class = 0, last_class = 0;
  std::uint32_t first_instance = 0, last_instance = 0;
  std::uint8_t code = 0;
  std::string_view name;
  std::uint8_t binding = 0;  // position in the list of names, after the three of TableService
};
enum TableService : std::uint8_t { kServeGetSingle, kServeSetSingle, kServeGetAll, kFirstOwnService };

class AttributeTable {
 public:
  // Tables of this tree; the texts outlive the table. attribute_bindings[0] is "constant"; own_services are the
  // device's names after get_single, set_single, get_all. A mistake in a table ends the process.
  AttributeTable(std::string_view attributes_csv, std::span<const std::string_view> attribute_bindings,
                 std::string_view services_csv, std::span<const std::string_view> own_services);

  // In order of class, instance, attribute.
  const std::vector<AttributeRow>& rows() const { return rows_; }
  const std::vector<ServiceRow>& services() const { return services_; }
  const AttributeRow* find(std::uint16_t class_id, std::uint32_t instance, std::uint16_t attribute) const;
  // All attributes of an instance, in order.
  std::span<const AttributeRow> instance(std::uint16_t class_id, std::uint32_t instance) const;
  const ServiceRow* find_service(std::uint16_t class_id, std::uint32_t instance, std::uint8_t service) const;
  bool has_instance(std::uint16_t class_id, std::uint32_t instance) const;
  // In order, each once.
  std::vector<std::uint16_t> classes() const;

 private:
  // An instance with attributes: where its rows begin.
  struct InstanceRows {
    std::uint16_t class_id = 0;
    std::uint32_t instance = 0;
    std::size_t first = 0;
    std::uint64_t key() const { return std::uint64_t{class_id} << 32 | instance; }
  };
  std::vector<AttributeRow> rows_;
  std::vector<InstanceRows> instances_;  // in order, and one behind the last: requests ask for them much
  std::vector<ServiceRow> services_;
};

}  // namespace vinv::cip
