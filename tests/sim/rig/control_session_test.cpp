// JSON-RPC 2.0 specification, sections 4 to 7.
#include "sim/rig/control_session.hpp"

#include <gtest/gtest.h>

#include "tests/sim/rig/fakes.hpp"

namespace vinv::rig {
namespace {

class ControlSessionTest : public testing::Test {
 protected:
  ControlSessionTest()
      : catalogue_(test::fake_catalogue(journal_)),
        plant_(parse_plant_file("drives:\n  - name: a\n", "p.yaml", catalogue_), scheduler_,
               PlantOptions{.catalogue = catalogue_,
                            .stored_eeprom = {},
                            .damaged_eeprom = {},
                            .stored_flash = {},
                            .damaged_flash = {},
                            .clock = {}}),
        session_(plant_) {}
  void take(const std::string& text) {
    session_.take_bytes(ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  std::string send(const std::string& text) {
    take(text);
    std::string answers;
    while (session_.has_work()) answers += session_.execute_next();
    return answers;
  }
  int code(const std::string& line) {
    const std::string answer = send(line + "\n");
    return answer.empty() ? 0 : Json::parse(answer)["error"]["code"].get<int>();
  }

  test::Journal journal_;
  kernel::Scheduler scheduler_;
  Catalogue catalogue_;
  Plant plant_;
  ControlSession session_;
};

TEST_F(ControlSessionTest, ARequestIsOneLineAndSoIsItsAnswer) {
  EXPECT_EQ(send(R"({"jsonrpc":"2.0","id":7,"method":"shaft","params":{"drive":"a","value":"locked"}})"
                 "\n"),
            "{\"jsonrpc\":\"2.0\",\"id\":7,\"result\":\"locked\"}\n");
  EXPECT_EQ(send(R"({"jsonrpc":"2.0","id":"x","method":"terminal","params":{"drive":"a","words":["STF","on"]}})"
                 "\n"),
            "{\"jsonrpc\":\"2.0\",\"id\":\"x\",\"result\":{\"STF\":\"on\"}}\n");
}

TEST_F(ControlSessionTest, LinesMayComeInPiecesAndTogether) {
  const std::string request = R"({"jsonrpc":"2.0","id":1,"method":"list"})";
  EXPECT_EQ(send(request.substr(0, 10)), "");
  const std::string answers = send(request.substr(10) + "\n\n" + request + "\r\n");
  EXPECT_EQ(std::count(answers.begin(), answers.end(), '\n'), 2);
}

TEST_F(ControlSessionTest, ErrorsHaveTheCodesOfTheSpecification) {
  EXPECT_EQ(code("{"), -32700);
  EXPECT_EQ(code("stop"), -32700);
  EXPECT_EQ(code(std::string(100, '[') + std::string(100, ']')), -32700);
  EXPECT_EQ(code("1"), -32600);
  EXPECT_EQ(code("[]"), -32600);
  EXPECT_EQ(code(R"({"id":1,"method":"list"})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc":"1.0","id":1,"method":"list"})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":{},"method":"list"})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"lst"})"), -32601);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"list","params":[]})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"drive":5}})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"drives":"a"}})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"drive":"b"}})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"run","params":{"drive":"a","words":[1]}})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"run","params":{"drive":"a","words":[],"value":"forward"}})"),
            -32602);
  EXPECT_EQ(code(R"({"jsonrpc":"2.0","id":1,"method":"frequency","params":{"drive":"a","value":"400 Hz"}})"), -32000);
}

TEST_F(ControlSessionTest, NotificationsAreExecutedAndNotAnswered) {
  EXPECT_EQ(send(R"({"jsonrpc":"2.0","method":"shaft","params":{"drive":"a","value":"locked"}})"
                 "\n"),
            "");
  EXPECT_TRUE(dynamic_cast<test::FakeInverter&>(*plant_.drives()[0]->inverter).shaft_locked);
  EXPECT_EQ(send("{\"jsonrpc\":\"2.0\",\"method\":\"nonsense\"}\n"), "");
}

TEST_F(ControlSessionTest, ABatchIsAnsweredAsOneWithoutItsNotifications) {
  const std::string answer = send(
      R"([{"jsonrpc":"2.0","id":1,"method":"list"},{"jsonrpc":"2.0","method":"list"},5,{"jsonrpc":"2.0","id":2,"method":"x"}])"
      "\n");
  const Json answers = Json::parse(answer);
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0]["id"], 1);
  EXPECT_EQ(answers[1]["error"]["code"], -32600);
  EXPECT_EQ(answers[2]["error"]["code"], -32601);
}

TEST_F(ControlSessionTest, BytesThatAreNoTextDoNotBreakTheAnswer) {
  const std::string answer = send("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"a\xff\"}\n");
  EXPECT_TRUE(Json::accept(answer)) << answer;
}

TEST_F(ControlSessionTest, AnEndlessLineIsRefusedAndEndsTheSession) {
  const std::string answer = send(std::string(ControlSession::kMaxLineBytes + 10, 'x'));
  EXPECT_EQ(Json::parse(answer)["error"]["code"], -32600);
  EXPECT_TRUE(session_.broken());
  EXPECT_EQ(send("\n{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"list\"}\n"), "");
}

TEST_F(ControlSessionTest, OneRequestIsExecutedAtATimeAlsoInABatch) {
  const std::string lock = R"({"jsonrpc":"2.0","id":1,"method":"shaft","params":{"drive":"a","value":"locked"}})";
  const std::string unlock = R"({"jsonrpc":"2.0","id":2,"method":"shaft","params":{"drive":"a","value":"free"}})";
  const auto locked = [&] { return dynamic_cast<test::FakeInverter&>(*plant_.drives()[0]->inverter).shaft_locked; };
  take("[" + lock + "," + unlock + "]\n" + lock + "\n");
  EXPECT_FALSE(locked());
  EXPECT_EQ(session_.execute_next(), "");
  EXPECT_TRUE(locked());
  EXPECT_EQ(Json::parse(session_.execute_next()).size(), 2u);
  EXPECT_FALSE(locked());
  EXPECT_EQ(Json::parse(session_.execute_next())["id"], 1);
  EXPECT_TRUE(locked());
  EXPECT_FALSE(session_.has_work());
}

TEST_F(ControlSessionTest, RequestsThatPileUpWithoutEndAreExecutedUpToTheLimitAndEndTheSession) {
  const std::string request = R"({"jsonrpc":"2.0","id":1,"method":"shaft","params":{"drive":"a","value":"locked"}})";
  const std::size_t fit = ControlSession::kMaxWaitingBytes / request.size();
  for (std::size_t i = 0; i < fit; ++i) take(request + "\n");
  EXPECT_FALSE(session_.broken());
  take(request + "\n");
  EXPECT_TRUE(session_.broken());
  const std::string answers = send(request + "\n");
  EXPECT_EQ(std::count(answers.begin(), answers.end(), '\n'), static_cast<std::ptrdiff_t>(fit + 2));
  EXPECT_NE(answers.find("-32600"), std::string::npos);
}

TEST_F(ControlSessionTest, TheServerLetsEventsThatAreDuePassBetweenTwoRequests) {
  ControlServer server(plant_);
  const auto far = std::make_shared<test::FakeStream::Far>();
  server.accept(scheduler_.now(), std::make_unique<test::FakeStream>(far));
  std::size_t answered_before_tick = 0;
  scheduler_.schedule(scheduler_.now(), kernel::Priority::kDrive,
                      [&](Instant) { answered_before_tick = far->sent.size(); });
  std::string requests;
  for (int i = 0; i < 10; ++i) requests += "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"list\"}\n";
  far->on_bytes(scheduler_.now(), Bytes(requests.begin(), requests.end()), false);
  scheduler_.run_until(scheduler_.now() + std::chrono::milliseconds(1));
  EXPECT_EQ(answered_before_tick, 1u);
  EXPECT_EQ(far->sent.size(), 10u);
}

TEST_F(ControlSessionTest, TheServerClosesABrokenSessionAndKeepsTheOthers) {
  ControlServer server(plant_);
  const auto broken = std::make_shared<test::FakeStream::Far>();
  const auto fine = std::make_shared<test::FakeStream::Far>();
  server.accept(scheduler_.now(), std::make_unique<test::FakeStream>(broken));
  server.accept(scheduler_.now(), std::make_unique<test::FakeStream>(fine));
  broken->on_bytes(scheduler_.now(), Bytes(ControlSession::kMaxLineBytes + 1, 'x'), false);
  EXPECT_TRUE(broken->closed);
  scheduler_.run_until(scheduler_.now() + std::chrono::milliseconds(1));
  const std::string request = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"list\"}\n";
  fine->on_bytes(scheduler_.now(), Bytes(request.begin(), request.end()), false);
  EXPECT_EQ(fine->sent.size(), 1u);
}

}  // namespace
}  // namespace vinv::rig
