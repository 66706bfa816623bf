#include "sim/rig/can_commands.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/rig/words.hpp"

namespace vinv::rig {
namespace {

using transports::CanFault;
using transports::CanFaultRule;

struct FaultWord {
  std::string_view word;
  CanFault fault;
};
constexpr std::array kFaults{FaultWord{"drop", CanFault::kDrop}, FaultWord{"delay", CanFault::kDelay},
                             FaultWord{"duplicate", CanFault::kDuplicate}, FaultWord{"corrupt", CanFault::kCorrupt},
                             FaultWord{"error_frame", CanFault::kErrorFrame}};
constexpr std::uint32_t kStandardIds = 0x7FF;

std::uint32_t identifier_of(const Json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : shown(value);
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id, 16);
  if (!value.is_string() || error != std::errc{} || end != text.data() + text.size() || id > kStandardIds)
    invalid("id is " + shown(value) + "; allowed: a standard identifier in hexadecimal, as text: \"0\" to \"7FF\".");
  return id;
}

double share_of(const Json& value, std::string_view what) {
  return quantity_within(value, Dimension::kFraction, what, 0, 1, "0 to 100 % of the frames");
}

// Two digits after the point are enough for a person.
double rounded(double percent) { return std::round(percent * 100) / 100; }

Json faults_json(const CanLine& line) {
  Json out = Json::array();
  for (const CanFaultRule& rule : line.faults()) {
    Json row;
    for (const FaultWord& f : kFaults)
      if (f.fault == rule.fault) row["fault"] = f.word;
    row["share_percent"] = rounded(rule.when.probability * 100);
    if (rule.fault == CanFault::kDelay) row["delay_ms"] = to_seconds(rule.delay) * 1000;
    if (rule.mask != 0) {
      std::array<char, 8> hex{};
      const auto end = std::to_chars(hex.data(), hex.data() + hex.size(), rule.id, 16).ptr;
      row["id"] = std::string(hex.data(), end);
    }
    row["of"] = rule.node.empty() ? std::string("all") : rule.node;
    out.push_back(std::move(row));
  }
  return out;
}

// Words that act at once and stand alone; false if the value is none of them.
bool act_at_once(Plant& plant, DriveUnit& drive, CanLine& line, const Json& map) {
  if (map.size() != 1) return false;
  const std::string& word = map.begin().key();
  const Json& value = map.begin().value();
  if (!value.is_string() || !value.get<std::string>().empty()) return false;
  const Instant now = plant.now();
  if (word == "none")
    line.clear_faults();
  else if (word == "bus_off")
    line.controller(*drive.controller).force_bus_off(now);
  else if (word == "error_frame")
    line.bus().inject_error_frame(now);
  else if (word == "unplugged" || word == "plugged")
    line.plug(now, *drive.controller, word == "plugged");
  else
    return false;
  return true;
}

}  // namespace

Words wire_words() {
  Words out;
  for (const FaultWord& f : kFaults) out.push_back(f.word);
  out.insert(out.end(), {"share", "id", "of", "bus_off", "unplugged", "plugged", "none"});
  return out;
}

Json wire_faults(Plant& plant, DriveUnit& drive, const Json& value) {
  CanLine* line = plant.can_line_of(drive);
  if (line == nullptr) refused("the drive is on no CAN bus.");
  Json map = value;
  if (map.is_string()) map = Json{{map.get<std::string>(), ""}};
  map_of(map, wire_words(), "wire", "{drop: 10 %}, {delay: 20 ms, share: 50 %, id: 185, of: own}, bus_off or none");
  if (!act_at_once(plant, drive, *line, map)) {
    CanFaultRule common;
    if (map.contains("id")) {
      common.id = identifier_of(map["id"]);
      common.mask = kStandardIds;
      common.extended = false;
    }
    if (map.contains("of") && word_of(map["of"], {"own", "all"}, "of") == "own") common.node = drive.spec.name;
    std::vector<CanFaultRule> rules;
    for (const FaultWord& f : kFaults) {
      const std::string word(f.word);
      if (!map.contains(word)) continue;
      CanFaultRule rule = common;
      rule.fault = f.fault;
      if (f.fault == CanFault::kDelay) {
        rule.delay = seconds_to_duration(quantity_within(map[word], Dimension::kTime, word, 0, 3600, "0 to 60 min"));
        rule.when.probability = map.contains("share") ? share_of(map["share"], "share") : rule.delay > Duration{} ? 1 : 0;
      } else {
        rule.when.probability = share_of(map[word], word);
      }
      rules.push_back(std::move(rule));
    }
    for (const char* alone : {"bus_off", "unplugged", "plugged", "none"})
      if (map.contains(alone))
        invalid(std::string(alone) + " stands alone, as in: vinverter ctl conveyor_1 wire " + alone + ".");
    if (map.contains("share") && !map.contains("delay"))
      invalid("share belongs to delay, as {delay: 20 ms, share: 50 %}.");
    if (rules.empty())
      invalid("wire lacks a fault; allowed: " + join({"drop", "delay", "duplicate", "corrupt", "error_frame"}) + ".");
    for (const CanFaultRule& rule : rules) line->set_fault(rule);
  }
  return Json{{"network", line->bus().options().name},
              {"plugged", line->plugged(*drive.controller)},
              {"faults", faults_json(*line)}};
}

Json can_json(Plant& plant, const DriveUnit& drive) {
  const CanLine& line = *plant.can_line_of(drive);
  const transports::CanStatus status = line.controller(*drive.controller).status();
  const transports::CanBusStats stats = line.bus().stats(plant.now());
  return {{"network", line.bus().options().name},
          {"node", drive.can_node()},
          {"bitrate", drive.board->can_channel()->bit_rate()},
          {"state", text(status.state)},
          {"tec", status.counters.tec},
          {"rec", status.counters.rec},
          {"sent", status.sent},
          {"received", status.received},
          {"lost", status.lost},
          {"bus_load_percent", rounded(stats.load.last_second * 100)}};
}

Json buses_json(Plant& plant) {
  Json out = Json::array();
  const auto& networks = plant.file().can;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const CanLine& line = plant.can_line(i);
    Json drives = Json::array();
    for (const auto& d : plant.drives())
      if (plant.can_line_of(*d) == &line)
        drives.push_back({{"name", d->spec.name},
                          {"node", d->can_node()},
                          {"state", text(line.controller(*d->controller).status().state)}});
    if (drives.empty()) continue;
    const transports::CanBusStats stats = line.bus().stats(plant.now());
    Json row{{"name", networks[i].name},
             {"can", text_of(networks[i])},
             {"bitrate", networks[i].bitrate},
             {"load_percent", rounded(stats.load.last_second * 100)},
             {"peak_load_percent", rounded(stats.load.peak_second * 100)},
             {"frames", stats.frames},
             {"error_frames", stats.error_frames},
             {"arbitrations_lost", stats.arbitrations_lost},
             {"nodes", stats.nodes},
             {"faults", faults_json(line)},
             {"faults_injected", stats.faults_injected},
             {"drives", std::move(drives)}};
    if (const transports::CanBridge* bridge = line.bridge()) {
      const transports::CanStatus outside = bridge->outside().status();
      row["outside"] = {{"state", text(outside.state)}, {"lost", bridge->lost() + outside.lost}};
    }
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace vinv::rig
