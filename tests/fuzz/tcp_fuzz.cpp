// Modbus/TCP: three connections to two boards behind one port; streams in any pieces, floods, lost supply, lost
// connections. Whatever comes, answers are well-formed ADUs to requests that were made, and a new connection is served.
// Input: operations.
#include <array>
#include <deque>
#include <memory>

#include "option_boards/modbus/tcp_session.hpp"
#include "tests/fuzz/answer_check.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/support/bench.hpp"

using namespace std::chrono_literals;
using vinv::append_be16;
using vinv::Bytes;
using vinv::ByteView;
using vinv::read_be16;
using vinv::modbus::TcpSession;
namespace modbus = vinv::modbus;

namespace {

constexpr int kMaxOperations = 200;

// One connection and what it may still expect.
struct Connection {
  std::unique_ptr<TcpSession> session;
  std::size_t bytes_in = 0, adus_out = 0;
  modbus::ClientId id = 0;

  void open(modbus::ClientId client, modbus::UnitRouter& router) {
    session = std::make_unique<TcpSession>(client, router);
    bytes_in = adus_out = 0;
    id = client;
  }
  void drain(vinv::Instant now) {
    while (const auto adu = session->poll_transmit(now)) {
      VINV_CHECK(adu->size() >= 9 && adu->size() <= TcpSession::kMaxAdu);
      VINV_CHECK(read_be16(*adu, 2) == 0 && read_be16(*adu, 4) == adu->size() - 6);
      const std::uint8_t function = (*adu)[7];
      VINV_CHECK(function == 3 || function == 6 || (function >= 0x80 && adu->size() == 9));
      ++adus_out;
      VINV_CHECK(adus_out * 8 <= bytes_in);  // the shortest request has 8 bytes
    }
  }
};

Bytes adu(std::uint16_t transaction, std::uint8_t unit, ByteView pdu) {
  Bytes out;
  append_be16(out, transaction);
  append_be16(out, 0);
  append_be16(out, static_cast<std::uint16_t>(pdu.size() + 1));
  out.push_back(unit);
  out.insert(out.end(), pdu.begin(), pdu.end());
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  std::array<vinv::test::Bench, 2> benches;
  benches[1].drive.parameters[345].value = 26;
  modbus::UnitTable table;
  for (auto& bench : benches) {
    bench.power_on();
    table.add(bench.unit());
  }
  modbus::ClientId next_client = 0;
  std::array<Connection, 3> connections;
  for (auto& connection : connections) connection.open(next_client++, table);

  const auto pass = [&](vinv::Duration by) {
    for (vinv::Duration passed{}; passed < by; passed += vinv::test::Bench::kTick) {
      for (auto& bench : benches) bench.advance(vinv::test::Bench::kTick);
      for (auto& connection : connections) connection.drain(benches[0].now);
    }
  };
  const auto send = [&](Connection& connection, const Bytes& bytes) {
    connection.bytes_in += bytes.size();
    connection.session->handle_bytes(benches[0].now, bytes);
  };
  std::array<bool, 2> on{true, true};
  for (int i = 0; i < kMaxOperations && !input.empty(); ++i) {
    const std::uint8_t operation = input.byte();
    const std::uint8_t argument = operation >> 3;
    Connection& connection = connections[argument % connections.size()];
    switch (operation & 7) {
      case 0: send(connection, input.chunk(input.byte())); break;
      case 1: pass(1ms); break;
      case 2: {  // a whole request of any PDU
        const auto transaction = input.word();
        send(connection, adu(transaction, 25 + (argument & 1), input.chunk(1u + input.byte() % modbus::kMaxPdu)));
        break;
      }
      case 3: {  // up to 32 pipelined writes in one piece
        Bytes stream;
        for (int n = 0; n <= argument; ++n) {
          const Bytes pdu{6, 0x5d, 0xc2, 0, static_cast<std::uint8_t>(n)};
          const Bytes one = adu(static_cast<std::uint16_t>(n), 25, pdu);
          stream.insert(stream.end(), one.begin(), one.end());
        }
        send(connection, stream);
        break;
      }
      case 4: connection.drain(benches[0].now); break;
      case 5: connection.open(next_client++, table); break;
      case 6:
        benches[argument % 2].drive.ticks_to_decide = argument;
        benches[argument % 2].drive.mode =
            (argument & 2) != 0 ? vinv::port::OperationMode::kNetwork : vinv::port::OperationMode::kExternal;
        break;
      default: {
        const std::size_t which = argument % 2;
        on[which] = !on[which];
        if (!on[which]) benches[which].drive.lose_mailbox();
        benches[which].board->handle_power(benches[which].now, on[which]);
        break;
      }
    }
    if (connection.session->close_requested()) {
      connection.drain(benches[0].now);
      connection.open(next_client++, table);
    }
  }

  // A fault-free end: everybody answered, and a new connection is served.
  for (auto& bench : benches) {
    bench.board->handle_power(bench.now, true);
    bench.drive.ticks_to_decide = 1;
  }
  pass(500ms);
  for (auto& connection : connections) VINV_CHECK(!connection.session->awaiting_answer());
  for (auto& bench : benches) {
    const std::uint8_t node = bench.unit().address();
    if (node == 0) continue;
    TcpSession fresh(next_client++, table);
    const Bytes request = adu(0x1234, node, Bytes{3, 0x69, 0x78, 0, 1});
    fresh.handle_bytes(bench.now, request);
    VINV_CHECK(fresh.poll_transmit(bench.now) == adu(0x1234, node, Bytes{3, 2, 0x10, 0x42}));
  }
  return 0;
}
