// An slcan adapter on a bus with time: any text in any pieces, good commands, wrong bit rates, traffic of another node,
// errors on the bus. Whatever comes, each line has exactly one answer, of Lawicel's kinds; frames reach the client as
// they were on the wire and in order; and in the end the channel can be opened and passes frames both ways.
#include "sim/transports/can/slcan_adapter.hpp"
#include "tests/fuzz/can_client_bench.hpp"

using namespace std::chrono_literals;
using vinv::CanFrame;
using vinv::Duration;
using namespace vinv::transports;

namespace {

bool is_answer(std::string_view line) {
  if (line.empty() || line == "\a" || line == "z" || line == "Z" || line == "V1013" || line == "v0100" ||
      line == "NVINV") {
    return true;
  }
  return line.size() == 3 && line[0] == 'F';
}

struct Adapter : vinv::fuzz::CanClientBench {
  Adapter() : adapter(*bus, connect(), nullptr) {}

  void tell(std::string_view text) {
    lines_said += static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return c == '\r' || c == '\a'; }));
    say(text);
  }
  void check_heard() const {
    std::vector<CanFrame> frames;
    std::size_t answers = 0;
    SlcanLines lines;
    const vinv::ByteView all(reinterpret_cast<const std::uint8_t*>(heard.data()), heard.size());
    lines.feed(all, [&](std::string_view line) {
      if (const auto frame = parse_slcan_frame(line, true)) return frames.push_back(*frame);
      VINV_CHECK(is_answer(line));
      ++answers;
    });
    VINV_CHECK(!closed);
    VINV_CHECK(answers == lines_said);
    VINV_CHECK(vinv::fuzz::is_in_order_within(frames, sent_by_other));
  }

  SlcanAdapter adapter;
  std::size_t lines_said = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  Adapter bench;
  constexpr const char* kCommands[] = {"O\r", "C\r",         "L\r",         "S6\r", "S8\r",    "s031C\r",
                                       "F\r", "V\r",         "v\r",         "N\r",  "Z1\r",    "Z0\r",
                                       "\r",  "M00000000\r", "mFFFFFFFF\r", "X1\r", "t1230\r", "r701",
                                       "T",   "\r\n",        "s0000\r",     "S4\r", "\a",      "Q1\r"};
  bench.play(
      input, [&](std::string_view text) { bench.tell(text); }, kCommands,
      [](const CanFrame& frame) { return slcan_frame(frame) + "\r"; }, [&](std::uint8_t) { bench.tell("C\rS6\rO\r"); });
  bench.tell("\rC\rS6\rZ0\rO\r");
  bench.run_for(300ms);
  bench.check_heard();
  VINV_CHECK(bench.adapter.is_open());

  bench.heard.clear();
  bench.heard_by_other.clear();
  bench.tell("t0072010A\r");
  bench.run_for(5ms);
  VINV_CHECK(bench.heard == "z\r");
  VINV_CHECK(bench.heard_by_other.size() == 1 && bench.heard_by_other[0] == CanFrame::standard(7, {1, 10}));
  bench.other->send(bench.scheduler.now(), CanFrame::remote_request(0x701, 1));
  bench.run_for(5ms);
  VINV_CHECK(bench.heard == "z\rr7011\r");
  return 0;
}
