#include "sim/scenario/step_reader.hpp"

#include <algorithm>
#include <iterator>

#include "sim/rig/words.hpp"
#include "sim/scenario/action_reader.hpp"
#include "sim/scenario/node_values.hpp"
#include "sim/scenario/substitution.hpp"
#include "sim/scenario/watch_reader.hpp"

namespace vinv::scenario {
namespace {

const Keys& pace_words() {
  static const Keys words{"at", "after", "when", "within", "drive", "via", "refused", "during"};
  return words;
}
const Keys& own_words() {
  static const Keys words{"check",  "reached", "ramp",    "trip",   "always", "never",      "overshoot",
                          "rising", "falling", "follows", "repeat", "note",   "send_frame", "expect_frame"};
  return words;
}

}  // namespace

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
  const CheckReader checks(trial_, s.drive, problems_);
  std::optional<Step::What> what;
  if (verb->key == "check") {
    what = checks.check(value);
  } else if (verb->key == "reached") {
    what = checks.reached(value);
  } else if (verb->key == "ramp") {
    what = checks.ramp(value);
  } else if (verb->key == "trip") {
    what = checks.trip(value);
  } else if (verb->key == "note") {
    if (const auto text = rig::read_text(value, "note", problems_)) what = Note{*text};
  } else {
    what = frame(verb->key, value, s, checks);
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
    } else if (const Keys reaching = masters_of(s.drive); !contains(reaching, s.via)) {
      problems_.add(via->value, std::string(trial_.drive_names()[s.drive]) + " is on no wire of the master " + s.via +
                                    "; " +
                                    (reaching.empty() ? "no master reaches it." : rig::allowed_words(s.via, reaching)));
    }
  }
  return fine;
}

std::vector<std::string_view> StepReader::masters_of(std::size_t drive) const {
  std::vector<std::string_view> names;
  for (const MasterKind& m : options_.masters)
    if (!m.reaches || m.reaches(trial_.observer(drive).drive())) names.push_back(m.name);
  return names;
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
    else if (master != options_.masters.end() && master->objection)
      if (const std::string why = master->objection(a.command, a.value); !why.empty())
        problems_.add(value.IsNull() ? verb.key_node : value, rig::sentence(why));
  } else if (!a.refused) {
    try_by_hand(trial_, s.drive, a, rig::position_of(verb.key_node), value, problems_);
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
  auto w = WatchReader(reader, problems_, folder_).read(verb.key, value);
  bool fine = w.has_value();
  if (w) w->number = watches_++;
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
  s.what = *w;
  out.push_back(s);
  if (during == nullptr) return;
  const std::size_t moved = out.size();
  out.insert(out.end(), std::make_move_iterator(body.begin()), std::make_move_iterator(body.end()));
  // Loops inside the body count from its own beginning.
  for (std::size_t i = moved; i < out.size(); ++i)
    if (auto* end = std::get_if<RepeatEnd>(&out[i].what)) end->begin += moved;
  s.what = WatchEnd{w->number};
  s.pace = {};
  out.push_back(std::move(s));
}

std::optional<Step::What> StepReader::frame(const std::string& word, const YAML::Node& value, const Step& s,
                                            const CheckReader& checks) {
  if (s.via.empty()) {
    problems_.add(s.at, word + " needs a master: \"via: NAME\".");
    return {};
  }
  if (word == "expect_frame") return checks.expect_frame(value);
  const auto bytes = read_hex(value, word, problems_);
  if (!bytes) return {};
  return SendFrame{*bytes};
}

}  // namespace vinv::scenario
