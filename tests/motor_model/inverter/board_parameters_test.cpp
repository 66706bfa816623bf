// Parameters that act through the option board OI-FR-E5NCO, and the alarm bits that it shows, with a real FR-E500
// behind it. OI-FR-E5NCO manual: 5.1 (Pr.345, Pr.346), 8.3 (Pr.347), 8.7 (registers).
#include "motor_model/inverter/e500/inverter.hpp"
#include "option_boards/boards/make_board.hpp"
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

class BoardOnDrive {
 public:
  explicit BoardOnDrive(const Settings& settings)
      : drive(drive_with(settings)), board(std::move(boards::make_board({"oi-fr-e5nco", 42}, drive.port())).value()) {
    board->handle_power(drive.now(), true);
    run(0.01);
  }

  void run(double seconds) {
    for (long i = 0; i < std::lround(seconds * 1000); ++i) {
      drive.tick();
      board->handle_drive_tick(drive.now());
      board->handle_timeout(drive.now());
    }
  }
  // The answer PDU.
  Bytes ask(std::uint8_t function, unsigned address, unsigned value) {
    Bytes pdu{function};
    append_be16(pdu, static_cast<std::uint16_t>(address));
    append_be16(pdu, static_cast<std::uint16_t>(value));
    modbus::Unit& unit = *board->modbus_unit();
    unit.handle_request(drive.now(), 0, modbus::Addressing::kUnit, pdu);
    for (int i = 0; i < 20; ++i) {
      if (const auto answer = unit.poll_answer(drive.now(), 0)) return *answer;
      run(0.001);
    }
    ADD_FAILURE() << "no answer";
    return {};
  }
  unsigned read(unsigned address) {
    const Bytes answer = ask(3, address, 1);
    EXPECT_EQ(answer.size(), 4u);
    return answer.size() == 4 ? read_be16(answer, 2) : 0u;
  }
  std::uint32_t bit_rate() { return board->can_channel()->bit_rate(); }
  void power_cycle() {
    board->handle_power(drive.now(), false);
    drive->set_power(false);
    run(5);
    drive->set_power(true);
    run(1);
    board->handle_power(drive.now(), true);
    run(0.01);
  }
  bool write(unsigned address, unsigned value) {
    const Bytes answer = ask(6, address, value);
    return !answer.empty() && answer[0] == 6;
  }

  Bench drive;
  std::unique_ptr<boards::OptionBoard> board;
};

constexpr unsigned kStatus = 24000;
constexpr unsigned kAlarmBit = 1u << 7;

unsigned address_of(unsigned number) { return 20000 + 2 * number; }

TEST(BoardParameters, EveryParameterReadsItsRawWord) {
  BoardOnDrive b({});
  for (const ParameterInfo& p : b.drive->parameters()) {
    if (p.id.sub != 0) continue;
    EXPECT_EQ(b.read(address_of(p.id.number)), b.drive.raw(p.id.number)) << p.id.number;
  }
}

TEST(BoardParameters, Pr37AboveOneWordReadsAsTheLargestWord) {
  for (const auto& [value, word] : {std::pair{65.534, 65534u}, {65.535, 65535u}, {65.536, 65535u}, {9998.0, 65535u}}) {
    BoardOnDrive b({{"Pr.37", value}});
    EXPECT_EQ(b.read(address_of(37)), word);
    EXPECT_NEAR(b.drive->get_parameter("Pr.37").value(), value, 1e-9);
  }
  BoardOnDrive b({{"Pr.37", 9998}});
  ASSERT_TRUE(b.write(26000, 1));
  ASSERT_TRUE(b.write(address_of(37), 65535));  // a write is one word too
  EXPECT_NEAR(b.drive->get_parameter("Pr.37").value(), 65.535, 1e-9);
}

TEST(BoardParameters, Pr144IsTheNumberOfPolesOfSpeedInRpm) {
  for (const auto& [pr144, hz] : {std::pair{0.0, 30.0}, {2.0, 15.0}, {4.0, 30.0}, {6.0, 45.0}, {106.0, 45.0}}) {
    BoardOnDrive b({{"Pr.144", pr144}});
    ASSERT_TRUE(b.write(26000, 1));
    ASSERT_TRUE(b.write(24004, 900));
    ASSERT_TRUE(b.write(24000, 2));
    b.run(1.2);
    EXPECT_NEAR(b.drive.output_hz(), hz, 0.01) << pr144;
    EXPECT_EQ(b.read(24004), 900u);
  }
}

TEST(BoardParameters, Pr345IsTheNodeAndPr347TheSerialLine) {
  BoardOnDrive factory({});
  EXPECT_EQ(factory.board->modbus_unit()->address(), 63);
  EXPECT_EQ(factory.board->serial_channel()->line_settings(), boards::LineSettings{});
  BoardOnDrive b({{"Pr.345", 17}, {"Pr.347", 0x1D}});  // even parity, 19200 baud
  EXPECT_EQ(b.board->modbus_unit()->address(), 17);
  EXPECT_EQ(b.board->serial_channel()->line_settings(),
            (boards::LineSettings{.baud = 19200, .parity = boards::LineSettings::Parity::kEven}));
  EXPECT_EQ(BoardOnDrive({{"Pr.345", 100}}).board->modbus_unit()->address(), 42);  // the switches
}

TEST(BoardParameters, Pr346IsTheBitRateOnCanFromThePowerOnAfterItsChange) {
  EXPECT_EQ(BoardOnDrive({}).bit_rate(), 125'000u);  // 132 = 84H
  constexpr std::uint32_t kRates[] = {1'000'000, 500'000, 250'000, 125'000, 100'000, 62'500, 50'000, 20'000};
  for (unsigned code = 1; code <= 8; ++code) {
    EXPECT_EQ(BoardOnDrive({{"Pr.346", code}}).bit_rate(), kRates[code - 1]) << code;
    EXPECT_EQ(BoardOnDrive({{"Pr.346", 0xF0 + code}}).bit_rate(), kRates[code - 1]) << code;
  }
  for (const int code : {0, 9, 11, 15}) EXPECT_EQ(BoardOnDrive({{"Pr.346", code}}).bit_rate(), 125'000u) << code;
  BoardOnDrive b({});
  ASSERT_TRUE(b.write(26000, 1));
  ASSERT_TRUE(b.write(address_of(346), 2));
  ASSERT_TRUE(b.write(address_of(345), 17));
  b.run(0.1);
  ASSERT_TRUE(b.write(25002, 0));  // an inverter reset is no power-on
  b.run(2);
  EXPECT_EQ(b.bit_rate(), 125'000u);
  EXPECT_EQ(b.board->can_channel()->node(), 63);
  b.power_cycle();
  EXPECT_EQ(b.bit_rate(), 500'000u);
  EXPECT_EQ(b.board->can_channel()->node(), 17);
}

TEST(BoardParameters, Pr347AcknowledgesBeforeTheInverterRefuses) {
  for (double pr347 : {4.0, 132.0}) {
    BoardOnDrive b({{"Pr.347", pr347}});
    EXPECT_EQ(b.write(address_of(7), 30), pr347 == 132);  // not in network operation
    b.run(0.01);
    EXPECT_EQ(b.drive.raw(7), 2u);
  }
}

TEST(BoardAlarms, EveryRowSetsTheAlarmBitAndHeadsTheAlarmBuffer) {
  for (const AlarmRow& row : e500::family_data().alarms.rows()) {
    SCOPED_TRACE(row.name);
    BoardOnDrive b({});
    ASSERT_TRUE(b.write(26000, 1));
    EXPECT_EQ(b.read(kStatus) & kAlarmBit, 0u);
    ASSERT_TRUE(b.drive->inject_fault(row.name, true).has_value());
    b.run(0.002);
    EXPECT_EQ(b.read(kStatus), kAlarmBit);
    EXPECT_EQ(b.read(23000) & 0xFFu, row.code);
    EXPECT_EQ(b.write(25002, 0), row.reset == ResetRule::kAny);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
