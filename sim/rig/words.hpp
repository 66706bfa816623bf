// Words for people: lists of what is allowed, and the nearest known word to a misspelt one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vinv::rig {

// "a, b, c". More than limit words end in ", ... (n in all)".
std::string join(const std::vector<std::string_view>& words, std::size_t limit = 24);

// The allowed word nearest to the given one: case, missing endings, and up to a third of the letters are forgiven.
// Empty if none is near.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& allowed);

// ` Did you mean "x"?`, or empty.
std::string suggestion(std::string_view word, const std::vector<std::string_view>& allowed);

// `allowed: a, b, c.` and the suggestion if there is one.
std::string allowed_words(std::string_view word, const std::vector<std::string_view>& allowed);

// The text with a full stop at its end.
std::string sentence(std::string text);

// on/off, true/false, yes/no in any of the usual spellings; empty otherwise.
bool parse_switch(std::string_view word, bool& on);

// A decimal number as a whole: no sign but minus or plus, no hexadecimal, no inf or nan, no leading zero.
bool parse_number(std::string_view word, double& value);

}  // namespace vinv::rig
