#include "sim/scenario/action_reader.hpp"

#include <cctype>
#include <optional>

#include "sim/scenario/node_values.hpp"

namespace vinv::scenario {
namespace {

struct Culprit {
  rig::Position at;
  std::string key;  // of the outermost mapping, below which it is
};

// The place that a message of the command set is about: the scalar that it quotes, or the key that it names.
std::optional<Culprit> find_culprit(const YAML::Node& node, const std::string& message, bool quoted) {
  const auto named = [&](const std::string& word) {
    if (word.empty()) return false;
    if (quoted) return message.find("\"" + word + "\"") != std::string::npos;
    const std::size_t at = message.find(word);
    const auto letter = [&](std::size_t i) {
      return i < message.size() && (std::isalnum(static_cast<unsigned char>(message[i])) != 0 || message[i] == '_');
    };
    return at != std::string::npos && !letter(at + word.size()) && (at == 0 || !letter(at - 1));
  };
  if (node.IsScalar()) return named(node.Scalar()) ? std::optional(Culprit{rig::position_of(node), {}}) : std::nullopt;
  if (node.IsSequence()) {
    for (const auto& item : node)
      if (auto found = find_culprit(item, message, quoted)) return found;
    return {};
  }
  if (!node.IsMap()) return {};
  // Otherwise a word that is not quoted names whose value is wrong.
  const bool about_key = quoted || message.starts_with("there is no");
  for (const auto& pair : node) {
    auto found = find_culprit(pair.second, message, quoted);
    if (!found && pair.first.IsScalar() && named(pair.first.Scalar()))
      found = Culprit{rig::position_of(about_key || !pair.second.IsScalar() ? pair.first : pair.second), {}};
    if (!found) continue;
    found->key = flow_text(pair.first);
    return found;
  }
  return {};
}

}  // namespace

void try_by_hand(Trial& trial, std::size_t drive, const Action& action, rig::Position word, const YAML::Node& value,
                 rig::Problems& problems) {
  rig::Json tried = action.value;
  for (bool first = true;; first = false) {
    const auto message = trial.objection(drive, action.command, tried);
    if (!message) break;
    auto culprit = find_culprit(value, *message, true);
    if (!culprit && first) culprit = find_culprit(value, *message, false);
    if (!culprit && !first) break;
    problems.add(culprit ? culprit->at : value.IsNull() ? word : rig::position_of(value), *message);
    // The other entries may have mistakes of their own.
    if (!culprit || culprit->key.empty() || !tried.is_object() || tried.size() < 2) break;
    if (tried.erase(culprit->key) == 0) break;
  }
}

}  // namespace vinv::scenario
