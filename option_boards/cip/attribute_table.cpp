#include "option_boards/cip/attribute_table.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <tuple>

#include "sim/base/check.hpp"
#include "sim/base/table_text.hpp"

namespace vinv::cip {
namespace {

constexpr std::array<std::string_view, kFirstOwnService> kTableServices{"get_single", "set_single", "get_all"};

std::uint8_t position(std::string_view name, std::span<const std::string_view> names) {
  const auto found = std::find(names.begin(), names.end(), name);
  VINV_CHECK(found != names.end());
  return static_cast<std::uint8_t>(found - names.begin());
}

AttributeRow parse_attribute(std::string_view line, std::span<const std::string_view> bindings) {
  const auto field = [&] { return take_until(line, ','); };
  AttributeRow row;
  row.class_id = number_of_field<std::uint16_t>(field(), 0);
  row.instance = number_of_field<std::uint32_t>(field(), 0);
  row.first = number_of_field<std::uint16_t>(field(), 0);
  row.last = number_of_field<std::uint16_t>(field(), row.first);
  row.name = field();
  row.type = TypeSpec(field());
  VINV_CHECK(row.class_id != 0 && row.first <= row.last);
  const std::string_view access = field();
  row.gettable = access == "Get" || access == "Get/Set";
  row.settable = access == "Set" || access == "Get/Set";
  VINV_CHECK(row.gettable || row.settable);
  IntegerRange range;
  if (const auto type = row.type.integer()) range = range_of(*type);
  row.min = number_of_field(field(), range.min);
  row.max = number_of_field(field(), range.max);
  row.constant = field();
  row.binding = position(field(), bindings);
  row.argument = number_of_field<std::int32_t>(field(), 0);
  row.detail = number_of_field<std::int32_t>(field(), 0);
  if (row.binding == 0) row.type.append_constant(row.value, row.constant);
  return row;
}

ServiceRow parse_service(std::string_view line, std::span<const std::string_view> own) {
  const auto field = [&] { return take_until(line, ','); };
  ServiceRow row;
  row.first_class = number_of_field<std::uint16_t>(field(), 0);
  row.last_class = number_of_field<std::uint16_t>(field(), row.first_class);
  row.first_instance = number_of_field<std::uint32_t>(field(), 0);
  row.last_instance = number_of_field<std::uint32_t>(field(), row.first_instance);
  row.code = number_of_field<std::uint8_t>(field(), 0);
  row.name = field();
  const std::string_view binding = field();
  const auto served = std::find(kTableServices.begin(), kTableServices.end(), binding);
  row.binding = served != kTableServices.end() ? static_cast<std::uint8_t>(served - kTableServices.begin())
                                               : static_cast<std::uint8_t>(kFirstOwnService + position(binding, own));
  VINV_CHECK(row.first_class != 0 && row.first_class <= row.last_class && row.first_instance <= row.last_instance &&
             row.code != 0);
  return row;
}

auto key_of(const AttributeRow& row) { return std::tuple(row.class_id, row.instance, row.first); }
auto instance_of(const AttributeRow& row) { return std::tuple(row.class_id, row.instance); }

}  // namespace

AttributeTable::AttributeTable(std::string_view attributes_csv, std::span<const std::string_view> attribute_bindings,
                               std::string_view services_csv, std::span<const std::string_view> own_services) {
  VINV_CHECK(!attribute_bindings.empty() && attribute_bindings[0] == "constant");
  take_until(attributes_csv, '\n');
  while (!attributes_csv.empty()) {
    rows_.push_back(parse_attribute(take_until(attributes_csv, '\n'), attribute_bindings));
  }
  std::sort(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return key_of(a) < key_of(b); });
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    VINV_CHECK(instance_of(rows_[i - 1]) != instance_of(rows_[i]) || rows_[i - 1].last < rows_[i].first);
  }
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (i == 0 || instance_of(rows_[i - 1]) != instance_of(rows_[i]))
      instances_.push_back({rows_[i].class_id, rows_[i].instance, i});
  instances_.push_back({0, 0, rows_.size()});
  take_until(services_csv, '\n');
  while (!services_csv.empty()) services_.push_back(parse_service(take_until(services_csv, '\n'), own_services));
}

std::span<const AttributeRow> AttributeTable::instance(std::uint16_t class_id, std::uint32_t instance) const {
  const std::uint64_t wanted = InstanceRows{class_id, instance}.key();
  const auto end = instances_.end() - 1;
  const auto found = std::lower_bound(instances_.begin(), end, wanted,
                                      [](const InstanceRows& rows, std::uint64_t key) { return rows.key() < key; });
  if (found == end || found->key() != wanted) return {};
  return std::span(rows_).subspan(found->first, std::next(found)->first - found->first);
}

const AttributeRow* AttributeTable::find(std::uint16_t class_id, std::uint32_t instance_id,
                                         std::uint16_t attribute) const {
  const auto rows = instance(class_id, instance_id);
  const auto found = std::lower_bound(rows.begin(), rows.end(), attribute,
                                      [](const AttributeRow& row, auto number) { return row.last < number; });
  return found != rows.end() && found->first <= attribute ? &*found : nullptr;
}

const ServiceRow* AttributeTable::find_service(std::uint16_t class_id, std::uint32_t instance_id,
                                               std::uint8_t service) const {
  const auto found = std::find_if(services_.begin(), services_.end(), [&](const ServiceRow& row) {
    return row.code == service && row.first_class <= class_id && class_id <= row.last_class &&
           row.first_instance <= instance_id && instance_id <= row.last_instance;
  });
  return found == services_.end() ? nullptr : &*found;
}

bool AttributeTable::has_instance(std::uint16_t class_id, std::uint32_t instance_id) const {
  if (!instance(class_id, instance_id).empty()) return true;
  return std::any_of(services_.begin(), services_.end(), [&](const ServiceRow& row) {
    return row.first_class <= class_id && class_id <= row.last_class && row.first_instance <= instance_id &&
           instance_id <= row.last_instance;
  });
}

std::vector<std::uint16_t> AttributeTable::classes() const {
  std::set<std::uint16_t> all;
  for (const AttributeRow& row : rows_) all.insert(row.class_id);
  for (const ServiceRow& row : services_) {
    for (unsigned id = row.first_class; id <= row.last_class; ++id) all.insert(static_cast<std::uint16_t>(id));
  }
  return {all.begin(), all.end()};
}

}  // namespace vinv::cip
