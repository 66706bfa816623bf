#include "sim/scenario/variables.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"

namespace vinv::scenario {
namespace {

using rig::Dimension;

constexpr std::array kDimensions{
    Dimension::kFrequency, Dimension::kTorque,   Dimension::kInertia,     Dimension::kVoltage, Dimension::kCurrent,
    Dimension::kTime,      Dimension::kFraction, Dimension::kTemperature, Dimension::kSpeed,   Dimension::kPower};

// Caught in substitute() only.
struct Mistake : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Value {
  double number = 0;                   // in the dimension's own unit
  std::optional<Dimension> dimension;  // empty: a plain number
};

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::optional<Value> parse_literal(std::string_view text) {
  Value v;
  if (rig::parse_number(text, v.number)) return v;
  for (const Dimension d : kDimensions)
    if (const auto q = rig::parse_quantity(text, d)) return Value{*q, d};
  return {};
}

std::string text_of(const Value& v) {
  if (!v.dimension) return fmt::format("{:.12g}", v.number);
  const std::string unit(rig::units_of(*v.dimension).front());
  const double one = rig::parse_quantity("1 " + unit, *v.dimension).value();
  return fmt::format("{:.12g} {}", v.number / one, unit);
}

class Expression {
 public:
  Expression(std::string_view text, const Variables& variables) : text_(text), variables_(variables) {}

  Value evaluate() {
    const Value v = sum();
    skip();
    if (at_ != text_.size()) fail("\"" + std::string(text_.substr(at_)) + "\" is too much");
    return v;
  }

 private:
  // A formula of a person; deeper nesting would only exhaust the stack.
  static constexpr int kMaxDepth = 32;

  [[noreturn]] void fail(const std::string& what) const {
    throw Mistake("${" + std::string(text_) + "}: " + what + ".");
  }
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  char peek() {
    skip();
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  Value sum() {
    Value v = product();
    for (char op = peek(); op == '+' || op == '-'; op = peek()) {
      ++at_;
      const Value w = product();
      if (v.dimension != w.dimension) fail(text_of(v) + " and " + text_of(w) + " are of different kinds");
      v.number += op == '+' ? w.number : -w.number;
    }
    return v;
  }

  Value product() {
    Value v = factor();
    for (char op = peek(); op == '*' || op == '/'; op = peek()) {
      ++at_;
      Value w = factor();
      if (op == '/') {
        if (w.number == 0) fail("division by zero");
        if (v.dimension == w.dimension)
          v = {v.number / w.number, {}};
        else if (scales(w))
          v.number /= w.number;
        else
          fail(text_of(v) + " cannot be divided by " + text_of(w));
      } else if (scales(w)) {
        v.number *= w.number;
      } else if (scales(v)) {
        v = {v.number * w.number, w.dimension};
      } else {
        fail(text_of(v) + " times " + text_of(w) + " is no quantity");
      }
    }
    return v;
  }

  static bool scales(const Value& v) { return !v.dimension || *v.dimension == Dimension::kFraction; }

  Value factor() {
    const char c = peek();
    if (c == '-') {
      ++at_;
      Value v = factor();
      v.number = -v.number;
      return v;
    }
    if (c == '(') {
      if (++depth_ > kMaxDepth) fail("too many parentheses");
      ++at_;
      const Value v = sum();
      if (peek() != ')') fail("a closing parenthesis is missing");
      ++at_;
      --depth_;
      return v;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') return literal();
    if (is_name(c)) return variable();
    fail(c == '\0' ? "a value is missing at its end" : std::string("\"") + c + "\" is not understood");
  }

  Value literal() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isdigit(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '.'))
      ++at_;
    const std::size_t number_end = at_;
    std::size_t unit = at_;
    while (unit < text_.size() && text_[unit] == ' ') ++unit;
    std::size_t end = unit;
    while (end < text_.size() && (is_name(text_[end]) || text_[end] == '%')) ++end;
    if (text_.substr(unit, end - unit) == "kg" && text_.substr(end, 3) == " m2") end += 3;
    if (end > unit) at_ = end;
    const std::string_view word = text_.substr(begin, (end > unit ? end : number_end) - begin);
    const auto v = parse_literal(word);
    if (!v) fail("\"" + std::string(word) + "\" is neither a number nor a quantity");
    return *v;
  }

  Value variable() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    const std::string name(text_.substr(begin, at_ - begin));
    const auto it = variables_.find(name);
    if (it == variables_.end()) {
      std::vector<std::string_view> known;
      for (const auto& [n, v] : variables_) known.push_back(n);
      throw Mistake("there is no variable \"" + name + "\"; " +
                    (known.empty() ? "\"variables:\" declares them." : rig::allowed_words(name, known)));
    }
    const auto v = parse_literal(it->second);
    if (!v) fail(name + " is \"" + it->second + "\", with which nothing can be computed");
    return *v;
  }

  std::string_view text_;
  const Variables& variables_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

const std::string& lookup(const std::string& name, const Variables& variables) {
  const auto it = variables.find(name);
  if (it != variables.end()) return it->second;
  std::vector<std::string_view> known;
  for (const auto& [n, v] : variables) known.push_back(n);
  throw Mistake("there is no variable \"" + name + "\"; " +
                (known.empty() ? "\"variables:\" declares them." : rig::allowed_words(name, known)));
}

}  // namespace

Result<std::string, std::string> substitute(std::string_view text, const Variables& variables) {
  std::string out;
  try {
    for (std::size_t at = 0; at < text.size();) {
      if (text[at] != '$') {
        out += text[at++];
        continue;
      }
      if (at + 1 < text.size() && text[at + 1] == '{') {
        const std::size_t end = text.find('}', at);
        if (end == std::string_view::npos) throw Mistake("\"${\" has no closing brace.");
        const std::string_view inside = text.substr(at + 2, end - at - 2);
        bool name_only = !inside.empty() && std::isdigit(static_cast<unsigned char>(inside.front())) == 0;
        for (const char c : inside) name_only = name_only && is_name(c);
        out += name_only ? lookup(std::string(inside), variables) : text_of(Expression(inside, variables).evaluate());
        at = end + 1;
        continue;
      }
      std::size_t end = at + 1;
      while (end < text.size() && is_name(text[end])) ++end;
      if (end == at + 1) throw Mistake("\"$\" begins a variable, as $name or ${name + 1 s}.");
      out += lookup(std::string(text.substr(at + 1, end - at - 1)), variables);
      at = end;
    }
  } catch (const Mistake& m) {
    return Unexpected(std::string(m.what()));
  }
  return out;
}

}  // namespace vinv::scenario
