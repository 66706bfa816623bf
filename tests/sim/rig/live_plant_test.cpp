// A live plant of this machine's sockets and pseudo-terminals; clients are plain sockets on a thread of their own.
#include <fstream>

#include "tests/sim/rig/live_plant_bench.hpp"
#include "tests/support/read_file.hpp"

namespace vinv::rig {
namespace {

constexpr const char* kPlant =
    "networks: { plc: { modbus_tcp: 127.0.0.1:0 }, can0: { can: virtual, socketcand: 127.0.0.1:0 } }\n"
    "drives:\n"
    "  - name: a\n    board: { node: 5, modbus_tcp: plc }\n    parameters: { Pr.7: 2.5 }\n"
    "  - name: b\n    board: { node: 6, modbus_tcp: plc, modbus_rtu: none }\n";

TEST_F(LivePlantTest, TheReadyTextNamesEveryEndpointAndTheyAnswer) {
  serve(kPlant, [&](LivePlant&, const Json& ready) {
    const std::uint16_t port = ready["drives"][0]["endpoints"][0]["port"];
    const std::string socketcand = ready["drives"][1]["endpoints"].back()["socketcand"].dump();
    EXPECT_GT(port, 0);
    EXPECT_EQ(ready["drives"].dump(), Json::parse(R"([{"name":"a","family":"fr-e500","board":"oi-fr-e5nco","endpoints":[
                  {"protocol":"modbus-tcp","host":"127.0.0.1","port":)" +
                                                  std::to_string(port) + R"(,"unit":5},
                  {"protocol":"modbus-rtu","path":")" +
                                                  folder_ + R"(/run/a.tty","unit":5},
                  {"protocol":"canopen","node":5,"bitrate":125000,"socketcand":)" +
                                                  socketcand + R"(,"channel":"can0"}]},
                {"name":"b","family":"fr-e500","board":"oi-fr-e5nco","endpoints":[
                  {"protocol":"modbus-tcp","host":"127.0.0.1","port":)" +
                                                  std::to_string(port) + R"(,"unit":6},
                  {"protocol":"canopen","node":6,"bitrate":125000,"socketcand":)" +
                                                  socketcand + R"(,"channel":"can0"}]}])")
                                          .dump());
    EXPECT_TRUE(fs::is_symlink(folder_ + "/run/a.tty"));
    // Pr.7 of unit 5: 2.5 s.
    const std::string request("\0\1\0\0\0\6\5\3\x4e\x2e\0\1", 12);
    EXPECT_EQ(ask_tcp(port, request, 11), std::string("\0\1\0\0\0\5\5\3\2\0\x19", 11));
    const std::string control = ready["control"];
    EXPECT_EQ(Json::parse(ask_control(
                  control,
                  R"({"jsonrpc":"2.0","id":1,"method":"parameter","params":{"drive":"a","value":"Pr.7"}})"))["result"],
              (Json{{"Pr.7", 2.5}}));
  });
  EXPECT_TRUE(notices_.empty());
  EXPECT_FALSE(fs::exists(folder_ + "/run/control.sock")) << "nothing is left behind";
  EXPECT_FALSE(fs::is_symlink(folder_ + "/run/a.tty"));
}

TEST_F(LivePlantTest, TheAnswerToTheLongestBatchArrivesWhole) {
  serve(kPlant, [&](LivePlant&, const Json& ready) {
    Json batch = Json::array();
    for (std::size_t i = 0; i < ControlSession::kMaxBatch; ++i)
      batch.push_back({{"jsonrpc", "2.0"}, {"id", i}, {"method", "parameters"}, {"params", {{"drive", "a"}}}});
    const Json answers = Json::parse(ask_control(ready["control"], batch.dump()), nullptr, false);
    ASSERT_EQ(answers.size(), ControlSession::kMaxBatch);
    EXPECT_EQ(answers.back()["id"], ControlSession::kMaxBatch - 1);
  });
}

TEST_F(LivePlantTest, AnIpv6AddressStandsInBracketsBeforeItsPort) {
  serve("drives:\n  - board: { node: 5, modbus_rtu: none, modbus_tcp: \"[::1]:0\", network: none }\n",
        [&](LivePlant& live, const Json& ready) {
          const std::string port = std::to_string(ready["drives"][0]["endpoints"][0]["port"].get<int>());
          EXPECT_NE(live.table().find("[::1]:" + port + " unit 5"), std::string::npos) << live.table();
        });
}

TEST_F(LivePlantTest, ParametersLastOverARestartUntilAFreshOne) {
  const auto pr7 = [](const Json& ready) {
    return Json::parse(ask_control(
        ready["control"],
        R"({"jsonrpc":"2.0","id":1,"method":"parameter","params":{"drive":"a","value":"Pr.7"}})"))["result"]["Pr.7"];
  };
  serve(kPlant, [&](LivePlant&, const Json& ready) {
    ask_control(ready["control"], R"({"jsonrpc":"2.0","id":1,"method":"mode","params":{"drive":"a","value":"PU"}})");
    ask_control(ready["control"],
                R"({"jsonrpc":"2.0","id":1,"method":"parameter","params":{"drive":"a","value":{"Pr.7":9.5}}})");
    EXPECT_EQ(pr7(ready), 9.5);
  });
  serve(kPlant, [&](LivePlant&, const Json& ready) { EXPECT_EQ(pr7(ready), 9.5); });
  options_.fresh = true;
  serve(kPlant, [&](LivePlant&, const Json& ready) { EXPECT_EQ(pr7(ready), 2.5); });
  options_.fresh = false;
  serve(kPlant, [&](LivePlant&, const Json& ready) { EXPECT_EQ(pr7(ready), 2.5); });
}

TEST_F(LivePlantTest, DamagedEepromsAreKeptAsideAndRaiseTheStorageAlarm) {
  serve(kPlant, [](LivePlant&, const Json&) {});
  const std::string file = folder_ + "/state/a.eeprom";
  const std::string good = vinv::test::read_file(file);
  ASSERT_GT(good.size(), 100u);
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 4);
  int n = 0;
  for (const std::string& damaged : {good.substr(0, good.size() / 2), flipped, std::string("\x00\xff", 2)}) {
    std::ofstream(file, std::ios::trunc) << damaged;
    notices_.clear();
    serve(kPlant, [&](LivePlant&, const Json& ready) {
      const Json s = Json::parse(
          ask_control(ready["control"], R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"drive":"a"}})"));
      EXPECT_EQ(s["result"]["alarm"]["name"], "E.PE") << s.dump();
      EXPECT_EQ(s["result"]["endpoints"][0]["unit"], 5) << "masters find the drive where they look for it";
    });
    const std::string aside = file + ".damaged-" + std::to_string(++n);
    EXPECT_EQ(vinv::test::read_file(aside), damaged);
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_NE(notices_[0].find(aside), std::string::npos) << notices_[0];
  }
}

TEST_F(LivePlantTest, APortInUseIsTold) {
  serve(kPlant, [&](LivePlant&, const Json& ready) {
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LiveOptions other = options_;
    other.state_folder += "2";
    other.runtime_folder += "2";
    const std::string port = std::to_string(ready["drives"][0]["endpoints"][0]["port"].get<int>());
    try {
      const LivePlant second(
          loop,
          parse_plant_file("drives:\n  - board: { modbus_tcp: 127.0.0.1:" + port + ", network: none }\n", "p.yaml",
                           catalogue),
          catalogue, other, [](const std::string&) {});
      ADD_FAILURE();
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find("127.0.0.1:" + port), std::string::npos) << e.what();
    }
  });
}

}  // namespace
}  // namespace vinv::rig
