#include "sim/rig/wire_commands.hpp"

#include <algorithm>
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
using transports::Direction;
using transports::Fault;
using transports::FaultRule;
using transports::FaultTrigger;

enum Wire : unsigned {
  kCan = 1,
  kSerial = 2,
  kTcp = 4,
  kUdp = 8,
  kEthernet = 16,  // the cable itself, which carries both
  kStreams = kSerial | kTcp,
  kAll = kCan | kStreams | kUdp
};
struct WireName {
  std::string_view word;
  Wire wire;
};
constexpr std::array kWires{WireName{"can", kCan}, WireName{"serial", kSerial}, WireName{"tcp", kTcp},
                            WireName{"udp", kUdp}, WireName{"ethernet", kEthernet}};

// What the word's own value is.
enum class Value : std::uint8_t { kShare, kTime, kCount };

struct FaultWord {
  std::string_view word;
  std::optional<CanFault> can;
  std::optional<Fault> stream;
  unsigned wires;
  Value value;
  bool of_master = false;  // only what the master sends, whatever `of` says
  bool of_own = false;     // only what the board sends
};
constexpr std::array kFaults{
    FaultWord{"drop", CanFault::kDrop, Fault::kDrop, kAll, Value::kShare},
    FaultWord{"delay", CanFault::kDelay, Fault::kDelay, kAll, Value::kTime},
    FaultWord{"duplicate", CanFault::kDuplicate, Fault::kDuplicate, kAll, Value::kShare},
    FaultWord{"corrupt", CanFault::kCorrupt, Fault::kCorrupt, kAll, Value::kShare},
    FaultWord{"error_frame", CanFault::kErrorFrame, std::nullopt, kCan, Value::kShare},
    FaultWord{"bus_off", CanFault::kBusOff, std::nullopt, kCan, Value::kShare, false, true},
    FaultWord{"reorder", CanFault::kReorder, Fault::kReorder, kAll, Value::kTime},
    FaultWord{"truncate", std::nullopt, Fault::kTruncate, kStreams | kUdp, Value::kCount},
    FaultWord{"split", std::nullopt, Fault::kSplit, kStreams, Value::kTime},
    FaultWord{"silence", CanFault::kSilence, Fault::kDrop, kAll, Value::kShare, true, false},
    FaultWord{"duplicate_node", CanFault::kTwin, Fault::kGarble, kCan | kSerial | kEthernet, Value::kShare, false,
              true},
};
constexpr std::array<std::string_view, 7> kQualifiers{"share", "nth", "every", "times", "for", "id", "of"};
constexpr std::array<std::string_view, 5> kAlone{"bus_off", "unplugged", "plugged", "half_open", "none"};
constexpr std::uint32_t kStandardIds = 0x7FF;

bool is_bare(const Json& value) { return value.is_null() || (value.is_string() && value.get<std::string>().empty()); }

std::uint32_t identifier_of(const Json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : shown(value);
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id, 16);
  if (!value.is_string() || error != std::errc{} || end != text.data() + text.size() || id > kStandardIds)
    invalid("id is " + shown(value) + "; allowed: a standard identifier in hexadecimal, as text: \"0\" to \"7FF\".");
  return id;
}

double share_of(const Json& value, std::string_view what) {
  bool on = false;
  if (is_bare(value)) return 1;
  if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
  if (value.is_string() && parse_switch(value.get<std::string>(), on)) return on ? 1 : 0;
  return quantity_within(value, Dimension::kFraction, what, 0, 1, "0 to 100 % of the frames");
}

std::uint64_t count_of(const Json& value, std::string_view what) {
  constexpr double kMost = 1e9;
  const double v = number_of(value, what);
  if (v < 1 || v > kMost || v != std::floor(v))
    invalid(std::string(what) + " is " + shown(value) + "; allowed: a whole number from 1.");
  return static_cast<std::uint64_t>(v);
}

// Two digits after the point are enough for a person.
double rounded(double percent) { return std::round(percent * 100) / 100; }

void describe(Json& row, const FaultTrigger& when) {
  if (when.nth != 0)
    row["nth"] = when.nth;
  else if (when.every != 0)
    row["every"] = when.every;
  else
    row["share_percent"] = rounded(when.probability * 100);
  if (when.times != 0) row["times"] = when.times;
  if (when.until != kForever) row["until_s"] = to_seconds(when.until);
}

Json faults_json(const WireTap& tap) {
  Json out = Json::array();
  for (const FaultRule& rule : tap.faults()) {
    Json row;
    for (const FaultWord& f : kFaults)
      if (f.stream == rule.fault && !row.contains("fault")) row["fault"] = f.word;
    describe(row, rule.when);
    if (rule.delay > Duration{}) row["delay_ms"] = to_seconds(rule.delay) * 1000;
    if (rule.fault == Fault::kTruncate) row["bytes"] = rule.bytes;
    row["of"] = rule.direction == Direction::kSend ? "own" : "master";
    out.push_back(std::move(row));
  }
  return out;
}

// What the drive hangs on, and may be disturbed now.
struct Wires {
  CanLine* can = nullptr;
  WireTap* serial = nullptr;
  WireTap* tcp = nullptr;
  WireTap* udp = nullptr;
  bool ethernet = false;
  unsigned present() const {
    return (can != nullptr ? kCan : 0u) | (serial != nullptr ? kSerial : 0u) | (tcp != nullptr ? kTcp : 0u) |
           (udp != nullptr ? kUdp : 0u) | (ethernet ? kEthernet : 0u);
  }
};

Wires wires_of(Plant& plant, DriveUnit& drive, const Json& map) {
  Wires all{plant.can_line_of(drive), plant.serial_tap_of(drive), plant.tcp_tap_of(drive), plant.udp_tap_of(drive),
            drive.station != nullptr};
  if (all.present() == 0) refused("the drive is on no wire.");
  if (!map.contains("port")) return all;
  Words names;
  for (const WireName& w : kWires) names.push_back(w.word);
  const std::string word = word_of(map["port"], names, "port");
  Wires one;
  if (word == "can") one.can = all.can;
  if (word == "serial") one.serial = all.serial;
  if (word == "tcp") one.tcp = all.tcp;
  if (word == "udp") one.udp = all.udp;
  if (word == "ethernet") one.ethernet = all.ethernet;
  if (one.present() == 0)
    refused("the drive is on no " +
            (word == "can"        ? "CAN bus"
             : word == "ethernet" ? "Ethernet"
                                  : word + " wire") +
            ".");
  return one;
}

// Words that act at once and stand alone; false if the value is none of them.
bool act_at_once(Plant& plant, DriveUnit& drive, const Wires& wires, const Json& map) {
  if (map.size() - (map.contains("port") ? 1 : 0) != 1) return false;
  const auto entry = map.begin().key() == "port" ? std::next(map.begin()) : map.begin();
  const std::string& word = entry.key();
  if (!is_bare(entry.value())) return false;
  const Instant now = plant.now();
  if (word == "none") {
    if (wires.can != nullptr) wires.can->clear_faults();
    for (WireTap* tap : {wires.serial, wires.tcp, wires.udp})
      if (tap != nullptr) tap->clear_faults();
    if (wires.ethernet) plant.set_double(drive, false);
    return true;
  }
  if (word == "half_open") {
    if (wires.tcp == nullptr) refused("half_open is of TCP connections, which the drive has none of.");
    wires.tcp->half_open();
    return true;
  }
  if (word != "bus_off" && word != "error_frame" && word != "unplugged" && word != "plugged") return false;
  if (word.ends_with("plugged") && plant.plug_ethernet(drive, word == "plugged")) return true;
  if (wires.can == nullptr) refused("the drive is on no CAN bus.");
  if (word == "bus_off")
    wires.can->controller(*drive.controller).force_bus_off(now);
  else if (word == "error_frame")
    wires.can->bus().inject_error_frame(now);
  else
    wires.can->plug(now, *drive.controller, word == "plugged");
  return true;
}

struct Order {
  FaultTrigger when;
  Duration delay{};
  std::size_t bytes = 1;
};

Order order_of(const FaultWord& fault, const Json& map, Instant now) {
  const std::string word(fault.word);
  const Json& value = map[word];
  Order order;
  switch (fault.value) {
    case Value::kShare: order.when.probability = share_of(value, word); break;
    case Value::kTime:
      order.delay = seconds_to_duration(quantity_within(value, Dimension::kTime, word, 0, 3600, "0 to 60 min"));
      order.when.probability = map.contains("share") ? share_of(map["share"], "share") : order.delay > Duration{};
      break;
    case Value::kCount:
      order.bytes = static_cast<std::size_t>(count_of(value, word));
      order.when.probability = map.contains("share") ? share_of(map["share"], "share") : 1;
      break;
  }
  if (order.when.probability > 0) {
    if (map.contains("nth")) order.when.nth = count_of(map["nth"], "nth");
    if (map.contains("every")) order.when.every = count_of(map["every"], "every");
  }
  if (map.contains("times")) order.when.times = count_of(map["times"], "times");
  order.when.from = now;
  if (map.contains("for"))
    order.when.until =
        now + seconds_to_duration(quantity_within(map["for"], Dimension::kTime, "for", 1e-3, 3600, "1 ms to 60 min"));
  return order;
}

void set_on_can(Plant& plant, const DriveUnit& drive, CanLine& line, const FaultWord& fault, const Order& order,
                std::string_view of, const Json& map) {
  CanFaultRule rule;
  rule.fault = *fault.can;
  rule.when = order.when;
  rule.delay = order.delay;
  if (map.contains("id")) {
    rule.id = identifier_of(map["id"]);
    rule.mask = kStandardIds;
    rule.extended = false;
  }
  if (of == "own") rule.node = drive.spec.name;
  if (of == "master")
    for (const auto& d : plant.drives())
      if (plant.can_line_of(*d) == &line) rule.not_nodes.push_back(d->spec.name);
  line.set_fault(rule);
}

void set_on_stream(WireTap& tap, const FaultWord& fault, const Order& order, std::string_view of) {
  FaultRule rule;
  rule.fault = *fault.stream;
  rule.when = order.when;
  rule.delay = order.delay;
  rule.bytes = order.bytes;
  for (const Direction direction : {Direction::kSend, Direction::kReceive}) {
    if (of == (direction == Direction::kSend ? "master" : "own")) continue;
    rule.direction = direction;
    tap.set_fault(rule);
  }
}

std::string word_on_ethernet(const FaultWord& fault) {
  return std::string(fault.word) + " of a board on Ethernet is on or off";
}

void set_fault(Plant& plant, DriveUnit& drive, const Wires& wires, const FaultWord& fault, const Json& map) {
  const unsigned usable = wires.present() & fault.wires;
  if (usable == 0) {
    std::string on;
    for (const WireName& w : kWires)
      if ((w.wire & fault.wires) != 0) on += (on.empty() ? "" : ", ") + std::string(w.word);
    refused(std::string(fault.word) + " is a fault of " + on + "; the drive has no such wire here.");
  }
  const Order order = order_of(fault, map, plant.now());
  std::string of = map.contains("of") ? word_of(map["of"], {"own", "master", "all"}, "of") : "all";
  if (fault.of_master) of = "master";
  if (fault.of_own) of = "own";
  if ((usable & kEthernet) != 0) {
    // It is there or not: no matter of frames.
    const double share = order.when.probability;
    for (const char* chosen : {"nth", "every", "times", "for", "of", "id"})
      if (map.contains(chosen)) invalid(word_on_ethernet(fault) + " without " + chosen + ".");
    if (share != 0 && share != 1) invalid(word_on_ethernet(fault) + ".");
    plant.set_double(drive, share != 0);
  }
  if ((usable & kCan) != 0) set_on_can(plant, drive, *wires.can, fault, order, of, map);
  if ((usable & kSerial) != 0) set_on_stream(*wires.serial, fault, order, of);
  if ((usable & kTcp) != 0) set_on_stream(*wires.tcp, fault, order, of);
  if ((usable & kUdp) != 0) set_on_stream(*wires.udp, fault, order, of);
}

Json report(const DriveUnit& drive, const Wires& wires) {
  Json out = Json::object();
  if (wires.can != nullptr) {
    out["network"] = wires.can->bus().options().name;
    out["plugged"] = wires.can->plugged(*drive.controller);
    out["faults"] = faults_json(*wires.can);
  }
  if (wires.serial != nullptr) out["serial_faults"] = faults_json(*wires.serial);
  if (wires.tcp != nullptr) out["tcp_faults"] = faults_json(*wires.tcp);
  if (wires.udp != nullptr) out["udp_faults"] = faults_json(*wires.udp);
  if (drive.station != nullptr) out["plugged"] = drive.station->plugged();
  if (wires.ethernet) out["duplicate_node"] = drive.has_double;
  return out;
}

}  // namespace

Words wire_words() {
  Words out;
  for (const FaultWord& f : kFaults) out.push_back(f.word);
  out.insert(out.end(), kQualifiers.begin(), kQualifiers.end());
  out.push_back("port");
  for (const std::string_view word : kAlone)
    if (std::find(out.begin(), out.end(), word) == out.end()) out.push_back(word);
  return out;
}

Json faults_json(const CanLine& line) {
  Json out = Json::array();
  for (const CanFaultRule& rule : line.faults()) {
    Json row;
    for (const FaultWord& f : kFaults)
      if (f.can == rule.fault) row["fault"] = f.word;
    describe(row, rule.when);
    if (rule.delay > Duration{}) row["delay_ms"] = to_seconds(rule.delay) * 1000;
    if (rule.mask != 0) {
      std::array<char, 8> hex{};
      const auto end = std::to_chars(hex.data(), hex.data() + hex.size(), rule.id, 16).ptr;
      row["id"] = std::string(hex.data(), end);
    }
    row["of"] = !rule.node.empty() ? rule.node : !rule.not_nodes.empty() ? std::string("master") : std::string("all");
    out.push_back(std::move(row));
  }
  return out;
}

Json wire_faults(Plant& plant, DriveUnit& drive, const Json& value) {
  Json map = value;
  if (map.is_string()) map = Json{{map.get<std::string>(), ""}};
  map_of(map, wire_words(), "wire",
         "{drop: 10 %}, {drop: on, nth: 3}, {delay: 20 ms, share: 50 %, id: 185, of: own}, {silence: on, for: 2 s}, "
         "bus_off or none");
  const Wires wires = wires_of(plant, drive, map);
  if (!act_at_once(plant, drive, wires, map)) {
    for (const char* alone : {"unplugged", "plugged", "half_open", "none"})
      if (map.contains(alone))
        invalid(std::string(alone) + " stands alone, as in: vinverter ctl conveyor_1 wire " + alone + ".");
    const bool chosen = map.contains("nth") || map.contains("every") || map.contains("id");
    for (const char* now : {"bus_off", "error_frame"})
      if (map.contains(now) && is_bare(map[now]) && !chosen)
        invalid(std::string(now) + " stands alone, as in: vinverter ctl conveyor_1 wire " + now +
                "; as a fault that lasts it takes a share of the frames, on, nth or every.");
    bool takes_share = false;
    std::vector<const FaultWord*> faults;
    for (const FaultWord& f : kFaults) {
      if (!map.contains(std::string(f.word))) continue;
      faults.push_back(&f);
      takes_share = takes_share || f.value != Value::kShare;
    }
    if (map.contains("share") && !takes_share)
      invalid("share belongs to delay, reorder, split and truncate, as {delay: 20 ms, share: 50 %}.");
    if (map.contains("nth") && map.contains("every")) invalid("nth and every exclude each other.");
    if (faults.empty()) {
      Words known;
      for (const FaultWord& f : kFaults) known.push_back(f.word);
      invalid("wire lacks a fault; allowed: " + join(known) + ".");
    }
    for (const FaultWord* f : faults) set_fault(plant, drive, wires, *f, map);
  }
  return report(drive, wires);
}

}  // namespace vinv::rig
