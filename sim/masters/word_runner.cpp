#include "sim/masters/word_runner.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "sim/base/check.hpp"

namespace vinv::masters {
namespace {

bool reads_or_writes_one(Word word) {
  return word == Word::kWriteParameter || word == Word::kReadParameter || word == Word::kMonitor;
}

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, value > 0xffff ? "%08XH" : "%04XH", value);
  return text;
}

std::int64_t sign_extended(std::uint32_t raw, unsigned size) {
  if (size == 1) return static_cast<std::int8_t>(raw);
  if (size == 2) return static_cast<std::int16_t>(raw);
  return static_cast<std::int32_t>(raw);
}

std::string parameter_name(const Order& order) {
  std::string name = "Pr." + std::to_string(order.parameter);
  if (order.sub != 0) name += "." + std::to_string(order.sub);
  return name;
}

}  // namespace

void WordRunner::begin(Instant now, const BoardProfile& profile, const Order& order) {
  state_.profile = &profile;
  state_.outcome.reset();
  state_.stale = std::exchange(state_.in_access, false) || state_.stale;
  state_.order = order;
  state_.step = 0;
  state_.begun = false;
  state_.wake_at.reset();
  remember(order);
  if (!reads_or_writes_one(order.word)) {
    find_step();
    if (state_.order && state_.step >= state_.profile->steps.size())
      return fail("board " + std::string(state_.profile->board) + " has no such word over " +
                  std::string(state_.profile->protocol));
  }
  advance(now);
}

// For profiles that give velocity with its sign.
void WordRunner::remember(const Order& order) {
  Memory& memory = state_.memory[order.node];
  switch (order.word) {
    case Word::kRunForward: memory.reverse = false; break;
    case Word::kRunReverse: memory.reverse = true; break;
    case Word::kReferenceRpm: memory.rpm = order.value; break;
    case Word::kReferenceHz: memory.rpm = order.value * 120 / state_.profile->poles; break;
    default: break;
  }
}

std::optional<Outcome> WordRunner::poll() { return std::exchange(state_.outcome, std::nullopt); }

void WordRunner::finish(Outcome outcome) {
  state_.order.reset();
  state_.wake_at.reset();
  state_.outcome = std::move(outcome);
}

void WordRunner::fail(const std::string& what) {
  finish(Unexpected(std::string(name_of(state_.order->word)) + ": " + what));
}

std::string WordRunner::with_meaning(const std::string& error) const {
  for (const CodeText& row : state_.profile->codes) {
    char code[24];
    std::snprintf(code, sizeof code, "exception %02X", row.code);
    if (error == code) return error + " (" + std::string(row.text) + ")";
  }
  return error;
}

// The first step of the order's word from state_.step on.
void WordRunner::find_step() {
  while (state_.step < state_.profile->steps.size() && state_.profile->steps[state_.step].word != state_.order->word)
    ++state_.step;
}

void WordRunner::next_step(std::size_t skip) {
  for (std::size_t i = 0; i <= skip; ++i) {
    ++state_.step;
    find_step();
  }
  state_.begun = false;
  state_.wake_at.reset();
  if (state_.step >= state_.profile->steps.size()) finish(Reading{});
}

Result<std::uint32_t, std::string> WordRunner::raw_of(const ProfileStep& step) const {
  const Order& order = *state_.order;
  double value = 0;
  switch (step.operand) {
    case Operand::kConstant: return step.constant;
    case Operand::kConstantPlusNode: return step.constant + order.node;
    case Operand::kHz:
    case Operand::kRpm: value = order.value; break;
    case Operand::kSignedRpm: {
      const Memory& memory = state_.memory.at(order.node);
      value = memory.reverse ? -memory.rpm : memory.rpm;
      break;
    }
  }
  const double raw = std::round(value / step.scale);
  const double low = step.operand == Operand::kSignedRpm ? -32768 : 0;
  const double high = step.operand == Operand::kSignedRpm ? 32767 : 65535;
  if (!(raw >= low && raw <= high)) return Unexpected(std::string("the value does not fit a word"));
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(raw)) & 0xffff;
}

void WordRunner::begin_step(Instant now, const ProfileStep& step) {
  const std::uint8_t node = state_.order->node;
  state_.begun = true;
  switch (step.act) {
    case Act::kWrite:
    case Act::kOutput: {
      const auto raw = raw_of(step);
      if (!raw) return fail(raw.error());
      if (step.act == Act::kOutput) {
        access_.set_output(node, step.item, step.size, *raw);
        return next_step();
      }
      state_.in_access = true;
      return access_.begin_write(now, node, step.item, step.size, *raw);
    }
    case Act::kAwait:
      state_.give_up_at = now + std::chrono::milliseconds(step.time_ms);
      state_.last_seen = "nothing";
      [[fallthrough]];
    case Act::kSkipIf: state_.in_access = true; return access_.begin_read(now, node, step.item, step.size);
    case Act::kCommand:
      state_.emergencies_before = access_.emergencies(node);
      access_.command(now, node, step.constant);
      return next_step();
    case Act::kSend:
      state_.emergencies_before = access_.emergencies(node);
      access_.send_output(now, node, step.item);
      return next_step();
    case Act::kListen: state_.wake_at = now + std::chrono::milliseconds(step.time_ms); return;
  }
}

void WordRunner::on_answer(Instant now, const ProfileStep& step, const Result<std::uint32_t, std::string>& answer) {
  const bool fits = answer && (*answer & step.mask) == step.constant;
  switch (step.act) {
    case Act::kWrite:
      if (!answer) return fail(access_.name_of(step.item) + ": " + with_meaning(answer.error()));
      return next_step();
    case Act::kSkipIf:
      if (!answer) return fail(access_.name_of(step.item) + ": " + with_meaning(answer.error()));
      return next_step(fits ? step.skip : 0);
    case Act::kAwait:
      if (fits) return next_step();
      state_.last_seen = answer ? hex(*answer) : with_meaning(answer.error());
      state_.wake_at = now + kAwaitInterval;
      if (*state_.wake_at > state_.give_up_at)
        return fail(access_.name_of(step.item) + " did not become " + hex(step.constant) + " in the bits " +
                    hex(step.mask) + " within " + std::to_string(step.time_ms) + " ms; the last answer was " +
                    state_.last_seen);
      return;
    default: VINV_CHECK(false);
  }
}

void WordRunner::begin_parameter(Instant now) {
  const Order& order = *state_.order;
  const ParameterRule* rule = state_.profile->parameter(order.parameter, order.sub);
  if (rule == nullptr)
    return fail(parameter_name(order) + " is not among the board's parameters over " +
                std::string(state_.profile->protocol));
  const Item item = rule->base + rule->n_step * (order.parameter - rule->first) + order.sub;
  state_.in_access = true;
  if (order.word == Word::kReadParameter) return access_.begin_read(now, order.node, item, 2);
  const double scaled = std::round(order.value / order.increment);
  const std::uint32_t special = order.value == 9999   ? state_.profile->raw_9999
                                : order.value == 8888 ? state_.profile->raw_8888
                                                      : 0;
  if (special == 0 && !(scaled >= 0 && scaled <= 65535)) {
    state_.in_access = false;
    return fail(parameter_name(order) + ": the value does not fit a word");
  }
  access_.begin_write(now, order.node, item, 2, special != 0 ? special : static_cast<std::uint32_t>(scaled));
}

void WordRunner::begin_monitor(Instant now) {
  const MonitorRow* row = state_.profile->monitor(state_.order->monitor);
  if (row == nullptr) {
    std::string known;
    for (const MonitorRow& m : state_.profile->monitors) known += (known.empty() ? "" : ", ") + std::string(m.name);
    return fail("there is no monitor \"" + state_.order->monitor + "\"; allowed: " + known);
  }
  state_.in_access = true;
  access_.begin_read(now, state_.order->node, row->item, row->size);
}

void WordRunner::on_value(const Result<std::uint32_t, std::string>& answer) {
  const Order& order = *state_.order;
  if (order.word == Word::kMonitor) {
    const MonitorRow& row = *state_.profile->monitor(order.monitor);
    if (!answer) return fail(access_.name_of(row.item) + ": " + with_meaning(answer.error()));
    const std::uint32_t raw = *answer & row.mask;
    const double number = row.is_signed ? static_cast<double>(sign_extended(raw, row.size)) : raw;
    return finish(Reading{number * row.scale, std::string(row.unit)});
  }
  if (!answer) return fail(parameter_name(order) + ": " + with_meaning(answer.error()));
  if (order.word == Word::kWriteParameter) return finish(Reading{});
  if (*answer == state_.profile->raw_9999) return finish(Reading{9999, {}});
  if (*answer == state_.profile->raw_8888) return finish(Reading{8888, {}});
  finish(Reading{*answer * order.increment, {}});
}

void WordRunner::advance(Instant now) {
  while (state_.order) {
    const Order order = *state_.order;
    const bool single = reads_or_writes_one(order.word);
    if (state_.stale) {
      if (!access_.poll_access()) return;
      state_.stale = false;
      continue;
    }
    if (!state_.begun) {
      if (!single) {
        begin_step(now, state_.profile->steps[state_.step]);
      } else {
        state_.begun = true;
        order.word == Word::kMonitor ? begin_monitor(now) : begin_parameter(now);
      }
      continue;
    }
    if (state_.in_access) {
      const auto answer = access_.poll_access();
      if (!answer) return;
      state_.in_access = false;
      single ? on_value(*answer) : on_answer(now, state_.profile->steps[state_.step], *answer);
      continue;
    }
    const ProfileStep& step = state_.profile->steps[state_.step];
    if (step.act == Act::kListen && access_.emergencies(order.node) > state_.emergencies_before) {
      const auto e = access_.emergency(order.node);
      if (e && step.item < e->size() && (*e)[step.item] == step.constant) {
        char text[48];
        std::snprintf(text, sizeof text, "refused by EMCY %02X%02XH, reason %02XH", (*e)[1], (*e)[0], (*e)[4]);
        return fail(text);
      }
    }
    if (!state_.wake_at || now < *state_.wake_at) return;
    state_.wake_at.reset();
    if (step.act == Act::kListen) {
      next_step();
    } else {  // kAwait
      state_.in_access = true;
      access_.begin_read(now, order.node, step.item, step.size);
    }
  }
}

void WordRunner::archive_state(Archive& a) {
  VINV_MEMBERS(state_, profile, order, step, begun, in_access, stale, wake_at, give_up_at, emergencies_before,
               last_seen, memory, outcome);
  std::string board(profile != nullptr ? profile->board : "");
  std::string protocol(profile != nullptr ? profile->protocol : "");
  VINV_FIELDS(a, WordRunner, board, protocol, order, step, begun, in_access, stale, wake_at, give_up_at,
              emergencies_before, last_seen, memory, outcome);
  if (!a.loads() || a.failed()) return;
  profile = find_profile(board, protocol);
  if (profile == nullptr && !board.empty())
    return a.fail("a master of the snapshot speaks to board " + board + " over " + protocol +
                  ", of which this program knows nothing");
  // What the order relies on.
  a.require(!(in_access && stale) && (order || (!in_access && !wake_at)), "a master has done two things at once");
  if (!order || a.failed()) return;
  a.require(profile != nullptr && step < profile->steps.size() && memory.contains(order->node) && order->node >= 1,
            "a master's order is none");
  if (a.failed()) return;
  const Act act = profile->steps[step].act;
  if (reads_or_writes_one(order->word)) {
    a.require(order->word != Word::kMonitor || !in_access || profile->monitor(order->monitor) != nullptr,
              "a master reads a monitor that there is not");
    a.require(!wake_at, "a master waits for nothing");
  } else {
    const bool asks = act == Act::kWrite || act == Act::kSkipIf || act == Act::kAwait;
    a.require(!in_access || asks, "a master has an answer to come that it did not ask for");
    a.require(!wake_at || act == Act::kAwait || act == Act::kListen, "a master waits for nothing");
  }
}

void WordRunner::require_client(Archive& a, unsigned last_node, bool has_images) const {
  if (!a.loads() || a.failed() || !state_.order) return;
  a.require(state_.order->node <= last_node, "a master's order is for a node that there cannot be");
  for (const ProfileStep& s : state_.profile->steps)
    a.require(has_images || s.act == Act::kWrite || s.act == Act::kAwait || s.act == Act::kSkipIf,
              "a master's order is for another protocol");
}

}  // namespace vinv::masters
