// What each register does. OI-FR-E5NCO manual, 8.7.
#include "option_boards/boards/oi_fr_e5nco/words.hpp"
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using port::NetTerminal;
using Kind = port::WriteRequest::Kind;

class OiFrE5ncoMap : public BoardBench {
 protected:
  OiFrE5ncoMap() {
    drive.mode = port::OperationMode::kNetwork;
    power_on();
  }
};

TEST_F(OiFrE5ncoMap, EveryParameterAddressReadsItsParameter) {
  for (std::uint16_t number = 0; number < 1000; ++number) drive.parameters[number] = {number + 3u, 0, 0xffff};
  drive.parameters[144].value = 4;
  for (unsigned number = 0; number < 1000; ++number) {
    if (number >= 902 && number <= 905) continue;
    const unsigned expected = number == 144 ? 4 : number + 3;
    ASSERT_EQ(read(20000 + 2 * number), words({expected})) << number;
  }
}

TEST_F(OiFrE5ncoMap, RawWordsPassUnchangedInBothDirections) {
  drive.parameters[10] = {65535, 0, 65535};
  EXPECT_EQ(read(20020), words({65535}));
  EXPECT_EQ(write(20020, 65520), echo(20020, 65520));
  EXPECT_EQ(drive.parameters[10].value, 65520u);
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kParameter);
  EXPECT_EQ(drive.executed[0].parameter, (port::ParameterId{10, 0}));
}

TEST_F(OiFrE5ncoMap, QuantityCountsItemsTwoAddressesApart) {
  for (std::uint16_t number = 0; number < 125; ++number) drive.parameters[number] = {1000u + number, 0, 0xffff};
  const Bytes answer = from_hex(read(20000, 125));
  ASSERT_EQ(answer.size(), 252u);
  EXPECT_EQ(answer[1], 250);
  for (unsigned i = 0; i < 125; ++i) EXPECT_EQ(read_be16(answer, 2 + 2 * i), 1000 + i);
}

TEST_F(OiFrE5ncoMap, CalibrationParametersAreNoAddresses) {
  for (unsigned number = 900; number <= 907; ++number) {
    drive.parameters[static_cast<std::uint16_t>(number)] = {number, 0, 0xffff};
    const bool allowed = number < 902 || number > 905;
    EXPECT_EQ(read(20000 + 2 * number), allowed ? words({number}) : "83 02") << number;
    EXPECT_EQ(write(20000 + 2 * number, 1), allowed ? echo(20000 + 2 * number, 1) : "86 02") << number;
  }
  EXPECT_EQ(read(21800, 3), "83 02");  // 900-902
  EXPECT_EQ(read(21800, 2), words({1, 1}));
}

TEST_F(OiFrE5ncoMap, AlarmsComeInPairsWithTheNewerInTheLowByte) {
  drive.history = {0x10, 0x20, 0x30, 0x40, 0x50, 0x60, 0x70, 0x80};
  EXPECT_EQ(read(23000, 4), words({0x2010, 0x4030, 0x6050, 0x8070}));
  EXPECT_EQ(read(23002), words({0x4030}));
  EXPECT_EQ(read(23006), words({0x8070}));
  EXPECT_EQ(read(23000, 5), "83 02");
  EXPECT_EQ(read(23008), "83 02");
}

TEST_F(OiFrE5ncoMap, MeasuresAreMonitorsOneToThree) {
  drive.monitors = {{1, 5000}, {2, 231}, {3, 3998}, {4, 7}};
  EXPECT_EQ(read(23100, 3), words({5000, 231, 3998}));
  EXPECT_EQ(read(23102), words({231}));
  EXPECT_EQ(read(23104), words({3998}));
  EXPECT_EQ(read(23106), "83 02");
  EXPECT_EQ(read(23104, 2), "83 02");
  EXPECT_EQ(read(23148), "83 02");  // "measures 0-24" of the table's first column are not addresses
}

TEST_F(OiFrE5ncoMap, StatusBitsStandWhereTheManualPutsThem) {
  using port::Status;
  const std::pair<bool Status::*, unsigned> bits[] = {{&Status::running, 0},
                                                      {&Status::forward, 1},
                                                      {&Status::reverse, 2},
                                                      {&Status::up_to_frequency, 3},
                                                      {&Status::overload, 4},
                                                      {&Status::power_failure, 5},
                                                      {&Status::frequency_detected, 6},
                                                      {&Status::alarm, 7},
                                                      {&Status::ready, 15}};
  EXPECT_EQ(read(24000), words({0}));
  for (const auto& [member, bit] : bits) {
    drive.status_now = {};
    drive.status_now.*member = true;
    EXPECT_EQ(read(24000), words({1u << bit})) << bit;
  }
}

TEST_F(OiFrE5ncoMap, CommandBitsBecomeTerminals) {
  const std::pair<unsigned, NetTerminal> bits[] = {
      {0, NetTerminal::kStop}, {1, NetTerminal::kStf}, {2, NetTerminal::kStr}, {3, NetTerminal::kRh},
      {4, NetTerminal::kRm},   {5, NetTerminal::kRl},  {10, NetTerminal::kMrs}};
  for (const auto& [bit, terminal] : bits) {
    EXPECT_EQ(write(24000, 1u << bit), echo(24000, 1u << bit));
    ASSERT_FALSE(drive.executed.empty());
    EXPECT_EQ(drive.executed.back().kind, Kind::kCommand);
    EXPECT_EQ(drive.executed.back().terminals.bits, static_cast<std::uint16_t>(terminal)) << bit;
  }
  EXPECT_EQ(write(24000, 0xffff), echo(24000, 0xffff));
  port::NetTerminals all;
  for (const auto& [bit, terminal] : bits) all.set(terminal, true);
  EXPECT_EQ(drive.executed.back().terminals, all);  // reserved bits are ignored
  EXPECT_EQ(write(24000, 0xfbc0), echo(24000, 0xfbc0));
  EXPECT_EQ(drive.executed.back().terminals.bits, 0);
}

TEST_F(OiFrE5ncoMap, SpeedInHertzReadsMonitorOneAndSetsTheFrequency) {
  drive.monitors[1] = 4711;
  EXPECT_EQ(read(24002), words({4711}));
  EXPECT_EQ(write(24002, 5000), echo(24002, 5000));
  EXPECT_EQ(drive.executed.at(0).kind, Kind::kFrequency);
  EXPECT_EQ(drive.executed.at(0).value, 5000u);
  EXPECT_EQ(write(24002, 40001), "86 03");  // the inverter's own limit
}

TEST_F(OiFrE5ncoMap, SpeedInRpmUsesTheManualsIntegerFormula) {
  // speed [0.01 Hz] = rpm * ((10 * poles) / 4) / 3, every division rounding down.
  struct Case {
    unsigned pr144, rpm, raw_frequency, rpm_back;
  };
  const Case cases[] = {{4, 100, 333, 99},
                        {4, 1500, 5000, 1500},
                        {2, 3000, 5000, 3000},
                        {6, 1000, 5000, 1000},
                        {8, 750, 5000, 750},
                        {10, 600, 5000, 600},
                        {104, 1500, 5000, 1500},
                        {102, 3000, 5000, 3000},
                        {0, 1500, 5000, 1500},
                        {110, 600, 5000, 600},
                        {4, 1, 3, 0},
                        {4, 0, 0, 0},
                        {6, 7, 35, 7}};
  for (const Case& c : cases) {
    drive.parameters[144].value = c.pr144;
    EXPECT_EQ(write(24004, c.rpm), echo(24004, c.rpm)) << c.pr144 << ' ' << c.rpm;
    EXPECT_EQ(drive.executed.back().kind, Kind::kFrequency);
    EXPECT_EQ(drive.executed.back().value, c.raw_frequency) << c.pr144 << ' ' << c.rpm;
    drive.monitors[1] = static_cast<std::uint16_t>(c.raw_frequency);
    EXPECT_EQ(read(24004), words({c.rpm_back})) << c.pr144 << ' ' << c.rpm;
  }
}

TEST_F(OiFrE5ncoMap, SpeedInRpmThatDoesNotFitAWordIsRefused) {
  drive.max_frequency = 0xffff;
  EXPECT_EQ(write(24004, 19660), echo(24004, 19660));  // 65533
  EXPECT_EQ(write(24004, 19661), "86 03");             // 65536
  EXPECT_EQ(drive.posted.size(), 1u);
  drive.parameters[144].value = 2;
  drive.monitors[1] = 65535;
  EXPECT_EQ(read(24004), words({39321}));
  drive.parameters.erase(144);
  EXPECT_EQ(read(24004), words({19660}));  // 4 poles where the family has no Pr.144
}

TEST(OiFrE5ncoWords, PolesOfPr144) {
  using boards::oi_fr_e5nco::poles_of;
  EXPECT_EQ(poles_of(0), 4u);
  EXPECT_EQ(poles_of(2), 2u);
  EXPECT_EQ(poles_of(10), 10u);
  EXPECT_EQ(poles_of(102), 2u);
  EXPECT_EQ(poles_of(110), 10u);
  EXPECT_EQ(poles_of(111), 4u);
  EXPECT_EQ(poles_of(65535), 4u);
}

TEST_F(OiFrE5ncoMap, AnalogSpeedIsAByteAndWriteOnly) {
  EXPECT_EQ(write(24006, 255), echo(24006, 255));
  EXPECT_EQ(drive.executed.at(0).kind, Kind::kAnalogReference);
  EXPECT_EQ(drive.executed.at(0).value, 255u);
  EXPECT_EQ(write(24006, 256), "86 03");
  EXPECT_EQ(write(24006, 65535), "86 03");
  EXPECT_EQ(read(24006), "83 02");
  EXPECT_EQ(drive.posted.size(), 1u);
}

TEST_F(OiFrE5ncoMap, ResetsTakeOnlyZero) {
  drive.history = {0x10};
  EXPECT_EQ(write(25000, 1), "86 03");
  EXPECT_EQ(write(25000, 65535), "86 03");
  EXPECT_EQ(drive.history[0], 0x10);
  EXPECT_EQ(write(25000, 0), echo(25000, 0));
  EXPECT_EQ(drive.history[0], 0);
  EXPECT_EQ(write(25002, 1), "86 03");
  EXPECT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(write(25002, 0), echo(25002, 0));
  EXPECT_EQ(drive.executed.at(1).kind, Kind::kResetInverter);
  EXPECT_EQ(read(25000), "83 02");
  EXPECT_EQ(read(25002), "83 02");
}

TEST_F(OiFrE5ncoMap, NetModalityTakesZeroAndOne) {
  EXPECT_EQ(write(26000, 0), echo(26000, 0));
  EXPECT_EQ(drive.mode, port::OperationMode::kExternal);
  EXPECT_EQ(write(26000, 1), echo(26000, 1));
  EXPECT_EQ(drive.mode, port::OperationMode::kNetwork);
  EXPECT_EQ(write(26000, 2), "86 03");
  EXPECT_EQ(write(26000, 65535), "86 03");
  EXPECT_EQ(read(26000), "83 02");
}

TEST_F(OiFrE5ncoMap, VersionWordsAreBinaryCodedDecimal) {
  EXPECT_EQ(read(27000, 9), words({0x1042, 0x0000, 0x0001, 0x0013, 0x0002, 0x0001, 0x0016, 0x0021, 0x0058}));
  EXPECT_EQ(read(27000, 10), "83 02");
  EXPECT_EQ(read(27018), "83 02");
}

TEST_F(OiFrE5ncoMap, SpeedWordsMayBeReadWithTheStatus) {
  drive.status_now.ready = true;
  drive.monitors[1] = 1500;
  EXPECT_EQ(read(24000, 3), words({0x8000, 1500, 450}));
  EXPECT_EQ(read(24000, 4), "83 02");  // 24006 is write only
}

TEST_F(OiFrE5ncoMap, OddAddressesHoldNothing) {
  for (const unsigned address : {20001u, 21997u, 23001u, 23101u, 24001u, 24003u, 24005u, 27001u}) {
    EXPECT_EQ(read(address), "83 02") << address;
  }
  for (const unsigned address : {20001u, 24001u, 24007u, 25001u, 26001u}) {
    EXPECT_EQ(write(address, 0), "86 02") << address;
  }
}

TEST_F(OiFrE5ncoMap, ReadsNeedNoNetModality) {
  drive.mode = port::OperationMode::kExternal;
  drive.monitors[1] = 12;
  EXPECT_EQ(read(20000), words({60}));
  EXPECT_EQ(read(23000), words({0}));
  EXPECT_EQ(read(23100), words({12}));
  EXPECT_EQ(read(24000), words({0}));
  EXPECT_EQ(read(27000), words({0x1042}));
}

}  // namespace
}  // namespace vinv::test
