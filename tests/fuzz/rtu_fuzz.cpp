// The serial line with time: chunks, silences, line errors, good frames, slow decisions, lost supply. Whatever comes,
// what the board sends are sound frames of its own, and after silence it answers a good request.
// Input: Pr.347, then operations.
#include "option_boards/modbus/crc16.hpp"
#include "tests/fuzz/answer_check.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/support/bench.hpp"

using namespace std::chrono_literals;
using vinv::append_be16;
using vinv::append_le16;
using vinv::Bytes;
using vinv::ByteView;
using vinv::Duration;
namespace modbus = vinv::modbus;

namespace {

constexpr std::uint8_t kNode = 25;
constexpr int kMaxOperations = 200;

Bytes framed(Bytes bytes) {
  append_le16(bytes, modbus::crc16(bytes));
  return bytes;
}

void check_sent(const std::vector<vinv::test::Bench::Sent>& sent) {
  for (const auto& [at, bytes] : sent) {
    VINV_CHECK(bytes.size() >= 5 && bytes.size() <= 256);
    VINV_CHECK(modbus::crc16(bytes) == 0 && bytes[0] == kNode);
    const std::uint8_t function = bytes[1];
    VINV_CHECK(function == 3 || function == 6 || function >= 0x80);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  vinv::test::Bench bench;
  bench.drive.parameters[347].value = input.byte();
  bench.power_on();
  std::size_t frames_begun = 0;
  bool on = true;
  for (int i = 0; i < kMaxOperations && !input.empty(); ++i) {
    const std::uint8_t operation = input.byte();
    const std::uint8_t argument = operation >> 3;
    switch (operation & 7) {
      case 0:  // a chunk as it is
        bench.receive(input.chunk(argument + 1u));
        ++frames_begun;
        break;
      case 1:  // silence in steps of 200 us
        bench.advance(Duration(200us) * (argument + 1));
        break;
      case 2:  // long silence
        bench.advance(Duration(10ms) * (argument + 1));
        break;
      case 3: {  // a frame for this node with a good CRC
        const Bytes pdu = input.chunk(argument + 1u);
        Bytes frame{kNode};
        frame.insert(frame.end(), pdu.begin(), pdu.end());
        bench.receive(framed(frame));
        ++frames_begun;
        break;
      }
      case 4: {  // a request of function 03 or 06, for this node or everybody, and the time for its answer
        const std::uint16_t address = input.word(), value = input.word();
        Bytes frame{(argument & 1) != 0 ? std::uint8_t{0} : kNode,
                    (argument & 2) != 0 ? std::uint8_t{6} : std::uint8_t{3}};
        append_be16(frame, static_cast<std::uint16_t>(20000 + address % 7100));
        append_be16(frame, value);
        bench.receive(framed(frame));
        ++frames_begun;
        bench.advance(20ms);
        break;
      }
      case 5:
        bench.receive(input.chunk(argument), true);
        ++frames_begun;
        break;
      case 6:
        bench.drive.ticks_to_decide = argument;
        bench.drive.mode =
            (argument & 1) != 0 ? vinv::port::OperationMode::kNetwork : vinv::port::OperationMode::kExternal;
        break;
      default:
        on = argument == 0 ? !on : on;
        bench.board->handle_power(bench.now, on);
        if (!on) bench.drive.lose_mailbox();
        break;
    }
    VINV_CHECK(bench.sent.size() <= frames_begun);
  }
  check_sent(bench.sent);

  // A fault-free end: supply on, the inverter through its reset, 200 ms of silence.
  bench.board->handle_power(bench.now, true);
  bench.advance(300ms);
  bench.sent.clear();
  bench.receive(framed({kNode, 0x03, 0x69, 0x78, 0x00, 0x01}));
  bench.advance(50ms);
  // Pr.345 may have been rewritten and the supply cycled: then the board has another address.
  if (bench.unit().address() == kNode) {
    VINV_CHECK(bench.sent.size() == 1);
    VINV_CHECK(bench.sent[0].bytes == framed({kNode, 0x03, 0x02, 0x10, 0x42}));
  } else {
    VINV_CHECK(bench.sent.empty());
  }
  return 0;
}
