#include "option_boards/boards/ethernet_settings.hpp"

#include <array>

namespace vinv::boards {
namespace {

struct LineWord {
  std::string_view word;
  LineSetting setting;
};
constexpr std::array kLineWords{LineWord{"auto", {true, false, 10}}, LineWord{"10_half", {false, false, 10}},
                                LineWord{"10_full", {false, true, 10}}, LineWord{"100_half", {false, false, 100}},
                                LineWord{"100_full", {false, true, 100}}};

}  // namespace

std::string_view line_setting_word(const LineSetting& line) {
  for (const LineWord& w : kLineWords)
    if (w.setting == line || (line.automatic && w.setting.automatic)) return w.word;
  return kLineWords[0].word;
}

std::optional<LineSetting> parse_line_setting(std::string_view word) {
  for (const LineWord& w : kLineWords)
    if (w.word == word) return w.setting;
  return std::nullopt;
}

std::vector<std::string_view> line_setting_words() {
  std::vector<std::string_view> words;
  for (const LineWord& w : kLineWords) words.push_back(w.word);
  return words;
}

}  // namespace vinv::boards
