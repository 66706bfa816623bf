// A text of a few lines that YAML's aliases make a tree of more than a billion nodes.
#pragma once

#include <string>

namespace vinv::test {

inline std::string alias_bomb() {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i <= 9; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int k = 1; k < 9; ++k) text += ", " + below;
    text += "]\n";
  }
  return text;
}

}  // namespace vinv::test
