#include "sim/masters/eip_message.hpp"

#include <cstdio>
#include <utility>

#include "option_boards/cip/epath.hpp"

namespace vinv::masters {
namespace {

struct StatusText {
  std::uint16_t code;
  std::string_view text;
};
// CIP Vol 1, appendix B-1.
constexpr StatusText kGeneral[] = {
    {0x01, "connection failure"},       {0x02, "resource unavailable"},   {0x04, "path segment error"},
    {0x05, "path destination unknown"}, {0x08, "service not supported"},  {0x09, "invalid attribute value"},
    {0x0c, "object state conflict"},    {0x0e, "attribute not settable"}, {0x0f, "privilege violation"},
    {0x10, "device state conflict"},    {0x11, "reply data too large"},   {0x13, "not enough data"},
    {0x14, "attribute not supported"},  {0x15, "too much data"},          {0x16, "object does not exist"},
    {0x19, "store operation failure"},  {0x1f, "vendor specific error"},  {0x20, "invalid parameter"},
    {0x26, "path size invalid"},        {0x2c, "attribute not gettable"},
};
// CIP Vol 1, table 3-5.33.
constexpr StatusText kExtended[] = {
    {0x0100, "connection in use or duplicate Forward_Open"},
    {0x0106, "ownership conflict"},
    {0x0107, "connection not found"},
    {0x0109, "invalid connection size"},
    {0x0111, "RPI not supported"},
    {0x0113, "out of connections"},
    {0x0114, "vendor or product code mismatch"},
    {0x0115, "device type mismatch"},
    {0x0116, "revision mismatch"},
    {0x0117, "invalid application path"},
    {0x0119, "no owner to listen to"},
    {0x0123, "invalid O->T type"},
    {0x0124, "invalid T->O type"},
    {0x0127, "invalid O->T size"},
    {0x0128, "invalid T->O size"},
    {0x0129, "invalid configuration path"},
    {0x012a, "invalid consuming path"},
    {0x012b, "invalid producing path"},
    {0x012f, "inconsistent paths"},
    {0x0315, "invalid segment in the path"},
};

template <std::size_t kRows>
std::string meaning(const StatusText (&rows)[kRows], unsigned code) {
  for (const StatusText& row : rows)
    if (row.code == code) return " (" + std::string(row.text) + ")";
  return {};
}

std::string hex(unsigned value, int digits) {
  char text[12];
  std::snprintf(text, sizeof text, "%0*X", digits, value);
  return text;
}

}  // namespace

Bytes object_path(std::uint16_t class_id, std::uint16_t instance, std::uint16_t attribute) {
  cip::ObjectPath path{class_id, instance, std::nullopt, std::nullopt};
  if (attribute != 0) path.attribute = attribute;
  Bytes out;
  cip::append_object_path(out, path, cip::PathForm::kPadded);
  return out;
}

std::string text_of(const CipFailure& failure) {
  switch (failure.kind) {
    case CipFailure::Kind::kTimeout: return "no answer";
    case CipFailure::Kind::kNotConnected: return "no connection";
    case CipFailure::Kind::kEncapsulation: return "encapsulation status " + hex(failure.encapsulation, 4);
    case CipFailure::Kind::kStatus: break;
  }
  std::string text = "general status " + hex(failure.general, 2);
  if (failure.extended.empty()) return text + meaning(kGeneral, failure.general);
  text += ", extended status";
  for (const std::uint16_t word : failure.extended) text += " " + hex(word, 4);
  return text + meaning(kExtended, failure.extended.front());
}

}  // namespace vinv::masters
