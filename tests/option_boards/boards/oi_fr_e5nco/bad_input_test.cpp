// Bad frames on the serial line and bad ADUs on TCP, with the expected answer or silence; after each the board serves
// the next good request. OI-FR-E5NCO manual, 8.8; MODBUS over Serial Line V1.02, 2.5.1.
#include "option_boards/modbus/tcp_session.hpp"
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using namespace std::chrono_literals;

struct BadFrame {
  const char* what;
  Bytes bytes;
  const char* answer_pdu;  // "": silence
  bool line_error = false;
};

Bytes damaged(Bytes bytes, std::size_t at) {
  bytes.at(at) ^= 0x10;
  return bytes;
}
Bytes joined(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}
Bytes cut(Bytes bytes, std::size_t length) {
  bytes.resize(length);
  return bytes;
}

const Bytes kGood = frame("19 03 4E 20 00 01");

std::vector<BadFrame> bad_frames() {
  return {
      {"one byte", {0x19}, ""},
      {"two bytes", {0x19, 0x03}, ""},
      {"three bytes with a good CRC", with_crc({0x19}), ""},
      {"zeros", Bytes(8, 0), ""},
      {"all ones", Bytes(8, 0xff), ""},
      {"CRC wrong in its low byte", damaged(kGood, 6), ""},
      {"CRC wrong in its high byte", damaged(kGood, 7), ""},
      {"CRC high byte first", from_hex("19 03 4E 20 00 01 2E 91"), ""},
      {"address damaged", damaged(kGood, 0), ""},
      {"function damaged", damaged(kGood, 1), ""},
      {"data damaged", damaged(kGood, 3), ""},
      {"without its last byte", cut(kGood, 7), ""},
      {"without its CRC", cut(kGood, 6), ""},
      {"a byte in front", joined({0x00}, kGood), ""},
      {"a byte behind", joined(kGood, {0x01}), ""},
      // This CRC cannot see zeros behind a frame: the frame is good, its length is not.
      {"a zero byte behind", joined(kGood, {0x00}), "83 03"},
      {"two requests as one frame", joined(kGood, kGood), ""},
      {"257 bytes", with_crc(Bytes(255, 0x19)), ""},
      {"4000 bytes", Bytes(4000, 0x19), ""},
      {"parity error", kGood, "", true},
      {"unit 24", frame("18 03 4E 20 00 01"), ""},
      {"unit 247", frame("F7 03 4E 20 00 01"), ""},
      {"reserved unit 248", frame("F8 03 4E 20 00 01"), ""},
      {"unit 255", frame("FF 03 4E 20 00 01"), ""},
      {"broadcast read", frame("00 03 4E 20 00 01"), ""},
      {"broadcast of an unknown function", frame("00 2B 0E 01 00"), ""},
      {"an answer of another unit", frame("1A 03 02 00 64"), ""},
      {"ASCII framing", from_hex("3A 31 39 30 33 34 45 32 30 30 30 30 31 0D 0A"), ""},
      {"function 00", frame("19 00"), "80 01"},
      {"function 01 read coils", frame("19 01 00 00 00 08"), "81 01"},
      {"function 04 read input registers", frame("19 04 4E 20 00 01"), "84 01"},
      {"function 05 write coil", frame("19 05 00 00 FF 00"), "85 01"},
      {"function 08 diagnostics", frame("19 08 00 00 A5 37"), "88 01"},
      {"function 16 write registers", frame("19 10 4E 20 00 01 02 00 3C"), "90 01"},
      {"function 23 read and write", frame("19 17 4E 20 00 01 4E 20 00 01 02 00 3C"), "97 01"},
      {"function 43 device identification", frame("19 2B 0E 01 00"), "AB 01"},
      {"function 83H", frame("19 83 02"), "83 01"},
      {"function FFH", frame("19 FF"), "FF 01"},
      {"read without data", frame("19 03"), "83 03"},
      {"read without quantity", frame("19 03 4E 20"), "83 03"},
      {"read one byte short", frame("19 03 4E 20 00"), "83 03"},
      {"read one byte long", frame("19 03 4E 20 00 01 00"), "83 03"},
      {"write without value", frame("19 06 65 90"), "86 03"},
      {"write one byte long", frame("19 06 65 90 00 01 00"), "86 03"},
      {"quantity 0", frame("19 03 4E 20 00 00"), "83 03"},
      {"quantity 126", frame("19 03 4E 20 00 7E"), "83 03"},
      {"quantity 65535", frame("19 03 4E 20 FF FF"), "83 03"},
      {"odd address", frame("19 03 4E 21 00 01"), "83 02"},
      {"address 0", frame("19 03 00 00 00 01"), "83 02"},
      {"address 65535", frame("19 03 FF FF 00 01"), "83 02"},
      {"range overrun", frame("19 03 55 EE 00 02"), "83 02"},
      {"Pr.902", frame("19 03 55 2C 00 01"), "83 02"},
      {"read of a write-only address", frame("19 03 65 90 00 01"), "83 02"},
      {"write to a read-only address", frame("19 06 5A 3C 00 00"), "86 05"},
      {"write to an odd address", frame("19 06 65 91 00 01"), "86 02"},
      {"NET modality 2", frame("19 06 65 90 00 02"), "86 03"},
      {"longest frame, unknown function", with_crc(joined({0x19, 0x41}, Bytes(252, 0x55))), "C1 01"},
  };
}

class OiFrE5ncoBadFrames : public BoardBench, public ::testing::WithParamInterface<BadFrame> {};

TEST_P(OiFrE5ncoBadFrames, GetTheExpectedAnswerOrSilence) {
  drive.mode = port::OperationMode::kNetwork;
  power_on();
  const BadFrame& bad = GetParam();
  receive(bad.bytes, bad.line_error);
  advance(100ms);
  if (*bad.answer_pdu == '\0') {
    EXPECT_TRUE(sent.empty()) << bad.what << ": " << to_hex(sent.front().bytes);
  } else {
    ASSERT_EQ(sent.size(), 1u) << bad.what;
    EXPECT_EQ(to_hex(sent[0].bytes), to_hex(frame(std::string("19 ") + bad.answer_pdu))) << bad.what;
  }
  EXPECT_TRUE(drive.posted.empty()) << bad.what;
  EXPECT_EQ(read(20000), words({60})) << bad.what;
}

INSTANTIATE_TEST_SUITE_P(Line, OiFrE5ncoBadFrames, ::testing::ValuesIn(bad_frames()), [](const auto& test) {
  std::string name;
  bool upper = true;
  for (const char c : std::string_view(test.param.what)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    upper = std::isalnum(static_cast<unsigned char>(c)) == 0;
  }
  return name;
});

struct BadAdu {
  const char* what;
  Bytes bytes;
  const char* answer;  // whole ADU; "": none
  bool closes;
};

std::vector<BadAdu> bad_adus() {
  return {
      {"ProtocolOne", from_hex("00 01 00 01 00 06 19 03 4E 20 00 01"), "", true},
      {"LengthZero", from_hex("00 01 00 00 00 00 19"), "", true},
      {"LengthOne", from_hex("00 01 00 00 00 01 19 03 4E 20 00 01"), "", true},
      {"Length255", from_hex("00 01 00 00 00 FF 19 03"), "", true},
      {"Length65535", from_hex("00 01 00 00 FF FF 19 03"), "", true},
      {"RtuFrame", frame("19 03 4E 20 00 01"), "", true},
      {"TlsHello", from_hex("16 03 01 02 00 01 00 01 FC 03 03"), "", true},
      {"HeaderCutShort", from_hex("00 01 00 00 00"), "", false},
      {"PduCutShort", from_hex("00 01 00 00 00 06 19 03 4E"), "", false},
      {"FunctionOnly", from_hex("00 07 00 00 00 02 19 03"), "00 07 00 00 00 03 19 83 03", false},
      {"QuantityCut", from_hex("00 07 00 00 00 05 19 03 4E 20 00"), "00 07 00 00 00 03 19 83 03", false},
      {"UnknownFunction", from_hex("00 07 00 00 00 02 19 2B"), "00 07 00 00 00 03 19 AB 01", false},
      {"OtherUnit", from_hex("00 07 00 00 00 06 18 03 4E 20 00 01"), "00 07 00 00 00 03 18 83 0B", false},
      {"OddAddress", from_hex("FF FF 00 00 00 06 19 03 4E 21 00 01"), "FF FF 00 00 00 03 19 83 02", false},
  };
}

class OiFrE5ncoBadAdus : public BoardBench, public ::testing::WithParamInterface<BadAdu> {};

TEST_P(OiFrE5ncoBadAdus, GetTheExpectedAnswerOrTheConnectionIsClosed) {
  power_on();
  modbus::UnitTable table;
  table.add(unit());
  const BadAdu& bad = GetParam();
  modbus::TcpSession session(0, table);
  session.handle_bytes(now, bad.bytes);
  const auto answer = session.poll_transmit(now);
  EXPECT_EQ(answer ? to_hex(*answer) : "", bad.answer);
  EXPECT_FALSE(session.poll_transmit(now));
  EXPECT_EQ(session.close_requested().has_value(), bad.closes);
  modbus::TcpSession other(1, table);
  other.handle_bytes(now, adu(9, 25, "03 4E 20 00 01"));
  EXPECT_EQ(to_hex(other.poll_transmit(now).value()), to_hex(adu(9, 25, "03 02 00 3C")));
}

INSTANTIATE_TEST_SUITE_P(Tcp, OiFrE5ncoBadAdus, ::testing::ValuesIn(bad_adus()),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace vinv::test
