// FR-A700 with FR-A7NE in a live plant: endpoints, the standard ports on addresses of their own, flash memory over
// restarts, recordings. Addresses depend on the process: others may run the same tests.
#include <cstdio>
#include <fstream>

#include "sim/base/ipv4.hpp"
#include "tests/sim/rig/live_plant_bench.hpp"
#include "tests/support/eip_scanner.hpp"
#include "tests/support/read_file.hpp"

namespace vinv::rig {
namespace {

using scanner::EipScanner;
using scanner::Octets;

std::uint32_t address(unsigned last) {
  const auto id = static_cast<unsigned>(::getpid());
  return ipv4(127, 70 + (id >> 8) % 60, id % 256, last);
}
std::string plant(const std::string& board = "") {
  std::string text = "drives:\n";
  for (unsigned i = 1; i <= 2; ++i)
    text += "  - { name: d" + std::to_string(i) + ", inverter: { family: fr-a700, model: FR-A740-1.5K },\n" +
            "      board: { address: " + ipv4_text(address(i)) + (i == 1 ? board : "") +
            " }, parameters: { Pr.340: 10 } }\n";
  return text;
}
scanner::OpenOptions owner() {
  scanner::OpenOptions o;
  o.o2t_size = 10;
  o.t2o_size = 6;
  o.timeout_multiplier = 4;
  o.path = {0x20, 4, 0x2c, 21, 0x2c, 71};
  return o;
}

using LiveEthernetPlant = LivePlantTest;

TEST_F(LiveEthernetPlant, EachDriveHasTheStandardPortsAtItsAddressAndRunsItsMotor) {
  serve(plant(), [&](LivePlant& live, const Json& ready) {
    EXPECT_EQ(ready["drives"][1].dump(),
              Json::parse(R"({"name":"d2","family":"fr-a700","board":"fr-a7ne","endpoints":[{"protocol":"ethernet-ip",
                "host":")" +
                          ipv4_text(address(2)) + R"(","tcp":44818,"udp_io":2222}]})")
                  .dump());
    EXPECT_NE(live.table().find("EtherNet/IP " + ipv4_text(address(2))), std::string::npos) << live.table();
    EipScanner one(address(200), address(1)), two(address(201), address(2));
    ASSERT_TRUE(one.connect() && two.connect() && one.open_io());
    EXPECT_EQ(one.get_attribute(1, 1, 1).data, (Octets{0xa1, 0}));
    auto c = one.open(owner());
    ASSERT_TRUE(c.ok);
    std::size_t packets = 0;
    Octets last;
    for (; packets < 100; ++packets) {
      const auto p = one.receive_io(5000);
      ASSERT_TRUE(p);
      last = p->data;
      one.send_io(c, {0x61, 0, 0xb0, 0x04});
    }
    ASSERT_EQ(last.size(), 6u);
    EXPECT_EQ(last[2] & 0x04, 0x04) << "runs forward";
    EXPECT_EQ(two.get_attribute(0x29, 1, 7).data, Octets{0}) << "the other drive does not run";
    EXPECT_EQ(one.close(c).status, 0);
  });
  EXPECT_TRUE(notices_.empty()) << notices_[0];
}

TEST_F(LiveEthernetPlant, FlashMemoryLastsOverRestartsAndADamagedOneIsKeptAside) {
  const Octets write{0x10, 3, 0x20, 0xf5, 0x24, 1, 0x30, 6, 2, 0, 'm', '1'};
  const Octets named{2, 0, 'm', '1'}, unnamed{0, 0};
  const auto name = [&] {
    EipScanner one(address(200), address(1));
    return one.connect() ? one.get_attribute(0xf5, 1, 6).data : Octets{};
  };
  serve(plant(), [&](LivePlant&, const Json&) {
    EXPECT_EQ(name(), unnamed);
    EipScanner one(address(200), address(1));
    ASSERT_TRUE(one.connect());
    EXPECT_EQ(one.request(write).status, 0);
  });
  serve(plant(), [&](LivePlant&, const Json&) { EXPECT_EQ(name(), named); });
  const std::string file = folder_ + "/state/d1.flash";
  const std::string whole = vinv::test::read_file(file);
  EXPECT_NE(whole.find("host_name = m1"), std::string::npos);
  const std::string damaged = whole.substr(0, 60);
  std::ofstream(file, std::ios::trunc) << damaged;
  notices_.clear();
  serve(plant(", flash: { host_name: m1 }"), [&](LivePlant&, const Json&) { EXPECT_EQ(name(), named); });
  ASSERT_EQ(notices_.size(), 1u);
  EXPECT_NE(notices_[0].find("d1: the stored memory of the option board is damaged: line "), std::string::npos);
  EXPECT_NE(notices_[0].find(file + ".damaged-1"), std::string::npos) << notices_[0];
  EXPECT_TRUE(fs::exists(file + ".damaged-1"));
  options_.fresh = true;
  serve(plant(), [&](LivePlant&, const Json&) { EXPECT_EQ(name(), unnamed); });
}

TEST_F(LiveEthernetPlant, AddressInUseIsToldWithItsPlace) {
  serve(plant(), [&](LivePlant&, const Json&) {
    transports::EventLoop loop;
    const Catalogue catalogue = shipped_catalogue();
    LiveOptions other = options_;
    other.state_folder += "2";
    other.runtime_folder += "2";
    try {
      const LivePlant second(loop, parse_plant_file(plant(), "p.yaml", catalogue), catalogue, other,
                             [](const std::string&) {});
      ADD_FAILURE();
    } catch (const std::runtime_error& e) {
      const std::string what = e.what();
      EXPECT_EQ(what.find("p.yaml:3:"), 0u) << what;
      EXPECT_NE(what.find("d1: EtherNet/IP at " + ipv4_text(address(1)) + " cannot be opened"), std::string::npos);
      EXPECT_NE(what.find("44818"), std::string::npos) << what;
    }
  });
}

// Forward_Open and its I/O in one capture, which tshark finds no fault in.
TEST_F(LiveEthernetPlant, RecordingHasTcpAndUdpOfTheAdapter) {
  options_.record_ip = folder_ + "/ip.pcapng";
  serve(plant(), [&](LivePlant&, const Json&) {
    EipScanner one(address(200), address(1));
    ASSERT_TRUE(one.connect() && one.open_io());
    EXPECT_FALSE(one.list_identity(address(2), 0, 200).empty());
    EXPECT_GE(one.list_identity(ipv4(127, 255, 255, 255), 500, 600).size(), 2u);
    auto c = one.open(owner());
    ASSERT_TRUE(c.ok);
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(one.receive_io(5000));
      one.send_io(c, {0x60, 0, 0, 0});
    }
    EXPECT_EQ(one.close(c).status, 0);
  });
  const auto tshark = [&](const std::string& filter) {
    FILE* pipe = ::popen(("tshark -r " + options_.record_ip + " -Y '" + filter + "' 2>/dev/null").c_str(), "r");
    std::string out;
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
    EXPECT_EQ(::pclose(pipe), 0);
    return std::count(out.begin(), out.end(), '\n');
  };
  EXPECT_EQ(tshark("_ws.malformed || _ws.expert.severity >= 8388608"), 0);
  EXPECT_EQ(tshark("cip.sc == 0x54 || cip.sc == 0xd4"), 2);
  EXPECT_GE(tshark("cipio && ip.src == " + ipv4_text(address(1))), 5);
  EXPECT_GE(tshark("cipio && ip.dst == " + ipv4_text(address(1))), 4);
  EXPECT_GE(tshark("udp && enip.command == 0x63 && ip.src == " + ipv4_text(address(2))), 2);
  EXPECT_EQ(tshark("enip.command == 0x63 && ip.dst == 127.255.255.255 && ip.src == " + ipv4_text(address(200))), 1)
      << "one for both adapters";
  // Explicit messages are marked, those of clients are as they were.
  const std::string ours = " && ip.src == " + ipv4_text(address(1)) + " && (tcp || enip.command == 0x63)";
  EXPECT_GT(tshark("ip.dsfield.dscp == 27" + ours), 0);
  EXPECT_EQ(tshark("ip.dsfield.dscp != 27" + ours), 0);
  EXPECT_EQ(tshark("ip.dsfield.dscp != 0 && ip.dst == " + ipv4_text(address(1))), 0);
}

}  // namespace
}  // namespace vinv::rig
