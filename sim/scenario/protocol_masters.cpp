#include "sim/scenario/protocol_masters.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

#include "sim/masters/canopen_station.hpp"
#include "sim/masters/modbus_station.hpp"
#include "sim/rig/quantity.hpp"
#include "sim/rig/words.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::scenario {
namespace {

using masters::Word;
using rig::Json;

enum class Wire : std::uint8_t { kSerial, kTcp, kCan };

struct Kind {
  std::string_view name;     // in `via:`
  std::string_view profile;  // protocol of the board profile
  Wire wire;
};
constexpr Kind kKinds[] = {{"modbus", "modbus", Wire::kSerial},
                           {"modbus_tcp", "modbus", Wire::kTcp},
                           {"canopen", "canopen", Wire::kCan},
                           {"canopen_sdo", "canopen-sdo", Wire::kCan},
                           {"canopen_402", "canopen-402", Wire::kCan}};

constexpr Duration kTcpDelay = std::chrono::microseconds(100);  // of a local network

// "Pr.7", "Pr.902.1"; false if it is no parameter.
bool parse_parameter(std::string_view name, masters::Order& order) {
  if (!name.starts_with("Pr.")) return false;
  const char* const end = name.data() + name.size();
  auto [at, error] = std::from_chars(name.data() + 3, end, order.parameter);
  if (error != std::errc{}) return false;
  if (at == end) return true;
  if (*at != '.') return false;
  const auto sub = std::from_chars(at + 1, end, order.sub);
  return sub.ec == std::errc{} && sub.ptr == end;
}

// A serial line's settings as masters have them.
masters::ModbusMasterSettings modbus_settings(const boards::LineSettings& line) {
  masters::ModbusMasterSettings s;
  s.baud = line.baud;
  s.bits_per_character = line.parity == boards::LineSettings::Parity::kNone ? 10 : 11;
  return s;
}

// Of one master, beside its wires.
struct State {
  masters::Station* station_ = nullptr;  // spoken on last
  rig::DriveUnit* drive_ = nullptr;
  const masters::BoardProfile* profile_ = nullptr;
  std::vector<std::pair<std::string, masters::Order>> orders_;  // still to be done, with their names
  Json readings_;
  std::optional<Master::Outcome> outcome_;
};

void archive_json(Archive& a, Json& value) {
  std::string text = a.loads() ? std::string() : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  a.io(text);
  if (!a.loads() || a.failed()) return;
  value = Json::parse(text, nullptr, false);
  a.require(!value.is_discarded(), "an answer is no JSON");
}

class ProtocolMaster : public Master, private State {
 public:
  ProtocolMaster(const Kind& kind, const MasterContext& context) : kind_(kind), context_(context) {}

  std::vector<std::string_view> words() const override { return master_words(); }

  void begin(Instant now, std::size_t drive, std::string_view word, const Json& value) override {
    outcome_.reset();
    orders_.clear();
    readings_ = nullptr;
    drive_ = context_.plant.drives()[drive].get();
    station_ = station_of(now, *drive_);
    if (station_ == nullptr) return;
    if (word == "silence") return silence(now, value);
    if (const auto bad = read(word, value)) {
      outcome_ = Unexpected(*bad);
      return;
    }
    profile_ = masters::find_profile(drive_->spec.board->type.value, kind_.profile);
    if (profile_ == nullptr) {
      outcome_ = Unexpected("nobody has said how board " + drive_->spec.board->type.value + " is spoken to over " +
                            std::string(kind_.profile));
      return;
    }
    next(now);
  }

  std::optional<Outcome> poll(Instant now) override {
    while (!outcome_ && station_ != nullptr) {
      const auto done = station_->poll();
      if (!done) return std::nullopt;
      if (!*done) {
        outcome_ = Unexpected(done->error());
        break;
      }
      const masters::Order& order = orders_.front().second;
      if (order.word == Word::kReadParameter || order.word == Word::kMonitor)
        readings_[orders_.front().first] = (*done)->value;
      orders_.erase(orders_.begin());
      next(now);
    }
    return std::exchange(outcome_, std::nullopt);
  }

  void send_frame(Instant now, ByteView frame) override {
    // Of the wire that was spoken on last, or of the first drive that has one.
    for (const auto& d : context_.plant.drives())
      if (station_ == nullptr) station_ = station_of(now, *d);
    if (station_ != nullptr) station_->send_frame(now, frame);
  }

  std::vector<Bytes> take_frames() override {
    std::vector<Bytes> all;
    for (const auto& [wire, wired] : stations_)
      for (Bytes& frame : wired.station->take_frames()) all.push_back(std::move(frame));
    return all;
  }

  void archive_wires(Archive& a) override {
    const auto& drives = context_.plant.drives();
    const std::size_t count = a.count(stations_.size(), drives.size());
    if (a.loads()) {
      station_ = nullptr;
      stations_.clear();
    }
    auto at = stations_.begin();
    for (std::size_t i = 0; i < count && !a.failed(); ++i) {
      std::size_t drive = a.loads() ? 0 : (at++)->second.drive;
      a.io(drive);
      a.require(drive < drives.size() && station_of(context_.plant.now(), *drives[drive]) != nullptr,
                "a master is on a wire that there is not");
    }
    a.require(stations_.size() == count, "a master is on one wire twice");
  }

  void archive_state(Archive& a) override {
    auto& drives = context_.plant.drives();
    VINV_MEMBERS(static_cast<State&>(*this), station, drive, profile, orders, readings, outcome);
    // By what they are found by.
    std::optional<std::size_t> wire, spoken_to;
    for (const auto& [number, wired] : stations_)
      if (wired.station.get() == station) wire = number;
    for (std::size_t i = 0; i < drives.size(); ++i)
      if (drives[i].get() == drive) spoken_to = i;
    VINV_FIELDS(a, ProtocolMaster, wire, spoken_to, orders);
    archive_json(a, readings);
    bool present = outcome.has_value();
    a.io(present);
    if (present) {
      bool done = outcome && outcome->has_value();
      Json value = done && !a.loads() ? **outcome : Json();
      std::string refusal = outcome && !done ? outcome->error() : std::string();
      a.io(done);
      archive_json(a, value);
      a.io(refusal);
      if (a.loads()) outcome = done ? Outcome(std::move(value)) : Outcome(Unexpected(std::move(refusal)));
    } else {
      outcome.reset();
    }
    for (const auto& [number, wired] : stations_) {
      if (a.failed()) return;
      wired.station->archive(a);
    }
    if (!a.loads()) return;
    a.require((!wire || stations_.contains(*wire)) && (!spoken_to || *spoken_to < drives.size()),
              "a master speaks to nobody");
    if (a.failed()) return;
    station = wire ? stations_.at(*wire).station.get() : nullptr;
    drive = spoken_to ? drives[*spoken_to].get() : nullptr;
    profile = drive != nullptr && drive->spec.board
                  ? masters::find_profile(drive->spec.board->type.value, kind_.profile)
                  : nullptr;
    a.require(orders.empty() || (station != nullptr && profile != nullptr), "a master has orders for nobody");
  }

 private:
  void silence(Instant now, const Json& value) {
    bool on = value.is_null();
    if (value.is_boolean())
      on = value.get<bool>();
    else if (value.is_string() && !rig::parse_switch(value.get<std::string>(), on))
      outcome_ = Unexpected(std::string("silence is ") + value.dump() + "; allowed: on, off");
    if (outcome_) return;
    for (const auto& [wire, wired] : stations_) wired.station->set_silent(now, on);
    outcome_ = Json(on ? "on" : "off");
  }

  void next(Instant now) {
    if (orders_.empty()) {
      outcome_ = readings_;
      return;
    }
    station_->begin(now, *profile_, orders_.front().second);
  }

  masters::Order order(Word word, double value = 0) const {
    masters::Order o;
    o.node = static_cast<std::uint8_t>(kind_.wire == Wire::kCan ? drive_->can_node() : drive_->unit());
    o.word = word;
    o.value = value;
    return o;
  }
  void add(const masters::Order& o, std::string name = {}) { orders_.emplace_back(std::move(name), o); }

  // The orders that the word stands for; a sentence if it cannot be understood.
  std::optional<std::string> read(std::string_view word, const Json& value) {
    const std::string text = value.is_string() ? value.get<std::string>() : std::string{};
    const auto wrong = [&](std::string_view allowed) {
      return std::string(word) + " is " + (value.is_null() ? "nothing" : value.dump()) +
             "; allowed: " + std::string(allowed);
    };
    if (word == "run") {
      if (text != "forward" && text != "reverse") return wrong("forward, reverse");
      add(order(text == "forward" ? Word::kRunForward : Word::kRunReverse));
    } else if (word == "mode") {
      if (text != "NET" && text != "EXT") return wrong("NET, EXT");
      add(order(text == "NET" ? Word::kEnterNetwork : Word::kLeaveNetwork));
    } else if (word == "reference") {
      if (const auto hz = rig::parse_quantity(text, rig::Dimension::kFrequency))
        add(order(Word::kReferenceHz, *hz));
      else if (const auto rpm = rig::parse_quantity(text, rig::Dimension::kSpeed))
        add(order(Word::kReferenceRpm, *rpm));
      else
        return wrong("a frequency or a speed, as 40 Hz or 1200 rpm");
      if (orders_.back().second.value < 0) return wrong("0 or more; run: reverse gives the direction");
    } else if (word == "monitor") {
      if (text.empty()) return wrong("the name of a monitor, as output_frequency");
      masters::Order o = order(Word::kMonitor);
      o.monitor = text;
      add(o, text);
    } else if (word == "parameter") {
      return read_parameters(value);
    } else if (word == "stop") {
      add(order(Word::kStop));
    } else if (word == "quick_stop") {
      add(order(Word::kQuickStop));
    } else if (word == "reset") {
      add(order(Word::kReset));
    } else {
      add(order(Word::kClearAlarms));
    }
    return std::nullopt;
  }

  std::optional<std::string> read_parameters(const Json& value) {
    constexpr std::string_view kForm = "parameter takes Pr.7, [Pr.7, Pr.8] or {Pr.7: 2.5}";
    const Json names = value.is_string() ? Json::array({value}) : value;
    if (!names.is_array() && !names.is_object()) return std::string(kForm);
    for (const auto& [key, entry] : names.items()) {
      if (names.is_array() && !entry.is_string()) return std::string(kForm);
      const std::string name = names.is_array() ? entry.get<std::string>() : key;
      masters::Order o = order(names.is_array() ? Word::kReadParameter : Word::kWriteParameter);
      const auto known = drive_->inverter->parameters();
      const auto fits = [&](const inverter::ParameterInfo& p) {
        return p.id.number == o.parameter && (p.id.sub == o.sub || o.sub == 0);
      };
      if (!parse_parameter(name, o)) return "\"" + name + "\" is no parameter; allowed: names as Pr.7";
      // One that the family does not have is the board's to refuse.
      const auto info = std::find_if(known.begin(), known.end(), fits);
      if (info != known.end()) o.increment = info->increment;
      if (names.is_object()) {
        if (entry.is_number())
          o.value = entry.get<double>();
        else if (!entry.is_string() || !rig::parse_number(entry.get<std::string>(), o.value))
          return name + " is " + entry.dump() + "; allowed: a number";
      }
      add(o, name);
    }
    return std::nullopt;
  }

  // nullptr and an outcome: the drive has no such wire.
  masters::Station* station_of(Instant now, const rig::DriveUnit& drive) {
    const auto& board = drive.spec.board;
    const auto wire = !board                        ? std::nullopt
                      : kind_.wire == Wire::kSerial ? board->serial
                      : kind_.wire == Wire::kTcp    ? board->tcp
                      : drive.controller            ? board->can
                                                    : std::nullopt;
    if (!wire) {
      outcome_ = Unexpected(drive.spec.name + " is on no wire of the master " + std::string(kind_.name));
      return nullptr;
    }
    Wired& wired = stations_[*wire];
    if (wired.station == nullptr) {
      const auto& all = context_.plant.drives();
      const auto at = std::find_if(all.begin(), all.end(), [&](const auto& d) { return d.get() == &drive; });
      wired.drive = static_cast<std::size_t>(at - all.begin());
      wired.station = make(now, drive, *wire);
    }
    return wired.station.get();
  }

  std::unique_ptr<masters::Station> make(Instant now, const rig::DriveUnit& drive, std::size_t wire) {
    rig::Plant& plant = context_.plant;
    kernel::Scheduler& scheduler = plant.scheduler();
    std::unique_ptr<masters::Station> made;
    WireRecord record;
    switch (kind_.wire) {
      case Wire::kSerial: {
        const masters::ModbusMasterSettings settings = modbus_settings(drive.board->serial_channel()->line_settings());
        const Duration character{std::int64_t{1'000'000'000} * settings.bits_per_character / settings.baud};
        made = std::make_unique<masters::ModbusStation>(
            scheduler, settings,
            [&plant, wire, character](Instant) {
              auto [board, master] = plant.streams().connect({.character = character});
              plant.connect_serial(wire, std::move(board));
              return std::move(master);
            },
            &plant.streams());
        record.kind = WireRecord::Kind::kSerial;
        record.network = plant.file().serial[wire].name;
        break;
      }
      case Wire::kTcp: {
        masters::ModbusMasterSettings settings;
        settings.framing = masters::ModbusFraming::kTcp;
        settings.retries = 0;
        made = std::make_unique<masters::ModbusStation>(
            scheduler, settings,
            [&plant, wire](Instant at) {
              auto [board, master] = plant.streams().connect({.delay = kTcpDelay});
              plant.accept_tcp(wire, at, std::move(board));
              return std::move(master);
            },
            &plant.streams());
        record.kind = WireRecord::Kind::kTcp;
        record.network = "modbus_tcp";
        break;
      }
      case Wire::kCan: {
        transports::CanNodeOptions node;
        node.name = kind_.name;
        made = std::make_unique<masters::CanopenStation>(scheduler, masters::CanopenMasterSettings{},
                                                         plant.can_line(wire).bus().attach(now, std::move(node)));
        record.kind = WireRecord::Kind::kCanFrame;
        record.network = plant.file().can[wire].name;
        break;
      }
    }
    made->on_wire([this, record, name = drive.spec.name](const masters::WireFrame& frame) {
      if (!context_.on_wire) return;
      WireRecord r = record;
      r.at = frame.at;
      r.sender = frame.sent ? "master" : name;
      r.bytes = frame.bytes;
      r.connection = frame.connection;
      if (r.kind == WireRecord::Kind::kCanFrame) {
        r.id = read_be32(frame.bytes, 0);
        r.bytes.erase(r.bytes.begin(), r.bytes.begin() + 4);
        if (!frame.sent) r.sender = sender_of(r.id);
      }
      context_.on_wire(std::move(r));
    });
    return made;
  }

  // By the node in the predefined connection set.
  std::string sender_of(std::uint32_t id) const {
    for (const auto& d : context_.plant.drives())
      if (d->controller && d->can_node() == (id & 0x7f)) return d->spec.name;
    return "";
  }

  struct Wired {
    std::size_t drive = 0;  // for which it was made
    std::unique_ptr<masters::Station> station;
  };

  const Kind& kind_;
  MasterContext context_;
  std::map<std::size_t, Wired> stations_;  // by wire
};

}  // namespace

const std::vector<std::string_view>& master_words() {
  static const std::vector<std::string_view> all{"mode",  "run",       "stop",    "quick_stop",   "reference",
                                                 "reset", "parameter", "monitor", "clear_alarms", "silence"};
  return all;
}

// A serial line has one other end, which must not be taken from somebody without a word. Empty: none.
static std::string objection(const Kind& kind, const rig::Plant& plant) {
  if (kind.wire != Wire::kSerial) return {};
  for (const auto& d : plant.drives())
    if (d->spec.board && d->spec.board->serial && plant.serial_is_outside(*d->spec.board->serial))
      return "serial line " + plant.file().serial[*d->spec.board->serial].name +
             " is open to masters outside, as in every live run; speak via modbus_tcp, or run in virtual time";
  return {};
}

std::vector<MasterKind> protocol_masters() {
  std::vector<MasterKind> out;
  for (const Kind& kind : kKinds)
    out.push_back({kind.name, master_words(),
                   [&kind](const MasterContext& context) -> Result<std::unique_ptr<Master>, std::string> {
                     if (auto why = objection(kind, context.plant); !why.empty()) return Unexpected(std::move(why));
                     return std::unique_ptr<Master>(std::make_unique<ProtocolMaster>(kind, context));
                   }});
  return out;
}

}  // namespace vinv::scenario
