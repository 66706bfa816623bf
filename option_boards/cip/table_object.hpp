// The objects of an AttributeTable, served: checks in the order of CIP Vol 1 (instance, service, attribute, access,
// length, range), then what the row is bound to.
//
//   struct Host { ... };                                   // whose attributes they are
//   constexpr std::array<Binding<Host>, 2> kBindings{{
//       {"speed", [](const Host& h, const Attribute&) -> Got { return h.speed(); }},
//       {"limit", get_limit, nullptr, [](Host& h, const SetRequest& s) -> SetResult { ... }}}};
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "option_boards/cip/attribute_table.hpp"
#include "option_boards/cip/object.hpp"
#include "sim/base/result.hpp"

namespace vinv::cip {

using Got = Result<std::int64_t, GeneralStatus>;
using SetResult = Result<Handled, Status>;

struct SetRequest {
  Instant now;
  Attribute attribute;
  std::int64_t number = 0;  // within the row's range, where the attribute is one whole number
  ByteView bytes;           // of the right length for the type
  Ticket ticket = 0;
};

class TableObject : public Object {
 public:
  // The table outlives the object.
  explicit TableObject(const AttributeTable& table) : table_(table) {}

  Handled handle(Instant now, const Request& request, Reply& reply) final;
  // Appends the value, whatever the access says; for assemblies and other objects that read attributes.
  GeneralStatus append_value(const Attribute& attribute, Bytes& out) const;
  const AttributeTable& table() const { return table_; }

 private:
  // What the row is bound to; number bindings of 0 (constants) do not come here. Not called for ones that have none.
  virtual Got get_number(const Attribute& attribute) const = 0;
  virtual GeneralStatus get_bytes(const Attribute& attribute, Bytes& out) const = 0;
  virtual SetResult set(const SetRequest& request) = 0;
  // A service of the device's own.
  virtual Handled serve(Instant now, std::uint8_t own_service, const Request& request, Reply& reply) = 0;

  Handled set_single(Instant now, const Request& request, Reply& reply);
  void get_single(const Request& request, Reply& reply) const;
  void get_all(const Request& request, Reply& reply) const;

  const AttributeTable& table_;
};

// What gives and takes the value of an attribute. A whole number has get; anything else has append. Without set: the
// table has no row with this binding that may be set.
template <class Host>
struct Binding {
  std::string_view name;
  Got (*get)(const Host& host, const Attribute& attribute) = nullptr;
  GeneralStatus (*append)(const Host& host, const Attribute& attribute, Bytes& out) = nullptr;
  SetResult (*set)(Host& host, const SetRequest& request) = nullptr;
};
template <class Host>
struct OwnService {
  std::string_view name;
  Handled (*serve)(Host& host, Instant now, const Request& request, Reply& reply) = nullptr;
};

// "constant" and the bindings' names, or the services', as AttributeTable wants them.
template <class Host>
std::vector<std::string_view> names_of(std::span<const Binding<Host>> bindings) {
  std::vector<std::string_view> names{"constant"};
  for (const auto& binding : bindings) names.push_back(binding.name);
  return names;
}
template <class Host>
std::vector<std::string_view> names_of(std::span<const OwnService<Host>> services) {
  std::vector<std::string_view> names;
  for (const auto& service : services) names.push_back(service.name);
  return names;
}

// True if each row has what its type and access need.
template <class Host>
bool bindings_fit(const AttributeTable& table, std::span<const Binding<Host>> bindings) {
  for (const AttributeRow& row : table.rows()) {
    if (row.binding == 0) {
      if (row.settable) return false;
      continue;
    }
    const auto& binding = bindings[row.binding - 1u];
    if (row.gettable && (row.type.integer() ? binding.get == nullptr : binding.append == nullptr)) return false;
    if (row.settable && binding.set == nullptr) return false;
  }
  return true;
}

template <class Host>
class BoundObject final : public TableObject {
 public:
  // All outlive the object; the table was made with the names of these bindings and services.
  BoundObject(const AttributeTable& table, Host& host, std::span<const Binding<Host>> bindings,
              std::span<const OwnService<Host>> services)
      : TableObject(table), host_(host), bindings_(bindings), services_(services) {}

 private:
  Got get_number(const Attribute& a) const override { return bindings_[a.row.binding - 1u].get(host_, a); }
  GeneralStatus get_bytes(const Attribute& a, Bytes& out) const override {
    return bindings_[a.row.binding - 1u].append(host_, a, out);
  }
  SetResult set(const SetRequest& request) override {
    return bindings_[request.attribute.row.binding - 1u].set(host_, request);
  }
  Handled serve(Instant now, std::uint8_t own, const Request& request, Reply& reply) override {
    return services_[own].serve(host_, now, request, reply);
  }

  Host& host_;
  std::span<const Binding<Host>> bindings_;
  std::span<const OwnService<Host>> services_;
};

}  // namespace vinv::cip
