// Each exception code by each cause. OI-FR-E5NCO manual, 8.8.
#include "option_boards/boards/oi_fr_e5nco/exception_codes.hpp"
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using port::Refusal;

class OiFrE5ncoExceptions : public BoardBench {
 protected:
  OiFrE5ncoExceptions() {
    drive.mode = port::OperationMode::kNetwork;
    power_on();
  }
};

TEST_F(OiFrE5ncoExceptions, OneForEveryOtherFunction) {
  for (unsigned function = 0; function <= 0xff; ++function) {
    if (function == 3 || function == 6) continue;
    const Bytes pdu{static_cast<std::uint8_t>(function), 0x4e, 0x20, 0x00, 0x01};
    EXPECT_EQ(ask(to_hex(pdu)), to_hex(Bytes{static_cast<std::uint8_t>(function | 0x80), 1})) << function;
  }
}

TEST_F(OiFrE5ncoExceptions, TwoForAddressesOutsideTheMap) {
  for (const unsigned address : {0u,     1u,     2000u,  19998u, 22000u, 22998u, 23008u, 23098u, 23106u, 23998u,
                                 24008u, 24998u, 25004u, 25998u, 26002u, 26998u, 27018u, 30000u, 65534u, 65535u}) {
    EXPECT_EQ(read(address), "83 02") << address;
    EXPECT_EQ(write(address, 0), "86 02") << address;
  }
}

TEST_F(OiFrE5ncoExceptions, TwoForRangesThatAreOverrun) {
  EXPECT_EQ(read(21998, 2), "83 02");
  EXPECT_EQ(read(19998, 2), "83 02");
  EXPECT_EQ(read(27016, 2), "83 02");
  EXPECT_EQ(read(24004, 2), "83 02");
  EXPECT_EQ(read(65534, 125), "83 02");  // does not wrap around
}

TEST_F(OiFrE5ncoExceptions, TwoForAParameterThatTheFamilyDoesNotHave) {
  EXPECT_EQ(read(20056), "83 02");     // Pr.28
  EXPECT_EQ(read(20014, 2), "83 02");  // Pr.7 is there, Pr.8 not in this table
  EXPECT_EQ(write(20056, 1), "86 02");
}

TEST_F(OiFrE5ncoExceptions, ThreeForValuesOutsideTheMapsRange) {
  EXPECT_EQ(write(24006, 256), "86 03");
  EXPECT_EQ(write(25000, 50), "86 03");
  EXPECT_EQ(write(25002, 54), "86 03");
  EXPECT_EQ(write(26000, 3), "86 03");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoExceptions, ThreeForValuesOutsideTheInvertersRange) {
  EXPECT_EQ(write(20002, 12001), "86 03");
  EXPECT_EQ(write(24002, 40001), "86 03");
}

TEST_F(OiFrE5ncoExceptions, ThreeForQuantitiesOutsideOneToOneHundredTwentyFive) {
  EXPECT_EQ(read(20000, 0), "83 03");
  EXPECT_EQ(read(20000, 126), "83 03");
  EXPECT_EQ(read(20001, 0), "83 03");  // quantity is checked before the address
}

TEST_F(OiFrE5ncoExceptions, FourWhileTheInverterStartsUpOrResets) {
  drive.is_ready = false;
  for (const unsigned address : {20000u, 20056u, 23000u, 23100u, 24000u, 24002u, 24004u}) {
    EXPECT_EQ(read(address), "83 04") << address;
  }
  for (const unsigned address : {20000u, 24000u, 24002u, 24004u, 24006u, 25000u, 25002u, 26000u}) {
    EXPECT_EQ(write(address, 0), "86 04") << address;
  }
  // The option's own knowledge: its version and its map.
  EXPECT_EQ(read(27000), words({0x1042}));
  EXPECT_EQ(read(30000), "83 02");
  EXPECT_EQ(write(26000, 3), "86 03");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoExceptions, FourAfterAnInverterResetUntilItIsReadyAgain) {
  drive.dead_ticks_after_reset = 1000;
  EXPECT_EQ(write(25002, 0), echo(25002, 0));
  EXPECT_EQ(read(24000), "83 04");
  EXPECT_EQ(write(24000, 2), "86 04");
  advance(std::chrono::seconds(1));
  EXPECT_EQ(read(24000), words({0}));
  EXPECT_EQ(write(24000, 2), echo(24000, 2));
}

TEST_F(OiFrE5ncoExceptions, FiveWithoutNetModality) {
  drive.mode = port::OperationMode::kExternal;
  for (const unsigned address : {20000u, 24000u, 24002u, 24004u, 24006u, 25000u, 25002u}) {
    EXPECT_EQ(write(address, 0), "86 05") << address;
  }
  EXPECT_TRUE(drive.executed.empty());
  EXPECT_EQ(write(26000, 1), echo(26000, 1));
  EXPECT_EQ(write(20014, 100), echo(20014, 100));
}

TEST_F(OiFrE5ncoExceptions, FiveForAModeChangeWhileRunning) {
  drive.status_now.running = true;
  EXPECT_EQ(write(26000, 0), "86 05");
  EXPECT_EQ(drive.mode, port::OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoExceptions, FiveForAParameterThatIsNotWritableWhileRunning) {
  drive.status_now.running = true;
  EXPECT_EQ(write(20014, 100), "86 05");
  EXPECT_EQ(write(20008, 100), echo(20008, 100));  // Pr.4 is
}

TEST_F(OiFrE5ncoExceptions, FiveWhilePr77DisablesWriting) {
  drive.write_disabled = true;
  EXPECT_EQ(write(20014, 100), "86 05");
  EXPECT_EQ(drive.parameters[7].value, 50u);
}

TEST_F(OiFrE5ncoExceptions, FiveForWhatCanOnlyBeRead) {
  EXPECT_EQ(write(20684, 1), "86 05");  // the fake drive's Pr.342 is read only
  for (const unsigned address : {23000u, 23006u, 23100u, 23104u, 27000u, 27016u}) {
    EXPECT_EQ(write(address, 0), "86 05") << address;
  }
}

TEST_F(OiFrE5ncoExceptions, SixWhileAnotherWriteIsInProgress) {
  drive.ticks_to_decide = 30;
  unit().handle_request(now, 1, modbus::Addressing::kUnit, write_pdu(20014, 70));
  EXPECT_FALSE(unit().poll_answer(now, 1));
  unit().handle_request(now, 2, modbus::Addressing::kUnit, write_pdu(24002, 100));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 2).value()), "86 06");
  unit().handle_request(now, 2, modbus::Addressing::kUnit, read_pdu(20014, 1));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 2).value()), words({50}));  // reads go on
  advance(std::chrono::milliseconds(40));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 1).value()), echo(20014, 70));
  unit().handle_request(now, 2, modbus::Addressing::kUnit, write_pdu(24002, 100));
  EXPECT_FALSE(unit().poll_answer(now, 2));
  advance(std::chrono::milliseconds(40));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 2).value()), echo(24002, 100));
}

TEST_F(OiFrE5ncoExceptions, EveryRefusalOfTheDecisionHasItsCode) {
  const std::pair<Refusal, const char*> codes[] = {
      {Refusal::kNoSuchItem, "86 02"}, {Refusal::kOutOfRange, "86 03"},        {Refusal::kReadOnly, "86 05"},
      {Refusal::kWriteOnly, "86 02"},  {Refusal::kRunning, "86 05"},           {Refusal::kWriteDisabled, "86 05"},
      {Refusal::kWrongMode, "86 05"},  {Refusal::kModeChangeRefused, "86 05"}, {Refusal::kBusy, "86 06"},
      {Refusal::kNotReady, "86 04"},   {Refusal::kFaulted, "86 05"},           {Refusal::kNotFaulted, "86 05"}};
  for (const auto& [refusal, answer] : codes) {
    drive.refuse_decision = refusal;
    EXPECT_EQ(write(24002, 100), answer) << static_cast<int>(refusal);
    drive.refuse_decision.reset();
    drive.refuse_post = refusal;
    EXPECT_EQ(write(24002, 100), answer) << static_cast<int>(refusal);
    drive.refuse_post.reset();
  }
  EXPECT_EQ(write(24002, 100), echo(24002, 100));
}

TEST_F(OiFrE5ncoExceptions, EveryRefusalStandsInTheTableOnce) {
  using boards::oi_fr_e5nco::kExceptionCodes;
  for (int refusal = 0; refusal <= static_cast<int>(Refusal::kNotFaulted); ++refusal) {
    EXPECT_EQ(std::count_if(kExceptionCodes.begin(), kExceptionCodes.end(),
                            [&](const auto& entry) { return static_cast<int>(entry.first) == refusal; }),
              1)
        << refusal;
  }
}

TEST_F(OiFrE5ncoExceptions, MonitorOrParameterReadRefusedByTheInverterIsMappedToo) {
  drive.monitors.erase(2);
  EXPECT_EQ(read(23100, 3), "83 02");
  drive.parameters_readable = false;
  EXPECT_EQ(read(20000), "83 04");
}

TEST_F(OiFrE5ncoExceptions, WriteLostInARestartOfTheInverterIsNotReadyButAResetIsDone) {
  drive.ticks_to_decide = 1000;
  for (const auto& [address, answer] : {std::pair{24002u, std::string("86 04")}, std::pair{25002u, echo(25002, 0)}}) {
    sent.clear();
    Bytes request{25};
    const Bytes pdu = write_pdu(address, 0);
    request.insert(request.end(), pdu.begin(), pdu.end());
    receive(with_crc(request));
    advance(std::chrono::milliseconds(20));
    EXPECT_TRUE(sent.empty());
    drive.lose_mailbox();
    advance(std::chrono::milliseconds(20));
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(to_hex(ByteView(sent[0].bytes).subspan(1, sent[0].bytes.size() - 3)), answer);
  }
}

}  // namespace
}  // namespace vinv::test
