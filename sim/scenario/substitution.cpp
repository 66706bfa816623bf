#include "sim/scenario/substitution.hpp"

#include "sim/scenario/node_values.hpp"

namespace vinv::scenario {

Substitution::Substitution(const YAML::Node& node, const Variables& variables, rig::Problems& problems,
                           const std::vector<std::string_view>& skip) {
  visit(node, variables, problems, skip);
}

Substitution::~Substitution() {
  for (auto it = undo_.rbegin(); it != undo_.rend(); ++it) it->first = it->second;
}

void Substitution::visit(YAML::Node node, const Variables& variables, rig::Problems& problems, const Keys& skip) {
  if (node.IsScalar()) {
    if (node.Scalar().find('$') == std::string::npos) return;
    const std::string written = node.Scalar();
    const auto text = substitute(written, variables);
    if (!text) {
      problems.add(node, text.error());
      failed_ = true;
      return;
    }
    undo_.emplace_back(node, written);
    node = *text;
  } else if (node.IsMap()) {
    for (auto pair : node) {
      if (pair.first.IsScalar() && contains(skip, pair.first.Scalar()) && !pair.second.IsScalar()) continue;
      visit(pair.first, variables, problems, skip);
      visit(pair.second, variables, problems, skip);
    }
  } else if (node.IsSequence()) {
    for (auto item : node) visit(item, variables, problems, skip);
  }
}

}  // namespace vinv::scenario
