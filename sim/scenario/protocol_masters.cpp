#include "sim/scenario/protocol_masters.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "option_boards/ethernet_ip/encapsulation.hpp"
#include "sim/base/check.hpp"
#include "sim/masters/canopen_station.hpp"
#include "sim/masters/eip_station.hpp"
#include "sim/masters/modbus_station.hpp"
#include "sim/scenario/master_words.hpp"
#include "sim/scenario/scanner_words.hpp"
#include "sim/scenario/units.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::scenario {
namespace {

using masters::Word;
using rig::Json;

enum class Wire : std::uint8_t { kSerial, kTcp, kCan, kEthernet };

struct Kind {
  std::string_view name;     // in `via:`
  std::string_view profile;  // protocol of the board profile
  Wire wire;
  bool connected = false;  // kEthernet: explicit messages over a class 3 connection
};
constexpr Kind kKinds[] = {{"modbus", "modbus", Wire::kSerial},
                           {"modbus_tcp", "modbus", Wire::kTcp},
                           {"canopen", "canopen", Wire::kCan},
                           {"canopen_sdo", "canopen-sdo", Wire::kCan},
                           {"canopen_402", "canopen-402", Wire::kCan},
                           {"ethernet-ip", "ethernet-ip", Wire::kEthernet},
                           {"ethernet-ip-second", "ethernet-ip", Wire::kEthernet},
                           {"ethernet-ip-20", "ethernet-ip-20", Wire::kEthernet},
                           {"ethernet-ip-126", "ethernet-ip-126", Wire::kEthernet},
                           {"ethernet-ip-129", "ethernet-ip-129", Wire::kEthernet},
                           {"ethernet-ip-explicit", "ethernet-ip-explicit", Wire::kEthernet},
                           {"ethernet-ip-class3", "ethernet-ip-explicit", Wire::kEthernet, true}};

constexpr unsigned kAddressTries = 40;
constexpr Duration kTcpDelay = std::chrono::microseconds(100);  // of a local network

// Its number among those of its sort; Ethernet has one for each drive, with the given number.
std::optional<std::size_t> wire_of(Wire wire, const rig::DriveUnit& drive, std::optional<std::size_t> ethernet) {
  const auto& board = drive.spec.board;
  if (!board) return std::nullopt;
  switch (wire) {
    case Wire::kSerial: return board->serial;
    case Wire::kTcp: return board->tcp;
    case Wire::kCan: return drive.controller ? board->can : std::nullopt;
    case Wire::kEthernet: return ethernet;
  }
  return std::nullopt;
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
  std::vector<SaidOrder> orders_;  // still to be done
  bool task_ = false;              // a scanner's is under way
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

  std::vector<std::string_view> words() const override {
    return kind_.wire == Wire::kEthernet ? master_words() : common_master_words();
  }

  void begin(Instant now, std::size_t drive, std::string_view word, const Json& value) override {
    outcome_.reset();
    orders_.clear();
    task_ = false;
    readings_ = nullptr;
    drive_ = context_.plant.drives()[drive].get();
    station_ = station_of(now, *drive_);
    if (station_ == nullptr) return;
    profile_ = masters::find_profile(drive_->spec.board->type.value, kind_.profile);
    if (profile_ == nullptr) {
      outcome_ = Unexpected("nobody has said how board " + drive_->spec.board->type.value + " is spoken to over " +
                            std::string(kind_.profile));
      return;
    }
    auto said = read_master_word(*profile_, word, value);
    if (!said) {
      outcome_ = Unexpected(said.error());
      return;
    }
    if (said->silence) return silence(now, *said->silence);
    if (said->task) {
      task_ = true;
      return static_cast<masters::EipStation*>(station_)->begin_task(now, *said->task);
    }
    orders_ = std::move(said->orders);
    for (SaidOrder& o : orders_) address(o.order);
    next(now);
  }

  std::optional<Outcome> poll(Instant now) override {
    if (task_ && !outcome_) {
      const auto done = static_cast<masters::EipStation*>(station_)->poll_task();
      if (!done) return std::nullopt;
      task_ = false;
      outcome_ = *done ? Outcome(Json(**done)) : Outcome(Unexpected(done->error()));
    }
    while (!outcome_ && station_ != nullptr) {
      const auto done = station_->poll();
      if (!done) return std::nullopt;
      if (!*done) {
        outcome_ = Unexpected(done->error());
        break;
      }
      const SaidOrder& said = orders_.front();
      const double value = (*done)->value;
      if (said.range && !(value >= said.range->low && value <= said.range->high)) {
        outcome_ = Unexpected("monitor " + said.name + " shows " + show_value(value, (*done)->unit) + ", not " +
                              said.range->text);
        break;
      }
      if (said.order.word == Word::kReadParameter || said.order.word == Word::kMonitor) readings_[said.name] = value;
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
    VINV_MEMBERS(static_cast<State&>(*this), station, drive, profile, orders, task, readings, outcome);
    // By what they are found by.
    std::optional<std::size_t> wire, spoken_to;
    for (const auto& [number, wired] : stations_)
      if (wired.station.get() == station) wire = number;
    for (std::size_t i = 0; i < drives.size(); ++i)
      if (drives[i].get() == drive) spoken_to = i;
    VINV_FIELDS(a, ProtocolMaster, wire, spoken_to, orders, task);
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
    a.require(!task || (station != nullptr && kind_.wire == Wire::kEthernet), "a master has a task for nobody");
  }

 private:
  void silence(Instant now, bool on) {
    for (const auto& [wire, wired] : stations_) wired.station->set_silent(now, on);
    outcome_ = Json(on ? "on" : "off");
  }

  void next(Instant now) {
    if (orders_.empty()) {
      outcome_ = readings_;
      return;
    }
    station_->begin(now, *profile_, orders_.front().order);
  }

  // What the drive adds to an order. One that the family does not have is the board's to refuse.
  void address(masters::Order& o) const {
    o.node = static_cast<std::uint8_t>(kind_.wire == Wire::kCan        ? drive_->can_node()
                                       : kind_.wire == Wire::kEthernet ? 1
                                                                       : drive_->unit());
    if (o.word != Word::kReadParameter && o.word != Word::kWriteParameter) return;
    for (const inverter::ParameterInfo& p : drive_->inverter->parameters()) {
      if (p.id.number != o.parameter || (p.id.sub != o.sub && o.sub != 0)) continue;
      o.increment = p.increment;
      return;
    }
  }

  // nullptr and an outcome: the drive has no such wire.
  masters::Station* station_of(Instant now, const rig::DriveUnit& drive) {
    const auto wire = wire_of(kind_.wire, drive, ethernet_of(drive));
    if (!wire) {
      outcome_ = Unexpected(drive.spec.name + " is on no wire of the master " + std::string(kind_.name));
      return nullptr;
    }
    if (const auto known = stations_.find(*wire); known != stations_.end()) return known->second.station.get();
    auto made = make(now, drive, *wire);
    if (!made) {
      outcome_ = Unexpected(made.error());
      return nullptr;
    }
    return (stations_[*wire] = {index_of(drive), std::move(*made)}).station.get();
  }

  std::size_t index_of(const rig::DriveUnit& drive) const {
    const auto& all = context_.plant.drives();
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& d) { return d.get() == &drive; });
    return static_cast<std::size_t>(at - all.begin());
  }
  // A scanner for each adapter.
  std::optional<std::size_t> ethernet_of(const rig::DriveUnit& drive) const {
    return drive.ethernet != nullptr ? std::optional(index_of(drive)) : std::nullopt;
  }

  using Made = Result<std::unique_ptr<masters::Station>, std::string>;

  Made make(Instant now, const rig::DriveUnit& drive, std::size_t wire) {
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
      case Wire::kEthernet: {
        auto at = scanner(drive, wire);
        if (!at) return at;
        made = std::move(*at);
        record.kind = WireRecord::Kind::kTcp;
        record.network =
            ipv4_text(drive.spec.board->ethernet->address) + ":" + std::to_string(ethernet_ip::kEncapsulationPort);
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
      if (kind_.wire == Wire::kEthernet && frame.connection == masters::EipStation::kDatagrams) {
        r.kind = WireRecord::Kind::kUdp;
        r.connection = 0;
      }
      if (r.kind == WireRecord::Kind::kCanFrame) {
        r.id = read_be32(frame.bytes, 0);
        r.bytes.erase(r.bytes.begin(), r.bytes.begin() + 4);
        if (!frame.sent) r.sender = sender_of(r.id);
      }
      context_.on_wire(std::move(r));
    });
    return made;
  }

  // A scanner has an address of its own for each adapter: both use UDP 2222.
  Made scanner(const rig::DriveUnit& drive, std::size_t number) {
    rig::Plant& plant = context_.plant;
    const auto kind = static_cast<unsigned>(&kind_ - kKinds);
    std::uint32_t own = ipv4(127, 200 + kind, 1 + static_cast<unsigned>(number / 250), 1 + number % 250);
    auto io = open_udp({own, ethernet_ip::kIoPort});
    // On this machine others may have it: a run beside this one.
    for (unsigned tries = 1; !io && context_.open_udp && tries < kAddressTries; ++tries)
      io = open_udp({own = own + ipv4(0, 0, 5, 0), ethernet_ip::kIoPort});
    if (!io) return Unexpected("the scanner has no address of its own: " + io.error());
    const std::uint32_t adapter = drive.spec.board->ethernet->address;
    masters::EipStationSettings settings;
    settings.scanner.originator_serial = kind + 1;
    settings.adapter = {adapter, ethernet_ip::kIoPort};
    settings.connected = kind_.connected;
    if (const auto* profile = masters::find_profile(drive.spec.board->type.value, kind_.profile)) {
      settings.wish.output_point = profile->io.output_point;
      settings.wish.input_point = profile->io.input_point;
      settings.wish.output_size = profile->io.output_size;
      settings.wish.input_size = profile->io.input_size;
    }
    constexpr std::uint16_t kFirstPort = 50000;
    return std::unique_ptr<masters::Station>(std::make_unique<masters::EipStation>(
        plant.scheduler(), settings,
        [&plant, own, adapter](Instant at) {
          return plant.connect_tcp(at, {own, kFirstPort}, {adapter, ethernet_ip::kEncapsulationPort},
                                   {.delay = kTcpDelay});
        },
        std::move(*io), &plant.streams()));
  }
  Result<std::unique_ptr<transports::UdpPort>, std::string> open_udp(const Ipv4Endpoint& own) {
    return context_.open_udp ? context_.open_udp(own) : context_.plant.datagrams().open(own);
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
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> out = common_master_words();
    out.insert(out.end(), scanner_words().begin(), scanner_words().end());
    return out;
  }();
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
    out.push_back(
        {kind.name, kind.wire == Wire::kEthernet ? master_words() : common_master_words(),
         [&kind](const MasterContext& context) -> Result<std::unique_ptr<Master>, std::string> {
           if (auto why = objection(kind, context.plant); !why.empty()) return Unexpected(std::move(why));
           return std::unique_ptr<Master>(std::make_unique<ProtocolMaster>(kind, context));
         },
         [&kind](std::string_view word, const Json& value) -> std::string {
           for (const masters::BoardProfile& profile : masters::profiles()) {
             if (profile.protocol != kind.profile) continue;
             const auto said = read_master_word(profile, word, value);
             return said ? std::string() : said.error();
           }
           return {};
         },
         [&kind](const rig::DriveUnit& drive) {
           return wire_of(kind.wire, drive, drive.ethernet ? std::optional<std::size_t>(0) : std::nullopt).has_value();
         }});
  return out;
}

}  // namespace vinv::scenario
