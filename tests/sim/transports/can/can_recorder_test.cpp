// Recordings of a bus, read by the programs they are for: tshark, python-can and can-utils.
#include "sim/transports/can/can_recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "sim/transports/can/can_bridge.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"
#include "tests/support/read_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::transports {
namespace {

std::string output_of(const std::string& command) {
  std::string out;
  FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return "cannot run " + command;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.append(buffer.data(), n);
  ::pclose(pipe);
  return out;
}

std::string content(const std::string& path) { return test::read_file(path); }

CanFrame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f = CanFrame::standard(id, bytes);
  f.extended = true;
  return f;
}

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;

// A small CANopen story with frames of every kind.
void record(const std::shared_ptr<CandumpLog>& log, const std::shared_ptr<CaptureFile>& capture, bool errors) {
  BusBench b;
  auto& master = b.add("master");
  auto& slave = b.add("slave");
  b.bus->observe(std::make_shared<CanRecorder>("line can", log, capture));
  master.node->send(b.now(), CanFrame::standard(0x000, {0x01, 0x05}));
  b.run_to_us(10'000);
  master.node->send(b.now(), CanFrame::standard(0x605, {0x40, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00, 0x00}));
  b.run_to_us(20'000);
  slave.node->send(b.now(), CanFrame::standard(0x585, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));
  b.run_to_us(30'000);
  master.node->send(b.now(), CanFrame::remote_request(0x705, 1));
  b.run_to_us(40'000);
  slave.node->send(b.now(), CanFrame::standard(0x705, {0x85}));
  b.run_to_us(50'000);
  master.node->send(b.now(), extended(0x18ff1234, {0xde, 0xad}));
  b.run_to_us(60'000);
  master.node->send(b.now(), CanFrame::standard(0x080, {}));
  b.run_to_us(70'000);
  if (errors) {
    b.bus->inject_error_frame(b.now());
    b.run_to_us(80'000);
    slave.node->force_bus_off(b.now());
    b.run_to_us(100'000);
  }
}

TEST(CanRecorder, TheCandumpLogIsThatOfCandump) {
  const TemporaryFolder folder;
  const auto log = CandumpLog::create(folder / "a.log", kStart);
  ASSERT_TRUE(log);
  record(*log, nullptr, true);
  // The last digits are the frame times at 125 kbit/s; the error frames are a bus error, bus off and active again.
  EXPECT_EQ(content(folder / "a.log"),
            "(1700000001.000536) line_can 000#0105\n"
            "(1700000001.010968) line_can 605#4000100000000000\n"
            "(1700000001.020920) line_can 585#4300100092010200\n"
            "(1700000001.030368) line_can 705#R1\n"
            "(1700000001.040432) line_can 705#85\n"
            "(1700000001.050672) line_can 18FF1234#DEAD\n"
            "(1700000001.060384) line_can 080#\n"
            "(1700000001.070160) line_can 20000088#0000040000000000\n"
            "(1700000001.080000) line_can 20000240#000000000000FF01\n"
            "(1700000001.091264) line_can 20000204#0040000000000000\n");
  EXPECT_EQ((*log)->lines(), 10u);
}

TEST(CanRecorder, ANodeThatJoinsInGoodHealthIsNoErrorFrame) {
  const TemporaryFolder folder;
  const auto log = CandumpLog::create(folder / "a.log", kStart);
  ASSERT_TRUE(log);
  BusBench b;
  b.bus->observe(std::make_shared<CanRecorder>("line can", *log, nullptr));
  b.add("master");
  b.add("slave");
  b.run_to_us(10'000);
  EXPECT_EQ((*log)->lines(), 0u);
}

TEST(CanRecorder, PythonCanReadsTheLog) {
  const TemporaryFolder folder;
  const auto log = CandumpLog::create(folder / "a.log", kStart);
  ASSERT_TRUE(log);
  record(*log, nullptr, true);
  const std::string script = folder / "read.py";
  std::ofstream(script) << "import can, sys\n"
                           "for m in can.LogReader(sys.argv[1]):\n"
                           "    print('%.6f %s %X %d%d%d %d %s' % (m.timestamp, m.channel, m.arbitration_id,\n"
                           "          m.is_extended_id, m.is_remote_frame, m.is_error_frame, m.dlc, m.data.hex()))\n";
  const std::string messages = output_of("/usr/bin/python3 " + script + " " + (folder / "a.log"));
  EXPECT_EQ(messages.substr(0, messages.find(" line_can 80 ")),
            "1700000001.000536 line_can 0 000 2 0105\n"
            "1700000001.010968 line_can 605 000 8 4000100000000000\n"
            "1700000001.020920 line_can 585 000 8 4300100092010200\n"
            "1700000001.030368 line_can 705 010 1 \n"
            "1700000001.040432 line_can 705 000 1 85\n"
            "1700000001.050672 line_can 18FF1234 100 2 dead\n"
            "1700000001.060384");
  EXPECT_EQ(std::count(messages.begin(), messages.end(), '\n'), 10);
}

TEST(CanRecorder, CanUtilsReadTheLog) {
  const TemporaryFolder folder;
  const auto log = CandumpLog::create(folder / "a.log", kStart);
  ASSERT_TRUE(log);
  record(*log, nullptr, false);
  const std::string asc = output_of("log2asc -I " + (folder / "a.log") + " line_can");
  for (const char* line : {"605             Rx   d 8 40 00 10 00 00 00 00 00", "705             Rx   r",
                           "705             Rx   d 1 85", "18FF1234x       Rx   d 2 DE AD"}) {
    EXPECT_NE(asc.find(line), std::string::npos) << line << "\n" << asc;
  }
}

TEST(CanRecorder, TsharkDissectsCanopenInTheCaptureWithoutAMalformedFrame) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.pcapng";
  {
    const auto capture = CaptureFile::create(path, kStart);
    ASSERT_TRUE(capture);
    record(nullptr, *capture, true);
  }
  const std::string read = "tshark -r " + path + " -d can.subdissector,canopen ";
  EXPECT_EQ(output_of(read + "-Y _ws.malformed"), "");
  EXPECT_EQ(
      output_of(read + "-T fields -E separator='|' -e frame.interface_name -e frame.time_epoch -e can.id -e can.len "
                       "-e can.flags.rtr -e can.flags.xtd -e can.flags.err"),
      "line_can|1700000001.000536000|0|2|0|0|0\n"
      "line_can|1700000001.010968000|1541|8|0|0|0\n"
      "line_can|1700000001.020920000|1413|8|0|0|0\n"
      "line_can|1700000001.030368000|1797|1|1|0|0\n"
      "line_can|1700000001.040432000|1797|1|0|0|0\n"
      "line_can|1700000001.050672000|419369524|2|0|1|0\n"
      "line_can|1700000001.060384000|128|0|0|0|0\n"
      "line_can|1700000001.070160000||8|||1\n"
      "line_can|1700000001.080000000||8|||1\n"
      "line_can|1700000001.091264000||8|||1\n");
  const std::string sdo = output_of(read + "-Y canopen.sdo.main_idx -T fields -e canopen.sdo.main_idx");
  EXPECT_EQ(sdo, "0x1000\n0x1000\n");
}

TEST(CanRecorder, AFullDiskEndsTheLogAndNotTheBus) {
  const auto log = CandumpLog::create("/dev/full");
  ASSERT_TRUE(log);
  record(*log, nullptr, false);
  EXPECT_EQ((*log)->error(), "recording to /dev/full ended: No space left on device");
  EXPECT_EQ((*log)->lines(), 0u);
  EXPECT_FALSE(CandumpLog::create("/nonexistent/a.log"));
}

// Two buses joined by a node of each.
TEST(CanBridge, FramesPassBothWaysOnce) {
  BusBench b;
  CanBus second(b.scheduler, {});
  auto& here = b.add("here");
  LoggingNode there(b.now(), second, {});
  CanNodeOptions options;
  options.name = "gateway";
  CanBridge bridge(b.now(), *b.bus, second.attach(b.now(), options));
  here.node->send(b.now(), CanFrame::standard(1, {1}));
  there.node->send(b.now(), CanFrame::standard(2, {2}));
  b.run_to_us(100'000);
  EXPECT_NE(there.log.find("001#01"), std::string::npos);
  EXPECT_NE(here.log.find("002#02"), std::string::npos);
  EXPECT_EQ(here.node->status().received, 1u);
  EXPECT_EQ(there.node->status().received, 1u);
  EXPECT_EQ(bridge.lost(), 0u);
  EXPECT_EQ(bridge.outside().name(), "gateway");
}

}  // namespace
}  // namespace vinv::transports
