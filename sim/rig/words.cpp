#include "sim/rig/words.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace vinv::rig {
namespace {

std::string lower(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

// Optimal string alignment: insertions, deletions, replacements and swaps of neighbours cost 1.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string join(const std::vector<std::string_view>& words, std::size_t limit) {
  std::string out;
  for (std::size_t i = 0; i < words.size() && i < limit; ++i) {
    if (i > 0) out += ", ";
    out += words[i];
  }
  if (words.size() > limit) out += ", ... (" + std::to_string(words.size()) + " in all)";
  return out;
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& allowed) {
  constexpr std::size_t kLongest = 64;  // a longer word is not a misspelling
  if (word.empty() || word.size() > kLongest) return {};
  const std::string wanted = lower(word);
  // In half letters, so that a shortened word ("inertia" for "inertia_kg_m2") is nearer than one wrong letter. Of words
  // of one or two letters every other is near.
  const std::size_t forgiven = word.size() < 3 ? 1 : 2 * std::max<std::size_t>(1, word.size() / 3);
  std::string_view best;
  std::size_t best_distance = forgiven + 1;
  for (const std::string_view candidate : allowed) {
    const std::string known = lower(candidate);
    const std::size_t distance = known.starts_with(wanted) ? known != wanted : 2 * edit_distance(wanted, known);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& allowed) {
  const std::string_view near = nearest(word, allowed);
  return near.empty() || near == word ? std::string{} : " Did you mean \"" + std::string(near) + "\"?";
}

std::string allowed_words(std::string_view word, const std::vector<std::string_view>& allowed) {
  return "allowed: " + join(allowed) + "." + suggestion(word, allowed);
}

std::string sentence(std::string text) {
  if (!text.empty() && text.back() != '.' && text.back() != '?') text += '.';
  return text;
}

bool parse_switch(std::string_view word, bool& on) {
  const std::string w = lower(word);
  if (w == "on" || w == "true" || w == "yes") return on = true, true;
  if (w == "off" || w == "false" || w == "no") return on = false, true;
  return false;
}

bool parse_number(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '-') digits.remove_prefix(1);
  if (digits.empty() || (std::isdigit(static_cast<unsigned char>(digits.front())) == 0 && digits.front() != '.'))
    return false;
  if (digits.size() > 1 && digits[0] == '0' && std::isdigit(static_cast<unsigned char>(digits[1])) != 0) return false;
  double parsed = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), parsed);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(parsed)) return false;
  value = parsed;
  return true;
}

}  // namespace vinv::rig
