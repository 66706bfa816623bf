// A CAN bus with time: frames of every kind for and around this node, good SDO requests, silence, slow decisions,
// alarms, lost supply. Whatever comes, what the board sends are frames that a CANopen slave may send, a request has at
// most one answer, and in the end it answers a good request.
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/canopen/can_text.hpp"
#include "tests/option_boards/support/bench.hpp"

using namespace std::chrono_literals;
using vinv::CanFrame;
using vinv::Duration;
using vinv::test::can;

namespace {

constexpr std::uint8_t kNode = 25;
constexpr int kMaxOperations = 300;

void check_sent(const std::vector<vinv::test::Bench::SentFrame>& frames, std::size_t sdo_requests) {
  std::size_t sdo_answers = 0;
  for (const auto& [at, frame] : frames) {
    VINV_CHECK(!frame.remote && !frame.extended && frame.length <= 8);
    VINV_CHECK(frame.id != 0 && frame.id <= 0x7ff);
    if (frame.id == 0x580u + kNode) {
      ++sdo_answers;
      const std::uint8_t command = frame.data[0];
      VINV_CHECK(frame.length == 8);
      VINV_CHECK(command == 0x80 || command == 0x60 || command == 0x43 || command == 0x4b || command == 0x4f);
    }
    if (frame.id == 0x700u + kNode) {
      VINV_CHECK(frame.length == 1);
      const unsigned state = frame.data[0] & 0x7fu;
      VINV_CHECK(frame.data[0] == 0 || state == 4 || state == 5 || state == 127);
    }
  }
  VINV_CHECK(sdo_answers <= sdo_requests);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  vinv::test::Bench bench;
  bench.drive.parameters[180] = {3, 0, 18};
  bench.power_on();
  // Services that anything may move to other COB-IDs.
  constexpr std::uint32_t kIds[] = {0x000, 0x080, 0x099, 0x199, 0x219, 0x299, 0x319, 0x399,
                                    0x419, 0x499, 0x519, 0x599, 0x619, 0x719, 0x100, 0x7e5};
  constexpr std::uint16_t kObjects[] = {0x1005, 0x1014, 0x100c, 0x100d, 0x1400, 0x1401, 0x1600, 0x1601,
                                        0x1800, 0x1801, 0x1a00, 0x1a01, 0x4000, 0x4001, 0x6040, 0x6042,
                                        0x6007, 0x3007, 0x2107, 0x1011, 0x6048, 0x0006, 0x3386, 0x2000};
  bool on = true;
  std::size_t sdo_requests = 0;
  for (int i = 0; i < kMaxOperations && !input.empty(); ++i) {
    const std::uint8_t operation = input.byte();
    const std::uint8_t argument = operation >> 3;
    switch (operation & 7) {
      case 0:
      case 1: {  // any frame
        CanFrame frame;
        frame.id = (operation & 1) != 0 ? input.word() & 0x7ffu : kIds[argument & 15];
        frame.remote = (argument & 16) != 0;
        frame.length = static_cast<std::uint8_t>(input.byte() % 9);
        const vinv::Bytes bytes = input.chunk(frame.length);
        std::copy(bytes.begin(), bytes.end(), frame.data.begin());
        sdo_requests += frame.id == 0x600u + kNode ? 1 : 0;
        bench.receive_frame(frame);
        break;
      }
      case 2:
      case 3: {  // an SDO request for an object that matters
        const std::uint16_t index = kObjects[argument % std::size(kObjects)];
        const std::uint8_t command = (operation & 1) != 0 ? std::uint8_t{0x22} : input.byte();
        const auto sub = static_cast<std::uint8_t>(input.byte() & 7);
        CanFrame frame = CanFrame::standard(
            0x600u + kNode, {command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub});
        const vinv::Bytes value = input.chunk(4);
        std::copy(value.begin(), value.end(), frame.data.begin() + 4);
        frame.length = 8;
        ++sdo_requests;
        bench.receive_frame(frame);
        break;
      }
      case 4: bench.advance(Duration(200us) * (argument + 1)); break;
      case 5: {  // NMT
        constexpr std::uint8_t kCommands[] = {1, 2, 128, 129, 130, 1, 1, 128};
        bench.receive_frame(CanFrame::standard(0, {kCommands[argument & 7], kNode}));
        break;
      }
      case 6:
        bench.drive.ticks_to_decide = argument & 15;
        bench.drive.status_now.running = (argument & 16) != 0;
        bench.drive.status_now.alarm = (argument & 8) != 0;
        bench.drive.history[0] = static_cast<std::uint8_t>(input.byte());
        bench.drive.monitors[1] = input.word();
        break;
      default:
        on = argument == 0 ? !on : on;
        bench.board->handle_power(bench.now, on);
        if (!on) bench.drive.lose_mailbox();
        bench.drive.mode = (argument & 1) != 0 ? vinv::port::OperationMode::kNetwork : vinv::port::OperationMode::kPu;
        break;
    }
  }
  check_sent(bench.frames, sdo_requests);

  // A fault-free end: supply on, the inverter through its reset, PRE-OPERATIONAL.
  bench.drive.ticks_to_decide = 1;
  bench.drive.status_now = {};
  bench.board->handle_power(bench.now, true);
  bench.advance(300ms);
  if (bench.bus().node() != kNode) return 0;  // Pr.345 may have been rewritten and the supply cycled
  bench.receive_frame(can("000#8219"));
  bench.advance(5ms);
  bench.frames.clear();
  bench.receive_frame(can("619#4000100000000000"));
  VINV_CHECK(bench.frames.size() == 1);
  VINV_CHECK(bench.frames[0].frame == can("599#4300100092010100"));
  return 0;
}
