// A Modbus master on a serial line or a TCP connection, in virtual time.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "sim/masters/modbus_master.hpp"
#include "sim/masters/station.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_streams.hpp"

namespace vinv::masters {

class ModbusStation : public Station, private Access {
 public:
  // A new connection; nullptr: nobody listens.
  using Dial = std::function<std::unique_ptr<transports::ByteStream>(Instant now)>;
  // After a connection was lost or refused.
  static constexpr Duration kRedialDelay = std::chrono::milliseconds(500);

  // The scheduler outlives the station. A serial line is dialled once and never lost. A TCP connection is dialled
  // again when it was closed, or when a request on it got no answer, as a half-open one must be.
  // net: what dial connects through, for snapshots; it outlives the station.
  ModbusStation(kernel::Scheduler& scheduler, const ModbusMasterSettings& settings, Dial dial,
                transports::MemoryStreams* net = nullptr);
  ~ModbusStation() override;

  bool send_frame(Instant now, ByteView frame) override;

  // Requests and cyclic reads of one's own; their results wait here.
  std::optional<ModbusRequestId> submit(Instant now, ModbusRequest request);
  std::optional<std::size_t> add_cycle(Instant now, ModbusRequest request, Duration interval);
  std::vector<ModbusResult> take_results();

  // Of a station with a net, after the net and the other ends' owners.
  void archive(Archive& a) override;

  bool connected() const { return master_.connected(); }
  const ModbusMaster& master() const { return master_; }

 private:
  WordRunner& runner() override { return runner_; }
  std::optional<Instant> work(Instant now) override;
  void connect(Instant now);
  void listen();
  std::uint32_t connection() const;
  void disconnect(Instant now);
  void transmit(Instant now, ByteView frame);

  void begin_write(Instant now, std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void begin_read(Instant now, std::uint8_t node, Item item, std::uint8_t size) override;
  std::optional<Result<std::uint32_t, std::string>> poll_access() override;
  void command(Instant now, std::uint8_t node, std::uint32_t command) override;
  void set_output(std::uint8_t node, Item item, std::uint8_t size, std::uint32_t raw) override;
  void send_output(Instant now, std::uint8_t node, Item item) override;
  std::string name_of(Item item) const override;
  void ask(Instant now, ModbusRequest request);

  ModbusMaster master_;
  Dial dial_;
  transports::MemoryStreams* net_;
  std::unique_ptr<transports::ByteStream> stream_;
  WordRunner runner_;
  struct State {
    std::optional<Instant> redial_at;
    std::optional<ModbusRequestId> access;  // under way
    std::optional<Result<std::uint32_t, std::string>> access_result;
    std::vector<ModbusResult> results;
    VINV_ARCHIVE(State, redial_at, access, access_result, results);
  } state_;
};

}  // namespace vinv::masters
