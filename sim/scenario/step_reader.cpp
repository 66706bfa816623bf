#include "sim/scenario/step_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>

#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/scenario/units.hpp"

namespace vinv::scenario {
namespace {

using Keys = std::vector<std::string_view>;
using rig::Json;

const Keys& pace_words() {
  static const Keys words{"at", "after", "when", "within", "drive", "via", "refused", "during"};
  return words;
}
const Keys& own_words() {
  static const Keys words{"check",  "reached", "ramp",    "trip",   "always", "never",      "overshoot",
                          "rising", "falling", "follows", "repeat", "note",   "send_frame", "expect_frame"};
  return words;
}
bool contains(const Keys& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// As a person would write it on one line.
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

// All scalars as texts: that is how the command set reads quantities, numbers and switches.
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

std::optional<Bytes> parse_hex(const YAML::Node& node, const std::string& what, rig::Problems& problems) {
  constexpr std::size_t kMaxFrameBytes = 1024;
  Bytes out;
  std::string digits;
  bool fine = node.IsScalar();
  for (const char c : fine ? node.Scalar() : std::string{}) {
    if (c == ' ') continue;
    fine = fine && std::isxdigit(static_cast<unsigned char>(c)) != 0;
    digits += c;
  }
  if (!fine || digits.empty() || digits.size() % 2 != 0 || digits.size() / 2 > kMaxFrameBytes) {
    problems.add(node, what + " is " + rig::kind_of(node) + "; allowed: bytes in hexadecimal, as 05 06 5D C2 0F A0.");
    return {};
  }
  for (std::size_t i = 0; i < digits.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  return out;
}

}  // namespace

// --- variables ---

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

std::optional<Duration> read_duration(const YAML::Node& node, const std::string& what, Duration minimum,
                                      rig::Problems& problems) {
  constexpr double kLongest_s = 1e6;
  if (!node.IsScalar()) {
    problems.add(node, what + " is " + rig::kind_of(node) + "; allowed: a time, as 2 s or 500 ms.");
    return {};
  }
  const auto parsed = rig::parse_quantity(node.Scalar(), rig::Dimension::kTime);
  if (!parsed) {
    problems.add(node, what + ": " + parsed.error());
    return {};
  }
  if (*parsed < to_seconds(minimum) || *parsed > kLongest_s) {
    problems.add(node, what + " is \"" + node.Scalar() + "\"; allowed: " + show_duration(minimum) + " to 1000000 s.");
    return {};
  }
  return seconds_to_duration(*parsed);
}

// --- steps ---

struct StepReader::StepMap {
  struct Entry {
    std::string key;
    YAML::Node key_node;
    YAML::Node value;
  };
  std::vector<Entry> entries;
  const Entry* find(std::string_view key) const {
    for (const Entry& e : entries)
      if (e.key == key) return &e;
    return nullptr;
  }
};

Track StepReader::track(const std::string& name, const YAML::Node& list, const Variables& variables) {
  Track out;
  out.name = name;
  steps(list, name.empty() ? "steps" : "track " + name, variables, 0, out.steps);
  return out;
}

void StepReader::steps(const YAML::Node& list, const std::string& where, const Variables& variables, int depth,
                       std::vector<Step>& out) {
  if (!list.IsSequence() || list.size() == 0) {
    problems_.add(list, where + " is " + (list.IsSequence() ? "an empty list" : rig::kind_of(list)) +
                            "; allowed: a list of steps (- run: forward).");
    return;
  }
  if (depth > kMaxNesting) {
    problems_.add(list, "steps are nested deeper than " + std::to_string(kMaxNesting) + " levels.");
    return;
  }
  for (const auto& node : list) step(node, variables, depth, out);
}

void StepReader::step(const YAML::Node& node, const Variables& variables, int depth, std::vector<Step>& out) {
  if (++count_ > kMaxSteps) {
    if (!too_many_) problems_.add(node, "there are more than " + std::to_string(kMaxSteps) + " steps.");
    too_many_ = true;
    return;
  }
  const Substitution substitution(node, variables, problems_, {"steps", "during", "each"});
  if (substitution.failed()) return;
  Keys allowed = action_words();
  allowed.insert(allowed.end(), own_words().begin(), own_words().end());
  Keys all = allowed;
  all.insert(all.end(), pace_words().begin(), pace_words().end());

  StepMap map;
  if (node.IsScalar()) {
    map.entries.push_back({node.Scalar(), node, YAML::Node()});
  } else if (node.IsMap() && node.size() > 0) {
    for (const auto& pair : node) map.entries.push_back({flow_text(pair.first), pair.first, pair.second});
  } else {
    problems_.add(node, "a step is " + (node.IsMap() ? "an empty mapping" : rig::kind_of(node)) +
                            "; allowed: a word (stop) or a mapping (run: forward).");
    return;
  }
  const StepMap::Entry* verb = nullptr;
  bool usable = true;
  for (std::size_t i = 0; i < map.entries.size(); ++i) {
    const auto& e = map.entries[i];
    if (!contains(all, e.key)) {
      problems_.add(e.key_node, "unknown word \"" + e.key + "\" in a step." + rig::suggestion(e.key, all) +
                                    " Allowed: " + rig::join(all, all.size()) + ".");
      usable = false;
      continue;
    }
    if (std::any_of(map.entries.begin(), map.entries.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const auto& o) { return o.key == e.key; })) {
      problems_.add(e.key_node, "\"" + e.key + "\" stands twice in this step.");
      usable = false;
      continue;
    }
    if (contains(pace_words(), e.key)) continue;
    if (verb != nullptr) {
      problems_.add(e.key_node, "a step does one thing, and this one already has \"" + verb->key + "\"; write \"" +
                                    e.key + "\" as a step of its own.");
      usable = false;
      continue;
    }
    verb = &e;
  }
  Step s;
  s.at = rig::position_of(node);
  if (const auto* drive = map.find("drive")) {
    const auto names = trial_.drive_names();
    const std::string name = flow_text(drive->value);
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) {
      problems_.add(drive->value, "there is no drive \"" + name + "\"; " + rig::allowed_words(name, names));
      return;
    }
    s.drive = static_cast<std::size_t>(it - names.begin());
  } else if (trial_.drive_names().size() > 1 && verb != nullptr && verb->key != "repeat" && verb->key != "note") {
    problems_.add(node, "the plant has several drives; say which: \"drive: " + std::string(trial_.drive_names()[0]) +
                            "\" ... Allowed: " + rig::join(trial_.drive_names()) + ".");
    return;
  }
  const ExpectationReader reader(trial_, s.drive, problems_);
  usable = pace(map, s, reader) && usable;
  const bool has_body = verb != nullptr && (verb->key == "repeat" || map.find("during") != nullptr);
  if (!usable && !has_body) return;
  if (verb == nullptr) {
    s.what = Wait{};
    s.text = "wait";
    if (!s.pace.at && !s.pace.after && s.pace.when.empty()) {
      problems_.add(node, "this step does nothing and waits for nothing.");
      return;
    }
    if (map.find("when") != nullptr) s.text = "when: " + flow_text(map.find("when")->value);
    out.push_back(std::move(s));
    return;
  }
  const YAML::Node& value = verb->value;
  const std::string shown = flow_text(value);
  s.text = shown.empty() ? verb->key : verb->key + ": " + shown;
  if (verb->key == "repeat") return repeat(value, std::move(s), variables, depth, out);
  if (contains({"always", "never", "overshoot", "rising", "falling", "follows"}, verb->key))
    return watch(map, value, std::move(s), variables, depth, out);
  if (const auto* during = map.find("during")) {
    problems_.add(
        during->key_node,
        "\"during\" belongs to always, never, overshoot, rising, falling and follows, not to " + verb->key + ".");
    return;
  }
  if (contains(action_words(), verb->key)) {
    action(map, value, s);
    out.push_back(std::move(s));
    return;
  }
  std::optional<Step::What> what;
  if (verb->key == "check") {
    what = check(map, value, reader);
  } else if (verb->key == "reached") {
    what = reached(value, reader);
  } else if (verb->key == "ramp") {
    what = ramp(value, reader);
  } else if (verb->key == "trip") {
    what = trip(value, reader, s.drive);
  } else if (verb->key == "note") {
    if (const auto text = rig::read_text(value, "note", problems_)) what = Note{*text};
  } else {
    what = frame(verb->key, value, s);
  }
  if (!what) return;
  s.what = std::move(*what);
  out.push_back(std::move(s));
}

bool StepReader::pace(const StepMap& map, Step& s, const ExpectationReader& reader) {
  bool fine = true;
  const auto time = [&](const char* key) -> std::optional<Duration> {
    const auto* e = map.find(key);
    if (e == nullptr) return {};
    const auto d = read_duration(e->value, key, Duration{}, problems_);
    fine = fine && d.has_value();
    return d;
  };
  s.pace.at = time("at");
  s.pace.after = time("after");
  s.pace.within = time("within");
  if (map.find("at") != nullptr && map.find("after") != nullptr) {
    problems_.add(map.find("after")->key_node, "a step has either \"at\" or \"after\", not both.");
    fine = false;
  }
  if (const auto* when = map.find("when")) {
    s.pace.when = reader.condition(when->value, "when");
    fine = fine && !s.pace.when.empty();
  } else if (const auto* within = map.find("within")) {
    problems_.add(within->key_node, "\"within\" is the limit of \"when\", which this step has not.");
    fine = false;
  }
  if (const auto* via = map.find("via")) {
    Keys known;
    for (const MasterKind& m : options_.masters) known.push_back(m.name);
    s.via = flow_text(via->value);
    if (!contains(known, s.via)) {
      problems_.add(via->value, "there is no master \"" + s.via + "\"; " +
                                    (known.empty() ? "none is known." : rig::allowed_words(s.via, known)));
      fine = false;
    }
  }
  return fine;
}

void StepReader::action(const StepMap& map, const YAML::Node& value, Step& s) {
  const auto& verb = *std::find_if(map.entries.begin(), map.entries.end(),
                                   [](const auto& e) { return contains(action_words(), e.key); });
  Action a;
  a.command = verb.key;
  a.value = json_of(value);
  if (const auto* refused = map.find("refused"))
    a.refused = rig::read_switch(refused->value, "refused", problems_).value_or(false);
  if (!s.via.empty()) {
    const auto master = std::find_if(options_.masters.begin(), options_.masters.end(),
                                     [&](const MasterKind& m) { return m.name == s.via; });
    if (master != options_.masters.end() && !contains(master->words, a.command))
      problems_.add(verb.key_node, "the master " + s.via + " cannot say \"" + a.command + "\"; " +
                                       rig::allowed_words(a.command, master->words));
  } else if (!a.refused) {
    Json tried = a.value;
    for (bool first = true;; first = false) {
      const auto message = trial_.objection(s.drive, a.command, tried);
      if (!message) break;
      auto culprit = find_culprit(value, *message, true);
      if (!culprit && first) culprit = find_culprit(value, *message, false);
      if (!culprit && !first) break;
      problems_.add(culprit ? culprit->at : rig::position_of(value.IsNull() ? verb.key_node : value), *message);
      // The other entries may have mistakes of their own.
      if (!culprit || culprit->key.empty() || !tried.is_object() || tried.size() < 2) break;
      if (tried.erase(culprit->key) == 0) break;
    }
  }
  s.what = std::move(a);
}

void StepReader::repeat(const YAML::Node& value, Step s, const Variables& variables, int depth,
                        std::vector<Step>& out) {
  constexpr long kMaxTimes = 1'000'000;
  const rig::YamlMap map(value, "repeat", &scenario_keys().at("steps[].repeat"), problems_);
  if (!map) return;
  const YAML::Node* body = map.find("steps");
  if (body == nullptr) {
    if (!map.has("steps")) problems_.add(map.at(), "repeat lacks \"steps\".");
    return;
  }
  if (map.has("times") == map.has("each")) {
    problems_.add(map.at(), "repeat has either \"times: 3\" or \"each: {f: [10 Hz, 20 Hz]}\".");
    return;
  }
  if (const auto times = map.integer("times", 1, kMaxTimes)) {
    s.what = RepeatBegin{static_cast<unsigned>(*times)};
    s.text = "repeat " + std::to_string(*times) + " times";
    const std::size_t begin = out.size();
    out.push_back(s);
    steps(*body, "steps of repeat", variables, depth + 1, out);
    s.what = RepeatEnd{begin};
    s.pace = {};
    s.text = "end of repeat";
    out.push_back(std::move(s));
    return;
  }
  const YAML::Node* each = map.find("each");
  if (each == nullptr) return;
  const rig::YamlMap lists(*each, "each", nullptr, problems_);
  std::size_t length = 0;
  for (const auto& list : lists.entries()) {
    if (list.empty) return;
    const bool usable = list.value.IsSequence() && list.value.size() > 0;
    if (!usable || (length != 0 && list.value.size() != length)) {
      problems_.add(list.value, "each: " + list.key + " is " +
                                    (usable ? "a list of " + std::to_string(list.value.size()) +
                                                  " values, the one before of " + std::to_string(length)
                                            : rig::kind_of(list.value)) +
                                    "; allowed: lists of the same length, as {f: [10 Hz, 20 Hz]}.");
      return;
    }
    length = list.value.size();
  }
  // The pace is that of the whole: it comes before the first round.
  if (s.pace.at || s.pace.after || !s.pace.when.empty()) {
    s.what = Wait{};
    s.text = "wait";
    out.push_back(std::move(s));
  }
  for (std::size_t i = 0; i < length; ++i) {
    Variables inner = variables;
    for (const auto& list : lists.entries()) {
      const auto text = substitute(flow_text(list.value[i]), variables);
      if (!text) {
        problems_.add(list.value[i], text.error());
        return;
      }
      inner[list.key] = *text;
    }
    steps(*body, "steps of repeat", inner, depth + 1, out);
  }
}

void StepReader::watch(const StepMap& map, const YAML::Node& value, Step s, const Variables& variables, int depth,
                       std::vector<Step>& out) {
  const auto& verb =
      *std::find_if(map.entries.begin(), map.entries.end(), [](const auto& e) { return contains(own_words(), e.key); });
  const ExpectationReader reader(trial_, s.drive, problems_);
  Watch w;
  w.number = watches_++;
  bool fine = true;
  if (verb.key == "always" || verb.key == "never") {
    w.kind = verb.key == "always" ? Watch::Kind::kAlways : Watch::Kind::kNever;
    w.all = reader.condition(value, verb.key);
    fine = !w.all.empty();
  } else if (verb.key == "follows") {
    w.kind = Watch::Kind::kFollows;
    fine = follows(value, reader, w);
  } else {
    const bool overshoot = verb.key == "overshoot";
    w.kind = overshoot ? Watch::Kind::kOvershoot : verb.key == "rising" ? Watch::Kind::kRising : Watch::Kind::kFalling;
    // {output_frequency: 50 Hz, at_most: 1 Hz}; `rising: output_frequency` needs no mapping.
    const std::string limit = overshoot ? "at_most" : "tolerance";
    if (!overshoot && value.IsScalar()) {
      const auto what = reader.signal(value.Scalar(), rig::position_of(value));
      if (what) w.what = *what;
      fine = what.has_value();
    } else {
      const rig::YamlMap m(value, verb.key, nullptr, problems_);
      const YAML::Node* distance = m ? m.find(limit) : nullptr;
      const rig::YamlMap::Entry* signal = nullptr;
      for (const auto& e : m.entries())
        if (e.key != limit) {
          if (signal != nullptr)
            problems_.add(e.at, verb.key + " watches one signal; \"" + e.key + "\" is the second.");
          if (signal == nullptr) signal = &e;
        }
      if (!m || signal == nullptr || (overshoot && distance == nullptr)) {
        if (m && (signal == nullptr || !m.has(limit)))
          problems_.add(m.at(),
                        overshoot ? "overshoot takes a signal with its target and at_most, as {speed: 1450 rpm, "
                                    "at_most: 20 rpm}."
                                  : verb.key + " takes a signal, as output_frequency, or {output_frequency: 0.1 Hz}.");
        fine = false;
      } else if (const auto what = reader.signal(signal->key, signal->at); !what) {
        fine = false;
      } else {
        w.what = *what;
        const auto first = reader.value(signal->value, *what);
        fine = first.has_value();
        if (overshoot) {
          w.target = first.value_or(0);
          const auto more = reader.distance(*distance, *what, w.target);
          fine = fine && more.has_value();
          w.tolerance = more.value_or(0);
        } else {
          w.tolerance = first.value_or(0);
        }
      }
    }
  }
  const auto* during = map.find("during");
  std::vector<Step> body;
  Step wait = s;
  if (during != nullptr && during->value.IsSequence()) {
    steps(during->value, "during", variables, depth + 1, body);
  } else if (during != nullptr) {
    const auto span = read_duration(during->value, "during", std::chrono::milliseconds(1), problems_);
    fine = fine && span.has_value();
    wait.pace = {};
    wait.pace.after = span;
    wait.what = Wait{};
    wait.text = "wait";
    body.push_back(wait);
  }
  if (!fine) return;
  s.what = w;
  out.push_back(s);
  if (during == nullptr) return;
  const std::size_t moved = out.size();
  out.insert(out.end(), std::make_move_iterator(body.begin()), std::make_move_iterator(body.end()));
  // Loops inside the body count from its own beginning.
  for (std::size_t i = moved; i < out.size(); ++i)
    if (auto* end = std::get_if<RepeatEnd>(&out[i].what)) end->begin += moved;
  s.what = WatchEnd{w.number};
  s.pace = {};
  out.push_back(std::move(s));
}

// {file: fan.csv, speed: 2 rpm, torque: 0.1 Nm}: the distances that are allowed.
bool StepReader::follows(const YAML::Node& value, const ExpectationReader& reader, Watch& w) {
  const rig::YamlMap m(value, "follows", nullptr, problems_);
  if (!m) return false;
  bool fine = true;
  if (const YAML::Node* begin = m.find("begin")) {
    const auto d = read_duration(*begin, "begin in follows", Duration{}, problems_);
    fine = d.has_value();
    w.trace_begin = d.value_or(Duration{});
  }
  const auto file = m.text("file");
  if (!file) {
    if (!m.has("file")) problems_.add(m.at(), "\"file\" is missing in follows; write the name of a CSV table.");
    return false;
  }
  const std::string path = (std::filesystem::path(folder_) / *file).lexically_normal().string();
  auto trace = load_trace(path);
  if (!trace) {
    problems_.add(*m.find("file"), path + " " + trace.error());
    return false;
  }
  w.trace = std::make_shared<const Trace>(std::move(*trace));
  for (const auto& e : m.entries()) {
    if (e.empty || e.key == "file" || e.key == "begin") continue;
    Watch::Followed f;
    const auto what = reader.signal(e.key, e.at);
    // A report names the drive too.
    const Trace::Column* column = w.trace->find(e.key);
    if (column == nullptr) column = w.trace->find(reader.drive_name() + "." + e.key);
    if (what && column == nullptr) problems_.add(e.at, path + " has no column \"" + e.key + " " + what->unit + "\".");
    if (!what || column == nullptr) {
      fine = false;
      continue;
    }
    f.what = *what;
    f.column = static_cast<std::size_t>(column - w.trace->columns.data());
    if (column->unit != what->unit) {
      problems_.add(e.at, "column " + e.key + " of " + path + " is in \"" + column->unit + "\"; the signal is in \"" +
                              what->unit + "\".");
      fine = false;
    }
    const auto distance = reader.distance(e.value, *what, 0);
    fine = fine && distance.has_value();
    f.tolerance = distance.value_or(0);
    w.followed.push_back(std::move(f));
  }
  if (fine && w.followed.empty()) {
    problems_.add(m.at(), "follows takes signals with how far they may be off, as {file: fan.csv, speed: 2 rpm}.");
    return false;
  }
  return fine;
}

// --- checks ---

std::optional<Step::What> StepReader::check(const StepMap&, const YAML::Node& value, const ExpectationReader& reader) {
  Condition all = value.IsMap() ? reader.mapping(value, "check", {}) : reader.condition(value, "check");
  if (all.empty()) return {};
  return Check{std::move(all)};
}

std::optional<Step::What> StepReader::reached(const YAML::Node& value, const ExpectationReader& reader) {
  const rig::YamlMap map(value, "reached", nullptr, problems_);
  if (!map) return {};
  Reached r;
  const YAML::Node* within = map.find("within");
  const YAML::Node* tolerance = map.find("tolerance");
  if (within == nullptr) {
    if (!map.has("within")) problems_.add(map.at(), "reached lacks \"within\", the time that it may take.");
    return {};
  }
  const auto limit = read_duration(*within, "within", std::chrono::milliseconds(1), problems_);
  if (const YAML::Node* node = map.find("not_before")) {
    r.not_before = read_duration(*node, "not_before", Duration{}, problems_);
    if (!r.not_before) return {};
  }
  bool any = false;
  for (const auto& e : map.entries()) {
    if (e.key == "within" || e.key == "tolerance" || e.key == "not_before") continue;
    if (any) {
      problems_.add(e.at, "reached waits for one thing; \"" + e.key + "\" is the second.");
      return {};
    }
    any = true;
    if (e.empty) return {};
    if (e.key == "terminals" || e.key == "parameters") {
      const Condition all = reader.mapping(value, "reached", {"within", "not_before"});
      if (all.size() > 1)
        problems_.add(e.at, "reached waits for one thing; there are " + std::to_string(all.size()) + ".");
      if (all.size() != 1) return {};
      r.target = all.front();
      continue;
    }
    const auto what = reader.observable(e.key, e.at);
    if (!what) return {};
    // A plain value without tolerance: passing through it is enough.
    const std::string& text = e.value.IsScalar() ? e.value.Scalar() : std::string{};
    if (what->kind == Observable::Kind::kSignal && tolerance == nullptr && !text.empty() &&
        (std::isdigit(static_cast<unsigned char>(text[0])) != 0 || text[0] == '-' || text[0] == '.') &&
        text.find("..") == std::string::npos && text.find("+-") == std::string::npos &&
        text.find("\u00b1") == std::string::npos) {
      const auto target = reader.value(e.value, *what);
      if (!target) return {};
      r.crossing = true;
      r.target.what = *what;
      r.target.low = r.target.high = r.target.target = *target;
      r.target.shown = text;
    } else {
      const auto target = reader.expectation(e.key, e.at, e.value, tolerance);
      if (!target) return {};
      r.target = *target;
    }
  }
  if (!any) {
    problems_.add(map.at(), "reached names nothing to wait for, as {output_frequency: 50 Hz, within: 5.2 s}.");
    return {};
  }
  if (!limit) return {};
  r.within = *limit;
  return r;
}

std::optional<Step::What> StepReader::ramp(const YAML::Node& value, const ExpectationReader& reader) {
  constexpr std::string_view kForm =
      "{signal: output_frequency, from: 0 Hz, to: 50 Hz, time: 5 s, tolerance: 100 ms, linearity: 0.2 Hz}";
  const rig::YamlMap map(value, "ramp", &scenario_keys().at("steps[].ramp"), problems_);
  if (!map) return {};
  for (const char* key : {"signal", "from", "to", "time", "tolerance"})
    if (!map.has(key)) {
      problems_.add(map.at(), "ramp lacks \"" + std::string(key) + "\"; it takes " + std::string(kForm) + ".");
      return {};
    }
  Ramp r;
  const auto name = map.text("signal");
  const auto what = name ? reader.signal(*name, rig::position_of(*map.find("signal"))) : std::nullopt;
  const auto time = read_duration(*map.find("time"), "time of ramp", std::chrono::milliseconds(1), problems_);
  if (!what || !time) return {};
  r.what = *what;
  r.time = *time;
  const auto from = reader.value(*map.find("from"), *what);
  const auto to = reader.value(*map.find("to"), *what);
  std::optional<Duration> tolerance;
  const YAML::Node& t = *map.find("tolerance");
  if (t.IsScalar() && t.Scalar().ends_with('%')) {
    const auto fraction = rig::parse_quantity(t.Scalar(), rig::Dimension::kFraction);
    if (fraction)
      tolerance = seconds_to_duration(to_seconds(*time) * std::abs(*fraction));
    else
      problems_.add(t, "tolerance of ramp: " + fraction.error());
  } else {
    tolerance = read_duration(t, "tolerance of ramp", Duration{}, problems_);
  }
  if (const YAML::Node* linearity = map.find("linearity")) {
    r.linearity = reader.distance(*linearity, *what, from && to ? *to - *from : 0);
    if (!r.linearity) return {};
  }
  if (!from || !to || !tolerance) return {};
  if (*from == *to) {
    problems_.add(*map.find("to"), "ramp ends where it begins.");
    return {};
  }
  r.from = *from;
  r.to = *to;
  r.tolerance = *tolerance;
  return r;
}

std::optional<Step::What> StepReader::trip(const YAML::Node& value, const ExpectationReader& reader,
                                           std::size_t drive) {
  const rig::YamlMap map(value, "trip", nullptr, problems_);
  if (!map) return {};
  const Keys own{"code", "within", "cause"};
  Trip t;
  if (const YAML::Node* code = map.find("code")) {
    const auto text = rig::read_text(*code, "code of trip", problems_);
    if (!text) return {};
    t.code = *text;
    const auto known = trial_.observer(drive).drive().inverter->injectable_faults();
    if (!contains(known, t.code)) {
      problems_.add(*code, "code of trip is \"" + t.code + "\"; " + rig::allowed_words(t.code, known));
      return {};
    }
  } else if (!map.has("code")) {
    problems_.add(map.at(), "trip lacks \"code\", as {code: E.OV3, within: 2 s}.");
    return {};
  }
  if (!map.has("within")) {
    problems_.add(map.at(), "trip lacks \"within\", the time in which it comes.");
    return {};
  }
  const auto within = read_duration(*map.find("within"), "within", std::chrono::milliseconds(1), problems_);
  if (const YAML::Node* cause = map.find("cause")) {
    if (cause->IsScalar()) t.cause.push_back(cause->Scalar());
    for (const auto& word : *cause)
      if (word.IsScalar()) t.cause.push_back(word.Scalar());
    if (t.cause.empty())
      problems_.add(*cause, "cause of trip is " + rig::kind_of(*cause) + "; allowed: text, or a list of it.");
  }
  const bool more =
      std::any_of(map.entries().begin(), map.entries().end(), [&](const auto& e) { return !contains(own, e.key); });
  if (more) {
    t.with = reader.mapping(value, "trip", own);
    if (t.with.empty()) return {};
  }
  if (!within) return {};
  t.within = *within;
  return t;
}

std::optional<Step::What> StepReader::frame(const std::string& word, const YAML::Node& value, const Step& s) {
  if (s.via.empty()) {
    problems_.add(s.at, word + " needs a master: \"via: NAME\".");
    return {};
  }
  if (word == "send_frame") {
    const auto bytes = parse_hex(value, word, problems_);
    if (!bytes) return {};
    return SendFrame{*bytes};
  }
  const rig::YamlMap map(value, word, &scenario_keys().at("steps[].expect_frame"), problems_);
  if (!map) return {};
  for (const char* key : {"bytes", "within"})
    if (!map.has(key)) {
      problems_.add(map.at(), word + " lacks \"" + key + "\", as {bytes: 05 06, mask: FF FF, within: 50 ms}.");
      return {};
    }
  ExpectFrame f;
  const auto bytes = parse_hex(*map.find("bytes"), "bytes", problems_);
  const auto within = read_duration(*map.find("within"), "within", Duration{}, problems_);
  if (!bytes || !within) return {};
  f.bytes = *bytes;
  f.mask = Bytes(f.bytes.size(), 0xFF);
  if (const YAML::Node* node = map.find("mask")) {
    const auto mask = parse_hex(*node, "mask", problems_);
    if (!mask) return {};
    if (mask->size() != f.bytes.size()) {
      problems_.add(*node, "mask has " + std::to_string(mask->size()) + " bytes, the frame has " +
                               std::to_string(f.bytes.size()) + "; allowed: the same number.");
      return {};
    }
    f.mask = *mask;
  }
  f.within = *within;
  return f;
}

}  // namespace vinv::scenario
