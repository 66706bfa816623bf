// A socketcand session on a bus with time: any text in any pieces, good messages, traffic of another node, errors on
// the bus, clients that come and go. Whatever comes, the session says only messages of the protocol, frames reach its
// client as they were on the wire and in order, and in the end it answers an echo and serves the next client.
#include "sim/transports/can/socketcand_session.hpp"
#include "tests/fuzz/can_client_bench.hpp"

using namespace std::chrono_literals;
using vinv::CanFrame;
using vinv::Duration;
using namespace vinv::transports;

namespace {

struct Session : vinv::fuzz::CanClientBench {
  Session() {
    options.buses = {{"can0", bus.get()}, {"can1", bus.get()}};
    restart();
  }
  void restart() {
    check_heard();
    session.reset();
    ended = false;
    session = std::make_unique<SocketcandSession>(scheduler, scheduler.now(), options, connect(), [this] {
      VINV_CHECK(!ended);
      ended = true;
    });
    scheduler.run_until(scheduler.now());
    VINV_CHECK(heard == "< hi >");
    first_frame = sent_by_other.size();
  }
  void check_heard() const {
    std::vector<CanFrame> frames;
    SocketcandMessages messages;
    const vinv::ByteView all(reinterpret_cast<const std::uint8_t*>(heard.data()), heard.size());
    messages.feed(all, [&](std::string_view inside) {
      const SocketcandWords words = socketcand_words(inside);
      VINV_CHECK(!words.empty());
      if (words[0] == "frame" || words[0] == "rtr") {
        const auto got = parse_socketcand_received(words);
        VINV_CHECK(got);
        frames.push_back(got->frame);
      } else {
        VINV_CHECK(words[0] == "error" ||
                   (words.size() == 1 && (words[0] == "hi" || words[0] == "ok" || words[0] == "echo")));
      }
    });
    VINV_CHECK(messages.overlong() == 0);
    if (!heard.empty()) VINV_CHECK(heard.back() == '>');
    const std::vector<CanFrame> sent(sent_by_other.begin() + static_cast<std::ptrdiff_t>(first_frame),
                                     sent_by_other.end());
    VINV_CHECK(vinv::fuzz::is_in_order_within(frames, sent));
  }

  SocketcandOptions options;
  std::unique_ptr<SocketcandSession> session;
  bool ended = false;
  std::size_t first_frame = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  Session bench;
  constexpr const char* kMessages[] = {"< open can0 >",
                                       "< open can1 >",
                                       "< rawmode >",
                                       "< bcmmode >",
                                       "< echo >",
                                       "< open >",
                                       "< send ",
                                       "< sendrtr ",
                                       " >",
                                       "<",
                                       ">",
                                       "< open nobody >",
                                       "< send 123 0 >",
                                       "< sendrtr 1 0 >",
                                       "< statistics 100 >",
                                       "< add 0 1000 123 1 FF >"};
  bench.play(
      input, [&](std::string_view text) { bench.say(text); }, kMessages,
      [](const CanFrame& frame) { return socketcand_send(frame); },
      [&](std::uint8_t argument) {
        if (argument == 0) bench.restart();
        if (argument == 1 && !bench.closed) bench.client->close();
        if (argument > 1) bench.say("< open can0 >< rawmode >");
      });
  bench.run_for(300ms);
  bench.check_heard();
  if (!bench.closed && !bench.ended) {
    bench.say("> < echo >");
    if (!bench.closed) VINV_CHECK(bench.heard.ends_with("< echo >"));
  }

  bench.restart();
  bench.say("< open can1 >");
  VINV_CHECK(bench.heard == "< hi >< ok >");
  bench.say("< rawmode >");
  VINV_CHECK(bench.heard == "< hi >< ok >< ok >");
  bench.run_for(30ms);
  bench.heard.clear();
  bench.heard_by_other.clear();
  bench.say("< send 7 2 1 A >");
  bench.run_for(5ms);
  VINV_CHECK(bench.heard_by_other.size() == 1 && bench.heard_by_other[0] == CanFrame::standard(7, {1, 10}));
  bench.other->send(bench.scheduler.now(), CanFrame::remote_request(0x701, 1));
  bench.run_for(5ms);
  VINV_CHECK(bench.heard.starts_with(" < rtr 701 ") && bench.heard.ends_with(" 1 >"));
  return 0;
}
