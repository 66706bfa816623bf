// The CAN buses of a live plant over sockets of this machine; clients speak socketcand on a thread of their own.
#include "sim/rig/live_can.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "sim/rig/live_plant.hpp"
#include "tests/support/read_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::rig {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlant =
    "networks: { line: { can: virtual, bitrate: 1M, socketcand: 127.0.0.1:0, slcan: 127.0.0.1:0 } }\n"
    "drives:\n"
    "  - { name: a, board: { node: 5, modbus_tcp: none, modbus_rtu: none, network: line } }\n";
const std::string kReadType = "< send 605 8 40 00 10 00 00 00 00 00 >";

class Client {
 public:
  explicit Client(const std::string& endpoint) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const auto at = parse_host_port(endpoint);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(at->port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{5, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    connected_ = ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void say(const std::string& text) {
    EXPECT_EQ(::send(fd_, text.data(), text.size(), MSG_NOSIGNAL), std::ssize(text));
  }
  // Everything up to and with the text; what came so far if it does not come in time.
  std::string hear(const std::string& text) {
    char buffer[4096];
    std::size_t at = 0;
    while ((at = heard_.find(text)) == std::string::npos) {
      const ssize_t n = ::recv(fd_, buffer, sizeof buffer, 0);
      if (n <= 0) return std::exchange(heard_, {}) + " [no more]";
      heard_.append(buffer, static_cast<std::size_t>(n));
    }
    const std::string out = heard_.substr(0, at + text.size());
    heard_.erase(0, at + text.size());
    return out;
  }
  void open(const std::string& channel) {
    EXPECT_TRUE(connected_);
    hear("< hi >");
    say("< open " + channel + " >");
    hear("< ok >");
    say("< rawmode >");
    hear("< ok >");
  }
  // Without a goodbye.
  void reset() {
    const linger now{1, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  }

 private:
  int fd_;
  bool connected_ = false;
  std::string heard_;
};

class LiveCanTest : public testing::Test {
 protected:
  LiveCanTest() {
    options_.state_folder = folder_ + "/state";
    options_.runtime_folder = folder_ + "/run";
  }

  void serve(const std::string& text, const std::function<void(LivePlant&, const Json& endpoint)>& client) {
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LivePlant live(loop, parse_plant_file(text, "p.yaml", catalogue), catalogue, options_, [](const std::string&) {});
    std::thread thread;
    live.when_ready([&] {
      thread = std::thread([&, endpoint = live.ready_json()["drives"][0]["endpoints"].back()] {
        client(live, endpoint);
        loop.stop();
      });
    });
    loop.run();
    if (thread.joinable()) thread.join();
  }
  std::string refusal(const std::string& text) {
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LiveOptions other = options_;
    other.state_folder += "2";
    other.runtime_folder += "2";
    try {
      const LivePlant live(loop, parse_plant_file(text, "p.yaml", catalogue), catalogue, other,
                           [](const std::string&) {});
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "started";
  }
  static std::string drive_on(const std::string& network) {
    return "networks:\n  line: { " + network + " }\n" +
           "drives:\n  - board: { modbus_tcp: none, modbus_rtu: none, network: line }\n";
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  LiveOptions options_;
};

TEST_F(LiveCanTest, SlowAndDeadClientsDelayNobody) {
  serve(kPlant, [&](LivePlant&, const Json& endpoint) {
    const std::string where = endpoint["socketcand"];
    Client master(where);
    master.open("line");
    Client deaf(where);  // opens the bus and reads no more
    deaf.open("line");
    Client drip(where);  // never ends its message
    drip.hear("< hi >");
    drip.say("< op");
    const auto begin = std::chrono::steady_clock::now();
    constexpr int kRequests = 200;
    for (int i = 0; i < kRequests; ++i) {
      if (i == kRequests / 2) {
        Client dies(where);
        dies.open("line");
        dies.reset();
      }
      master.say(kReadType);
      const std::string heard = master.hear("43001000920101");
      ASSERT_EQ(heard.find("[no more]"), std::string::npos) << i << heard;
    }
    // A bus that waited for a client would need seconds for each.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  });
}

TEST_F(LiveCanTest, EndpointsAreListedAndSlcanIsOnTheSameBus) {
  serve(kPlant, [&](LivePlant& live, const Json& endpoint) {
    EXPECT_EQ(endpoint["protocol"], "canopen");
    EXPECT_EQ(endpoint["node"], 5);
    EXPECT_EQ(endpoint["bitrate"], 1'000'000);
    EXPECT_EQ(endpoint["channel"], "line");
    EXPECT_NE(live.table().find("interface='socketcand'"), std::string::npos);
    EXPECT_NE(live.table().find("channel='socket://" + endpoint["slcan"].get<std::string>() + "'"), std::string::npos);
    Client slcan(endpoint["slcan"].get<std::string>());
    slcan.say("O\r");
    slcan.say("t60584000100000000000\r");
    EXPECT_EQ(slcan.hear("t58584300100092010100\r").find("[no more]"), std::string::npos);
  });
}

TEST_F(LiveCanTest, ABoardThatIsSetToAnotherBitRateIsTold) {
  const std::string drive = drive_on("can: virtual, bitrate: 1M, socketcand: 127.0.0.1:0");
  serve(drive,
        [&](LivePlant& live, const Json&) { EXPECT_EQ(live.table().find("cannot communicate"), std::string::npos); });
  options_.fresh = true;
  serve(drive + "    parameters: { Pr.346: 132 }\n", [&](LivePlant& live, const Json&) {
    EXPECT_NE(live.table().find("the board is set to 125 kbit/s and cannot communicate"), std::string::npos);
  });
}

TEST_F(LiveCanTest, BusesWithOneAddressAreOneServerAndToldApartByTheirChannel) {
  // A free port that is then written twice.
  std::string port;
  serve(kPlant, [&](LivePlant&, const Json& endpoint) {
    const std::string where = endpoint["socketcand"];
    port = where.substr(where.find(':') + 1);
  });
  serve("networks:\n  n1: { can: virtual, socketcand: 127.0.0.1:" + port +
            " }\n  n2: { can: virtual, socketcand: 127.0.0.1:" + port + ", channel: second }\ndrives:\n" +
            "  - { name: a, board: { node: 5, modbus_tcp: none, modbus_rtu: none, network: n1 } }\n" +
            "  - { name: b, board: { node: 6, modbus_tcp: none, modbus_rtu: none, network: n2 } }\n",
        [&](LivePlant&, const Json& endpoint) {
          Client second(endpoint["socketcand"].get<std::string>());
          second.open("second");
          second.say("< send 606 8 40 00 10 00 00 00 00 00 >");
          EXPECT_EQ(second.hear("43001000920101").find("[no more]"), std::string::npos);
        });
}

TEST_F(LiveCanTest, AnSlcanAdapterOnAPseudoTerminalIsLinkedByTheNameOfItsNetwork) {
  serve(drive_on("can: virtual, socketcand: none, slcan: pty"), [&](LivePlant& live, const Json& endpoint) {
    EXPECT_EQ(endpoint["slcan"], folder_ + "/run/line.slcan");
    EXPECT_TRUE(fs::is_symlink(folder_ + "/run/line.slcan"));
    EXPECT_FALSE(endpoint.contains("socketcand"));
    EXPECT_NE(live.table().find("slcand -o " + folder_ + "/run/line.slcan"), std::string::npos);
  });
  EXPECT_FALSE(fs::is_symlink(folder_ + "/run/line.slcan")) << "nothing is left behind";
}

TEST_F(LiveCanTest, WhatCannotBeOpenedIsToldWithItsPlaceAndWhatIsAllowed) {
  serve(kPlant, [&](LivePlant&, const Json& endpoint) {
    const std::string taken = endpoint["socketcand"];
    const std::string told = refusal(drive_on("can: virtual, socketcand: " + taken));
    EXPECT_EQ(told.find("p.yaml:2:37: network line: "), 0u) << told;
    EXPECT_NE(told.find("in use"), std::string::npos) << told;
    EXPECT_NE(told.find("allowed: another address or port for socketcand (port 0 picks a free one), or none."),
              std::string::npos)
        << told;
    EXPECT_EQ(refusal(drive_on("can: virtual, socketcand: none, slcan: " + taken)).find("p.yaml:2:50: network line: "),
              0u);
  });
  {
    transports::EventLoop loop;
    const auto taken = transports::TcpListener::open(loop, {.host = "127.0.0.1", .port = transports::kSocketcandPort},
                                                     [](Instant, std::unique_ptr<transports::ByteStream>) {});
    // Held by this test, or by another program of this machine; in use in either case.
    static_cast<void>(taken);
    const std::string told = refusal("drives:\n  - board: { modbus_tcp: none, modbus_rtu: none }\n");
    EXPECT_EQ(told.find("p.yaml:2:5: network can0: cannot listen on 127.0.0.1:29536: "), 0u) << told;
    EXPECT_NE(told.find("networks: { can0: { can: virtual, socketcand: \"127.0.0.1:0\" } }"), std::string::npos)
        << told;
  }
  const std::string missing = refusal(drive_on("can: socketcan:nowhere0"));
  EXPECT_EQ(missing.find("p.yaml:2:16: network line: cannot use CAN interface nowhere0: "), 0u) << missing;
  EXPECT_NE(missing.find("allowed: a CAN interface of this machine"), std::string::npos) << missing;
  EXPECT_EQ(refusal(drive_on("can: udp_multicast:10.0.0.1"))
                .find("p.yaml:2:16: network line: 10.0.0.1 is not a multicast address"),
            0u);
  EXPECT_EQ(refusal(drive_on("can: slcan:/dev/no_such_adapter")).find("p.yaml:2:16: network line: "), 0u);
}

TEST_F(LiveCanTest, ABusOfAnotherProcessIsJoinedOverSocketcand) {
  serve(kPlant, [&](LivePlant&, const Json& endpoint) {
    Client master(endpoint["socketcand"].get<std::string>());
    master.open("line");
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LiveOptions other = options_;
    other.state_folder += "2";
    other.runtime_folder += "2";
    const std::string text =
        "drives:\n  - board: { node: 6, modbus_tcp: none, modbus_rtu: none, network: \"socketcand:" +
        endpoint["socketcand"].get<std::string>() + "/line\" }\n";
    LivePlant second(loop, parse_plant_file(text, "q.yaml", catalogue), catalogue, other, [](const std::string&) {});
    std::thread runs([&] { loop.run(); });
    EXPECT_EQ(master.hear("frame 706 ").find("[no more]"), std::string::npos) << "boot-up";
    master.say("< send 606 8 40 00 10 00 00 00 00 00 >");
    EXPECT_EQ(master.hear("43001000920101").find("[no more]"), std::string::npos);
    loop.stop();
    runs.join();
  });
}

TEST_F(LiveCanTest, RecordingsHoldWhatPassed) {
  options_.record_can = {folder_ + "/all.log", "line=" + folder_ + "/line.pcapng"};
  serve(kPlant, [&](LivePlant&, const Json& endpoint) {
    Client master(endpoint["socketcand"].get<std::string>());
    master.open("line");
    master.say(kReadType);
    master.hear("43001000920101");
  });
  const std::string log = vinv::test::read_file(folder_ + "/all.log");
  for (const char* text : {" line 705#00\n", " line 605#4000100000000000\n", " line 585#43001000920101"})
    EXPECT_NE(log.find(text), std::string::npos) << text << log;
  EXPECT_GT(fs::file_size(folder_ + "/line.pcapng"), 200u);

  options_.record_can = {folder_ + "/all.txt"};
  EXPECT_NE(refusal(kPlant), "started");
  options_.record_can = {"lime=" + folder_ + "/all.log"};
  EXPECT_NE(refusal(kPlant).find("there is no CAN network \"lime\" with drives; allowed: line. Did you mean \"line\"?"),
            std::string::npos);
  options_.record_can = {folder_ + "/all.log"};
  EXPECT_NE(refusal("drives: [ { board: { modbus_tcp: none, modbus_rtu: none, network: none } } ]\n")
                .find("no drive is on a CAN bus"),
            std::string::npos);
}

}  // namespace
}  // namespace vinv::rig
