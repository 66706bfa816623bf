#include "sim/rig/flow_value.hpp"

namespace vinv::rig {

std::string flow_text(const YAML::Node& node) {
  constexpr std::size_t kLongest = 200;
  std::string out;
  switch (node.Type()) {
    case YAML::NodeType::Scalar: return node.Scalar();
    case YAML::NodeType::Map:
      for (const auto& pair : node) {
        if (out.size() > kLongest) break;
        out += (out.empty() ? "{" : ", ") + flow_text(pair.first) + ": " + flow_text(pair.second);
      }
      return out + "}";
    case YAML::NodeType::Sequence:
      for (const auto& item : node) {
        if (out.size() > kLongest) break;
        out += (out.empty() ? "[" : ", ") + flow_text(item);
      }
      return out + "]";
    default: return "";
  }
}

Json json_of(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar: return node.Scalar();
    case YAML::NodeType::Map: {
      Json out = Json::object();
      for (const auto& pair : node) out[flow_text(pair.first)] = json_of(pair.second);
      return out;
    }
    case YAML::NodeType::Sequence: {
      Json out = Json::array();
      for (const auto& item : node) out.push_back(json_of(item));
      return out;
    }
    default: return {};
  }
}

Json parse_flow(const std::string& text) {
  constexpr std::size_t kLongest = 4096;
  // References could unfold a short text into an endless value.
  if (text.size() > kLongest || text.find_first_of("&*") != std::string::npos)
    invalid("a value in braces has at most 4096 characters, and neither & nor *.");
  try {
    return json_of(YAML::Load(text));
  } catch (const YAML::Exception&) {
    invalid("\"" + text + "\" does not end as it begins; write it as {torque: 12 Nm, over: 2 s}.");
  }
}

}  // namespace vinv::rig
