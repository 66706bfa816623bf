// An EtherNet/IP scanner at one adapter, in virtual time: its TCP connection, its I/O port, the words of a drive
// engineer and the tasks of a scanner.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/masters/eip_scanner.hpp"
#include "sim/masters/eip_task.hpp"
#include "sim/masters/station.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_streams.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::masters {

struct EipStationSettings {
  EipScannerSettings scanner;
  IoWish wish;             // of the connection that a word opens when there is none
  Ipv4Endpoint adapter;    // its I/O port
  bool connected = false;  // explicit messages over a class 3 connection
  // After an explicit write the next one waits so long (FR-A7NE manual, 6.3).
  Duration write_gap = std::chrono::milliseconds(100);
};

class EipStation : public Station, private Access {
 public:
  // A new connection to the adapter's TCP port; nullptr: nobody listens.
  using Dial = std::function<std::unique_ptr<transports::ByteStream>(Instant now)>;
  // In WireFrame: of datagrams.
  static constexpr std::uint32_t kDatagrams = 0xffffffff;
  static constexpr Duration kRedialDelay = std::chrono::milliseconds(500);    // after a connection was lost or refused
  static constexpr Duration kPatience = std::chrono::seconds(5);              // for connections that come back
  static constexpr Duration kParameterTime = std::chrono::milliseconds(200);  // 126/176: at least, for a write

  // The scheduler outlives the station, and the net, which dial connects through. io: bound to the scanner's address.
  EipStation(kernel::Scheduler& scheduler, const EipStationSettings& settings, Dial dial,
             std::unique_ptr<transports::UdpPort> io, transports::MemoryStreams* net = nullptr);
  ~EipStation() override;

  // A whole encapsulation message.
  bool send_frame(Instant now, ByteView frame) override;

  // One at a time, and not while an order is under way.
  void begin_task(Instant now, const EipTask& task);
  std::optional<TaskOutcome> poll_task();

  // Of a station with a net, after the net and the network of its I/O port.
  void archive(Archive& a) override;

  const EipScanner& scanner() const { return scanner_; }
  const EipStationSettings& settings() const { return settings_; }

 private:
  // What an order's read or write waits for.
  enum class Wait : std::uint8_t { kNothing, kPace, kAnswer, kOpen, kReopen, kSent, kInput, kWritten };
  friend VINV_ENUM_RANGE(Wait, kNothing, kWritten);
  struct Doing {
    Wait wait = Wait::kNothing;
    bool write = false;
    Item item = 0;
    std::uint8_t size = 2;
    std::uint32_t raw = 0;
    std::optional<CipAskId> ask;
    std::uint64_t version = 0;  // of the image that must be sent
    std::uint64_t inputs = 0;   // packets that must have come
    Instant until{};            // kPace, kWritten
    Instant give_up_at{};       // kPace, kReopen
    VINV_ARCHIVE(Doing, wait, write, item, size, raw, ask, version, inputs, until, give_up_at);
  };
  struct State {
    std::optional<Instant> redial_at;
    bool producing = true;
    std::uint32_t group = 0;  // joined
    Instant write_free_at{};
    std::uint16_t kept_data = 0;  // of the output image, while a parameter takes its place
    Doing access;
    std::optional<Result<std::uint32_t, std::string>> access_result;
    std::optional<EipTask> task;
    std::optional<CipAskId> task_ask;
    std::uint64_t task_version = 0;
    Instant task_until{};
    std::optional<TaskOutcome> task_outcome;
    VINV_ARCHIVE(State, redial_at, producing, group, write_free_at, kept_data, access, access_result, task, task_ask,
                 task_version, task_until, task_outcome);
  };

  WordRunner& runner() override { return runner_; }
  std::optional<Instant> work(Instant now) override;
  void connect(Instant now);
  void listen();
  void disconnect(Instant now);
  void transmit(Instant now, ByteView frame);
  std::uint32_t connection() const { return stream_ != nullptr ? stream_->end_number() / 2 : 0; }
  void follow_group();
  void take_results(Instant now);
  bool advance_access(Instant now);
  bool advance_task(Instant now);
  void begin_access(Instant now, bool write, Item item, std::uint8_t size, std::uint32_t raw);
  void on_open();
  void on_sent(Instant now);
  void on_input();
  void ask(Instant now);
  void done(Result<std::uint32_t, std::string> result);
  void task_done(TaskOutcome outcome);
  void send_image() { state_.access.version = scanner_.changed(); }

  void begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t size) override;
  std::optional<Result<std::uint32_t, std::string>> poll_access() override;
  void command(Instant now, std::uint8_t node, std::uint32_t command) override;
  void set_output(std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void send_output(Instant now, std::uint8_t node, Item item) override;
  std::string name_of(Item item) const override;

  EipStationSettings settings_;
  EipScanner scanner_;
  Dial dial_;
  std::unique_ptr<transports::UdpPort> io_;
  transports::MemoryStreams* net_;
  std::unique_ptr<transports::ByteStream> stream_;
  WordRunner runner_;
  State state_;
};

}  // namespace vinv::masters
