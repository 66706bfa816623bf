// Every frame that the OI-FR-E5NCO manual prints (section 8), on the bytes: tests/golden/oi_fr_e5nco_modbus.csv.
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using port::NetTerminal;
using port::WriteRequest;
using Kind = WriteRequest::Kind;

struct GoldenRow {
  int id = 0;
  std::string section, meaning, request_printed, answer_printed, request, answer;
};

std::vector<GoldenRow> golden_rows() {
  std::ifstream file(std::string(VINV_SOURCE_DIR) + "/tests/golden/oi_fr_e5nco_modbus.csv");
  std::vector<GoldenRow> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    // No field of this table holds a comma.
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    if (fields.size() < 8) continue;
    rows.push_back({std::stoi(fields[0]), fields[1], fields[2], fields[3], fields[4], fields[5], fields[6]});
  }
  return rows;
}

// What the inverter holds when the frame arrives, and what it is told by it.
struct Situation {
  std::function<void(FakeDrive&)> before = [](FakeDrive&) {};
  std::optional<WriteRequest> executed;
};

WriteRequest request_of(Kind kind, std::uint32_t value) {
  WriteRequest request;
  request.kind = kind;
  request.value = value;
  return request;
}

std::map<int, Situation> situations() {
  const auto monitor_1 = [](std::uint16_t value) { return [value](FakeDrive& d) { d.monitors[1] = value; }; };
  WriteRequest pr_7 = request_of(Kind::kParameter, 100);
  pr_7.parameter = {7, 0};
  WriteRequest stf = request_of(Kind::kCommand, 2);
  stf.terminals.set(NetTerminal::kStf, true);
  return {
      {1, {[](FakeDrive& d) { d.parameters[0].value = 60, d.parameters[1].value = 11984; }, {}}},
      {2, {}},
      {3, {{[](FakeDrive&) {}}, pr_7}},
      {4, {[](FakeDrive& d) { d.parameters[7].value = 100; }, {}}},
      {5, {[](FakeDrive& d) { d.history = {0xa3}; }, {}}},
      {6,
       {[](FakeDrive& d) {
          d.history = {0xb1, 0xa3};
        },
        {}}},
      {7, {monitor_1(5000), {}}},
      {8, {{[](FakeDrive&) {}}, stf}},
      {9,
       {[](FakeDrive& d) {
          d.status_now.running = d.status_now.forward = d.status_now.up_to_frequency = true;
          d.status_now.frequency_detected = d.status_now.ready = true;
        },
        {}}},
      {10, {{[](FakeDrive&) {}}, request_of(Kind::kFrequency, 10000)}},
      {11, {monitor_1(6000), {}}},
      {12, {{[](FakeDrive&) {}}, request_of(Kind::kFrequency, 333)}},
      {13, {monitor_1(167), {}}},
      {14, {{[](FakeDrive&) {}}, request_of(Kind::kAnalogReference, 120)}},
      {15, {{[](FakeDrive&) {}}, request_of(Kind::kClearAlarmHistory, 0)}},
      {16, {}},
      {17, {{[](FakeDrive&) {}}, request_of(Kind::kResetInverter, 0)}},
      {18, {}},
      {19, {{[](FakeDrive&) {}}, request_of(Kind::kOperationMode, 1)}},
      {20, {{[](FakeDrive&) {}}, request_of(Kind::kOperationMode, 0)}},
      {21, {}},
      {22, {}},
      {23, {}},
      {24, {}},
      {25, {}},
      {26, {}},
      {27, {}},
      {28, {}},
      {29, {}},
      {30, {}},
      {31, {}},
  };
}

class OiFrE5ncoGoldenFrames : public BoardBench, public ::testing::WithParamInterface<GoldenRow> {};

TEST_P(OiFrE5ncoGoldenFrames, AreAnsweredAsPrinted) {
  const GoldenRow& row = GetParam();
  const Situation situation = situations().at(row.id);
  drive.mode = port::OperationMode::kNetwork;
  situation.before(drive);
  power_on();

  const std::string answer = exchange(from_hex(row.request));
  if (row.id == 21) {
    // The value is lost; its CRC ends in 5H B7H.
    const Bytes bytes = from_hex(answer);
    ASSERT_EQ(bytes.size(), 7u);
    EXPECT_EQ(to_hex(ByteView(bytes).first(3)), "19 03 02");
    EXPECT_EQ(modbus::crc16(bytes), 0);
    EXPECT_EQ(bytes[5] & 0x0f, 0x05);
    EXPECT_EQ(bytes[6], 0xb7);
  } else {
    EXPECT_EQ(answer, row.answer) << row.meaning;
  }
  if (situation.executed) {
    ASSERT_EQ(drive.executed.size(), 1u);
    EXPECT_EQ(drive.executed[0].kind, situation.executed->kind);
    EXPECT_EQ(drive.executed[0].parameter, situation.executed->parameter);
    EXPECT_EQ(drive.executed[0].value, situation.executed->value);
    EXPECT_EQ(drive.executed[0].terminals, situation.executed->terminals);
  } else if (row.id != 2) {
    EXPECT_TRUE(drive.posted.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Manual, OiFrE5ncoGoldenFrames, ::testing::ValuesIn(golden_rows()),
                         [](const auto& test) { return "Row" + std::to_string(test.param.id); });

using OiFrE5ncoGoldenTable = BoardBench;

TEST_F(OiFrE5ncoGoldenTable, HoldsAllThirtyOneFramesAndTheyAreSound) {
  const auto rows = golden_rows();
  ASSERT_EQ(rows.size(), 31u);
  for (const GoldenRow& row : rows) {
    EXPECT_EQ(modbus::crc16(from_hex(row.request)), 0) << row.id;
    const Bytes answer = from_hex(row.answer);
    EXPECT_EQ(answer.empty() ? 0 : modbus::crc16(answer), 0) << row.id;
    EXPECT_EQ(answer.empty(), row.id == 21) << row.id;
  }
}

TEST_F(OiFrE5ncoGoldenTable, SecondRowAsPrintedHasAWrongCrcAndIsSilence) {
  drive.mode = port::OperationMode::kNetwork;
  power_on();
  const GoldenRow row = golden_rows().at(1);
  ASSERT_EQ(row.id, 2);
  ASSERT_EQ(row.request_printed, "19 06 65 90 00 01 D5 CE");
  EXPECT_EQ(exchange(from_hex(row.request_printed)), "");
  EXPECT_TRUE(drive.posted.empty());
}

}  // namespace
}  // namespace vinv::test
