// What the recorders write is judged by tshark, which the project requires for its tests.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sim/transports/ip_recorder.hpp"
#include "sim/transports/memory_link.hpp"
#include "sim/transports/serial_recorder.hpp"
#include "sim/transports/tcp_listener.hpp"
#include "tests/sim/transports/blocking_socket.hpp"
#include "tests/sim/transports/loop_thread.hpp"
#include "tests/support/read_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::transports {
namespace {

constexpr Instant at_ms(std::int64_t ms) { return instant_from_ns(ms * 1'000'000); }

std::string tshark(const std::string& arguments) {
  const std::string command = "tshark " + arguments + " 2>/dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string out;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.append(buffer.data(), n);
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return out;
}

// Modbus/TCP: read one register of unit 1, then write it; the same as RTU frames with their CRC.
const Bytes kReadQuery{0, 1, 0, 0, 0, 6, 1, 3, 0x59, 0xd8, 0, 1};
const Bytes kReadAnswer{0, 1, 0, 0, 0, 5, 1, 3, 2, 0x17, 0x70};
const Bytes kWriteBoth{0, 2, 0, 0, 0, 6, 1, 6, 0x59, 0xd8, 0, 1};
const Bytes kRtuQuery{1, 3, 0x59, 0xd8, 0, 1, 0x16, 0xad};
const Bytes kRtuAnswer{1, 3, 2, 0x17, 0x70, 0xb6, 0x50};

// One connection with a query in two pieces (tshark needs the first eight bytes together to see Modbus at all),
// answers, and the client's end.
void converse(const std::string& path) {
  kernel::Scheduler s;
  const auto recorder = IpRecorder::open(path);
  ASSERT_TRUE(recorder) << recorder.error();
  auto link =
      make_memory_link(s, {.delay = std::chrono::milliseconds(1), .name_a = "127.0.0.1:40312", .name_b = "plc"});
  const auto ours = (*recorder)->wrap(at_ms(0), std::move(link.first), "127.0.0.1", 1502);
  std::string seen;
  ours->set_handlers([&](Instant, ByteView bytes, bool) { seen.append(bytes.begin(), bytes.end()); }, {});
  link.second->set_handlers({}, {});
  link.second->send(at_ms(10), ByteView(kReadQuery).first(8));
  link.second->send(at_ms(12), ByteView(kReadQuery).subspan(8));
  s.run_until(at_ms(20));
  ours->send(at_ms(20), kReadAnswer);
  link.second->send(at_ms(30), kWriteBoth);
  s.run_until(at_ms(40));
  ours->send(at_ms(40), kWriteBoth);
  s.run_until(at_ms(50));
  link.second->close();
  s.run_until(at_ms(60));
  EXPECT_EQ(seen.size(), kReadQuery.size() + kWriteBoth.size());
  EXPECT_TRUE((*recorder)->file().error().empty());
}

TEST(IpRecorder, TsharkDissectsModbusWithoutAComplaint) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.pcapng";
  converse(path);
  const std::string modbus = tshark("-r " + path + " -o mbtcp.tcp.port:1502 -Y modbus");
  EXPECT_NE(modbus.find("Query: Trans:     1; Unit:   1, Func:   3"), std::string::npos) << modbus;
  EXPECT_NE(modbus.find("Response: Trans:     1; Unit:   1, Func:   3"), std::string::npos) << modbus;
  EXPECT_NE(modbus.find("Response: Trans:     2; Unit:   1, Func:   6"), std::string::npos) << modbus;
  // Nothing that tshark can find fault with: neither checksums nor sequence numbers nor the protocol.
  EXPECT_EQ(tshark("-r " + path +
                   " -o mbtcp.tcp.port:1502 -o tcp.check_checksum:TRUE -o ip.check_checksum:TRUE "
                   "-Y '_ws.malformed || tcp.checksum.status==0 || ip.checksum.status==0 || tcp.analysis.flags'"),
            "");
  // 31: handshake, data and both ends. Known at the last frame.
  const std::string completeness = tshark("-r " + path + " -T fields -e tcp.completeness");
  EXPECT_EQ(completeness.substr(completeness.size() - 4), "\n31\n");
  EXPECT_EQ(tshark("-r " + path + " -o mbtcp.tcp.port:1502 -T fields -e frame.time_epoch -Y modbus"),
            "0.013000000\n0.020000000\n0.031000000\n0.040000000\n");
}

TEST(IpRecorder, TwoRecordingsOfOneRunAreByteIdentical) {
  const TemporaryFolder folder;
  converse(folder / "a.pcapng");
  converse(folder / "b.pcapng");
  const std::string a = test::read_file(folder / "a.pcapng");
  EXPECT_GT(a.size(), 1000u);
  EXPECT_EQ(a, test::read_file(folder / "b.pcapng"));
}

TEST(IpRecorder, ManyRealConnectionsShareOneFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "many.pcapng";
  const std::string large(5000, 'm');
  {
    LoopThread thread;
    std::unique_ptr<IpRecorder> recorder;
    std::unique_ptr<TcpListener> listener;
    std::vector<std::unique_ptr<ByteStream>> streams;
    thread.call([&] {
      recorder = *IpRecorder::open(path, 1'700'000'000'000'000'000);
      listener = *TcpListener::open(thread.loop(), {}, [&](Instant now, std::unique_ptr<ByteStream> stream) {
        streams.push_back(recorder->wrap(now, std::move(stream), listener->host(), listener->port()));
        ByteStream& s = *streams.back();
        s.set_handlers([&s](Instant t, ByteView bytes, bool) { s.send(t, bytes); }, {});
      });
    });
    std::vector<BlockingSocket> clients;
    for (int i = 0; i < 5; ++i) clients.push_back(BlockingSocket::tcp(listener->port()));
    for (auto& client : clients) {
      ASSERT_TRUE(client.send(large));
      ASSERT_EQ(client.receive(large.size()), large);
    }
    clients.clear();
    thread.call([&] {
      streams.clear();
      listener.reset();
      recorder.reset();
    });
  }
  EXPECT_EQ(tshark("-r " + path +
                   " -o tcp.check_checksum:TRUE -o ip.check_checksum:TRUE -o "
                   "tcp.relative_sequence_numbers:TRUE -Y '_ws.malformed || tcp.checksum.status==0 || "
                   "ip.checksum.status==0 || tcp.analysis.flags'"),
            "");
  EXPECT_EQ(tshark("-r " + path + " -Y 'tcp.flags.syn==1 && tcp.flags.ack==0' -T fields -e tcp.stream"),
            "0\n1\n2\n3\n4\n");
  const std::string followed = tshark("-r " + path + " -q -z follow,tcp,raw,3");
  EXPECT_NE(followed.find("6d6d6d6d"), std::string::npos);
  EXPECT_EQ(tshark("-r " + path + " -c 1 -T fields -e frame.time_epoch").substr(0, 8), "17000000");
}

TEST(IpRecorder, IPv6ConnectionsHaveGoodChecksumsToo) {
  const TemporaryFolder folder;
  const std::string path = folder / "six.pcapng";
  kernel::Scheduler s;
  {
    const auto recorder = IpRecorder::open(path);
    auto link = make_memory_link(s, {.delay = {}, .name_a = "[2001:db8::7]:40000", .name_b = "plc"});
    const auto ours = (*recorder)->wrap(at_ms(0), std::move(link.first), "::1", 1502);
    ours->set_handlers({}, {});
    link.second->send(at_ms(1), kReadQuery);
    s.run_until(at_ms(2));
    ours->send(at_ms(2), kReadAnswer);
  }
  EXPECT_EQ(tshark("-r " + path +
                   " -o mbtcp.tcp.port:1502 -o tcp.check_checksum:TRUE -Y modbus -T fields -e ipv6.src "
                   "-e modbus.func_code -e tcp.checksum.status"),
            "2001:db8::7\t3\t1\n::1\t3\t1\n");
  EXPECT_EQ(tshark("-r " + path +
                   " -o tcp.check_checksum:TRUE -Y '_ws.malformed || tcp.checksum.status==0 || tcp.analysis.flags'"),
            "");
}

TEST(SerialRecorder, TsharkDissectsModbusRtuAndPiecesOfAFrameAreOnePacket) {
  const TemporaryFolder folder;
  const std::string path = folder / "serial.pcapng";
  kernel::Scheduler s;
  {
    const auto file = CaptureFile::create(path);
    ASSERT_TRUE(file);
    SerialRecorder recorder(*file);
    auto link = make_memory_link(s);
    const auto ours = recorder.wrap(std::move(link.first), "conveyor_1");
    ours->set_handlers({}, {});
    for (std::size_t i = 0; i < kRtuQuery.size(); ++i) {
      link.second->send(at_ms(10 + static_cast<std::int64_t>(i)), ByteView(kRtuQuery).subspan(i, 1));
    }
    s.run_until(at_ms(30));
    ours->send(at_ms(30), kRtuAnswer);
    s.run_until(at_ms(100));
    link.second->send(at_ms(100), kRtuQuery);  // not answered
    s.run_until(at_ms(200));
    link.second->send(at_ms(200), kRtuQuery);
    s.run_until(at_ms(300));
  }
  EXPECT_EQ(tshark("-r " + path +
                   " -d rtacser.data,mbrtu -o mbrtu.crc_verification:TRUE -T fields -E separator='|' "
                   "-e frame.interface_name -e frame.time_epoch -e rtacser.eventtype -e modbus.func_code "
                   "-e mbrtu.crc16.status -e _ws.malformed"),
            "conveyor_1|0.010000000|0x02|3|1|\nconveyor_1|0.030000000|0x01|3|1|\n"
            "conveyor_1|0.100000000|0x02|3|1|\nconveyor_1|0.200000000|0x02|3|1|\n");
}

TEST(CaptureFile, IsCompleteAfterEveryPacketAndSurvivesAFullDisk) {
  const TemporaryFolder folder;
  const auto file = CaptureFile::create(folder / "a.pcapng");
  ASSERT_TRUE(file);
  const auto id = (*file)->add_interface(LinkType::kEthernet, "x");
  const auto before = std::filesystem::file_size(folder / "a.pcapng");
  (*file)->packet(id, at_ms(1), Bytes(60));
  EXPECT_EQ(std::filesystem::file_size(folder / "a.pcapng"), before + 32 + 60);

  const auto full = CaptureFile::create("/dev/full");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error(), "recording to /dev/full ended: No space left on device");
  const auto missing = CaptureFile::create("/nonexistent/a.pcapng");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error(), "cannot record to /nonexistent/a.pcapng: no such file or directory");
}

}  // namespace
}  // namespace vinv::transports
