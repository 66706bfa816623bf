// Small stand-ins for inverter, board and wire, so that the rig is tested for what it does itself.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "motor_model/plant/power_plant.hpp"
#include "sim/rig/catalogue.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::rig::test {

// What happened, in order, for the whole plant.
using Journal = std::vector<std::string>;

class FakePort : public port::DrivePort {
 public:
  bool ready() const override { return true; }
  port::OperationMode operation_mode() const override { return mode; }
  port::Status status() const override { return {}; }
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned) const override { return std::uint16_t{0}; }
  Result<std::uint32_t, port::Refusal> read_parameter(port::ParameterId) const override { return 0u; }
  port::AlarmHistory alarm_history() const override { return {0xA3, 0x10}; }
  std::uint8_t active_alarm() const override { return 0; }
  port::WriteOutcome post_write(Instant, const port::WriteRequest&) override { return {}; }
  bool write_pending() const override { return false; }
  std::optional<port::WriteOutcome> take_outcome() override { return {}; }
  void set_communication_lost(bool) override {}
  void set_option_failed(bool) override {}

  port::OperationMode mode = port::OperationMode::kExternal;
};

class FakeInverter : public inverter::Inverter {
 public:
  FakeInverter(const inverter::InverterConfig& config, Journal& journal)
      : config_(config), journal_(journal), plant_(plant_config(config)) {
    for (const auto& [name, value] : config.factory_values) parameters_[name] = value;
  }

  void tick(Instant now) override {
    journal_.push_back(config_.model + " tick " + std::to_string(to_ns(now) / 1000000));
  }
  port::DrivePort& port() override { return port_; }
  std::string_view family() const override { return "fr-e500"; }
  std::string_view model() const override { return config_.model; }
  inverter::Outcome press_key(inverter::PanelKey key) override {
    journal_.push_back("key " + std::to_string(static_cast<int>(key)));
    if (key == inverter::PanelKey::kPuExt)
      port_.mode = port_.mode == port::OperationMode::kPu ? port::OperationMode::kExternal : port::OperationMode::kPu;
    return {};
  }
  inverter::Outcome set_panel_frequency(double hz) override {
    if (hz > 120) return Unexpected(std::string("the set frequency is above Pr.1; allowed: 0 to 120 Hz."));
    panel_hz = hz;
    return {};
  }
  std::string display() const override { return "0.00"; }
  inverter::Outcome set_terminal(std::string_view terminal, bool on) override {
    const auto it = terminals_.find(std::string(terminal));
    if (it == terminals_.end()) return Unexpected("there is no terminal " + std::string(terminal) + ".");
    it->second = on;
    return {};
  }
  inverter::Outcome set_analog(std::string_view terminal, double value) override {
    if (terminal != "2" && terminal != "4")
      return Unexpected("there is no analog terminal " + std::string(terminal) + ".");
    analog[std::string(terminal)] = value;
    return {};
  }
  std::vector<std::pair<std::string_view, bool>> terminals() const override {
    return {terminals_.begin(), terminals_.end()};
  }
  std::vector<std::string_view> analog_terminals() const override { return {"2", "4"}; }
  inverter::Outcome set_parameter(std::string_view name, double value) override {
    if (parameters_.find(name) == parameters_.end())
      return Unexpected("there is no parameter " + std::string(name) + ".");
    if (value > 3600) return Unexpected(std::string(name) + " allows 0 to 3600.");
    parameters_.find(name)->second = value;
    changed_ = true;
    return {};
  }
  Result<double, std::string> get_parameter(std::string_view name) const override {
    const auto it = parameters_.find(name);
    if (it == parameters_.end()) return Unexpected("there is no parameter " + std::string(name) + ".");
    return it->second;
  }
  inverter::Outcome preset_parameter(std::string_view name, double value) override {
    return set_parameter(name, value);
  }
  std::vector<inverter::ParameterInfo> parameters() const override {
    inverter::ParameterInfo p;
    p.id = {7, 0};
    p.name = "Acceleration time";
    p.unit = "s";
    p.factory_default = 5;
    return {p};
  }
  void set_power(bool on) override {
    powered_ = on;
    journal_.push_back(config_.model + (on ? " power on" : " power off"));
  }
  bool powered() const override { return powered_; }
  void set_mains(const plant::MainsState& mains) override { plant_.set_mains(mains), mains_now = mains; }
  void set_load(const plant::LoadSettings& load) override { plant_.set_load(load), load_now = load; }
  void set_shaft_locked(bool locked) override { shaft_locked = locked; }
  inverter::Outcome set_motor_source(plant::MotorSource source) override {
    if (source == plant::MotorSource::kTable) return Unexpected(std::string("there is no voltage table"));
    plant_.set_motor_source(source);
    return {};
  }
  void set_ambient(double celsius) override { ambient_c = celsius; }
  const plant::PowerPlant& plant() const override { return plant_; }
  inverter::Outcome inject_fault(std::string_view fault, bool on) override {
    faults[std::string(fault)] = on;
    return {};
  }
  std::vector<std::string_view> injectable_faults() const override { return {"E.PE", "earth_fault"}; }
  std::vector<inverter::SignalValue> signals() const override { return {{"output_frequency", 12.5, "Hz"}}; }
  std::string alarm_name() const override { return ""; }
  std::string alarm_cause() const override { return ""; }
  std::string eeprom_text() const override { return "Pr.7: " + std::to_string(parameters_.at("Pr.7")) + "\n"; }
  bool take_eeprom_changed() override { return std::exchange(changed_, false); }
  inverter::Outcome load_eeprom(std::string_view text) override {
    if (!text.starts_with("Pr.7: ")) return Unexpected(std::string("line 1: no parameter."));
    parameters_["Pr.7"] = std::stod(std::string(text.substr(6)));
    return {};
  }
  bool on_snapshot_grid() const override { return true; }

  double panel_hz = 0;
  double ambient_c = 25;
  bool shaft_locked = false;
  std::map<std::string, double> analog;
  std::map<std::string, bool> faults;
  plant::MainsState mains_now;
  plant::LoadSettings load_now;
  FakePort port_;

 private:
  void archive_state(Archive& a) override {
    a.must_match("inverter", config_.model);
    VINV_FIELDS(a, FakeInverter, port_.mode, panel_hz, ambient_c, shaft_locked, analog, faults, mains_now, load_now,
                plant_, parameters_, terminals_, powered_, changed_);
  }
  static plant::PlantConfig plant_config(const inverter::InverterConfig& config) {
    plant::PlantConfig p;
    p.machine = config.motor;
    p.load = config.load;
    if (config.mains) p.mains = *config.mains;
    return p;
  }
  inverter::InverterConfig config_;
  Journal& journal_;
  plant::PowerPlant plant_;
  bool powered_ = false;
  bool changed_ = false;
  std::map<std::string, bool> terminals_{{"RES", false}, {"RH", false}, {"STF", false}, {"STR", false}};
  std::map<std::string, double, std::less<>> parameters_{{"Pr.7", 5}, {"Pr.345", 63}, {"Pr.346", 132}, {"Pr.347", 4}};
};

// Answers each frame with one of the next identifier; needs power.
class FakeCan : public boards::CanChannel {
 public:
  std::uint32_t bit_rate() const override { return node_now == 0 ? 0 : rate; }
  std::uint8_t node() const override { return node_now; }
  void handle_frame(Instant, const CanFrame& frame) override {
    CanFrame answer = frame;
    ++answer.id;
    heard.push_back(frame);
    to_send.push_back(answer);
  }
  std::optional<CanFrame> poll_transmit(Instant) override {
    if (to_send.empty()) return {};
    const CanFrame out = to_send.front();
    to_send.erase(to_send.begin());
    return out;
  }
  void set_bus_off(Instant, bool off) override { bus_off.push_back(off); }

  std::uint32_t rate = 125'000;
  std::uint8_t node_now = 0;
  std::vector<CanFrame> heard;
  std::vector<CanFrame> to_send;
  std::vector<bool> bus_off;
};

// Answers each byte that it gets with the byte after it, 2 ms later; needs power.
class FakeBoard : public boards::OptionBoard, public boards::SerialChannel, public modbus::Unit {
 public:
  FakeBoard(unsigned node, Journal& journal) : node_(node), journal_(journal) {}
  std::string_view type() const override { return "oi-fr-e5nco"; }
  void handle_power(Instant, bool on) override {
    powered_ = on;
    can.node_now = static_cast<std::uint8_t>(on ? node_ : 0);
    journal_.push_back("board " + std::to_string(node_) + (on ? " power on" : " power off"));
  }
  void handle_drive_tick(Instant) override { ++drive_ticks; }
  void handle_timeout(Instant now) override {
    if (answer_at_ && now >= *answer_at_) {
      frames_.push_back(answer_);
      answer_at_.reset();
      answer_.clear();
    }
  }
  std::optional<Instant> next_deadline() const override { return answer_at_; }
  Result<void, std::string> set_switch(std::string_view name, unsigned value) override {
    if (name != "SW1") return Unexpected("there is no switch " + std::string(name) + "; allowed: SW1.");
    sw1 = value;
    return {};
  }
  modbus::Unit* modbus_unit() override { return this; }
  boards::SerialChannel* serial_channel() override { return this; }
  boards::CanChannel* can_channel() override { return &can; }
  std::string_view status_led() const override { return powered_ ? "green" : "off"; }

  boards::LineSettings line_settings() const override { return line; }
  void handle_bytes(Instant now, ByteView bytes, bool line_error) override {
    if (!powered_ || line_error) return;
    for (const std::uint8_t b : bytes) answer_.push_back(static_cast<std::uint8_t>(b + 1));
    answer_at_ = now + std::chrono::milliseconds(2);
  }
  std::optional<Bytes> poll_transmit(Instant) override {
    if (frames_.empty()) return {};
    Bytes out = frames_.front();
    frames_.erase(frames_.begin());
    return out;
  }

  // As a Modbus unit: echoes the request after the next tick of the drive.
  std::uint8_t address() const override { return powered_ ? static_cast<std::uint8_t>(node_) : 0; }
  void handle_request(Instant, modbus::ClientId client, modbus::Addressing, ByteView pdu) override {
    requests_[client] = {Bytes(pdu.begin(), pdu.end()), drive_ticks};
  }
  std::optional<Bytes> poll_answer(Instant, modbus::ClientId client) override {
    const auto it = requests_.find(client);
    if (it == requests_.end() || it->second.second == drive_ticks) return {};
    Bytes out = std::move(it->second.first);
    requests_.erase(it);
    return out;
  }
  void forget(modbus::ClientId client) override { requests_.erase(client); }

  FakeCan can;
  boards::LineSettings line;
  unsigned sw1 = 0;
  int drive_ticks = 0;

 private:
  void archive_state(Archive& a) override {
    VINV_FIELDS(a, FakeBoard, can.rate, can.node_now, can.to_send, line, sw1, drive_ticks, powered_, answer_,
                answer_at_, frames_, requests_);
  }
  unsigned node_;
  Journal& journal_;
  bool powered_ = false;
  Bytes answer_;
  std::optional<Instant> answer_at_;
  std::vector<Bytes> frames_;
  std::map<modbus::ClientId, std::pair<Bytes, int>> requests_;
};

inline Catalogue fake_catalogue(Journal& journal) {
  Catalogue c;
  c.families = [] { return std::vector<std::string_view>{"fr-e500"}; };
  c.models = [](std::string_view) {
    return std::vector<std::string_view>{"FR-E540-0.4K", "FR-E540-0.75K", "FR-E540-1.5K", "FR-E540-2.2K",
                                         "FR-E520-0.2K"};
  };
  c.board_types = [] { return std::vector<std::string_view>{"oi-fr-e5nco"}; };
  c.board_families = [](std::string_view) { return std::vector<std::string_view>{"fr-e500"}; };
  c.board_traits = [](std::string_view) {
    return boards::BoardTraits{.first_node = 1, .last_node = 99, .fieldbus = true};
  };
  c.make_inverter =
      [&journal](std::string_view,
                 const inverter::InverterConfig& config) -> Result<std::unique_ptr<inverter::Inverter>, std::string> {
    return std::unique_ptr<inverter::Inverter>(std::make_unique<FakeInverter>(config, journal));
  };
  c.make_board = [&journal](const boards::BoardConfig& config,
                            port::DrivePort&) -> Result<std::unique_ptr<boards::OptionBoard>, std::string> {
    if (config.node > 99) return Unexpected("node " + std::to_string(config.node) + "; allowed: 1 to 99.");
    return std::unique_ptr<boards::OptionBoard>(std::make_unique<FakeBoard>(config.node, journal));
  };
  return c;
}

// A wire whose other end is the test.
class FakeStream : public transports::ByteStream {
 public:
  struct Far {
    OnBytes on_bytes;
    OnClosed on_closed;
    std::vector<std::pair<Instant, Bytes>> sent;
    bool closed = false;
  };
  explicit FakeStream(std::shared_ptr<Far> far) : far_(std::move(far)) {}
  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    far_->on_bytes = std::move(on_bytes);
    far_->on_closed = std::move(on_closed);
  }
  void send(Instant now, ByteView bytes) override { far_->sent.push_back({now, Bytes(bytes.begin(), bytes.end())}); }
  void close() override { far_->closed = true; }
  std::string name() const override { return "test"; }

 private:
  std::shared_ptr<Far> far_;
};

}  // namespace vinv::rig::test
