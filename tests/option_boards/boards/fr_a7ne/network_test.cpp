// Link, address and connections as the option sees them. FR-A7NE manual, 1.2, 4.2.5, 4.5.1, 7.1.2 and 8.
#include <gtest/gtest.h>

#include <string>

#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using cip::IoEvent;
using cip::IoRole;

class FrA7neNetwork : public test::UnitBench {
 protected:
  void tell(IoRole role, IoEvent event) { unit.on_connection(now, {role, 0, 0}, event); }
  std::string led() const { return std::string(network_led(unit.led_situation())); }
};

// 4.5.1: what is a line error, and what is not.
TEST_F(FrA7neNetwork, LineErrorIsTheOwnersTimeOutOrALostLink) {
  for (const IoRole role : {IoRole::kExclusiveOwner, IoRole::kInputOnly, IoRole::kListenOnly}) {
    tell(role, IoEvent::kOpened);
    tell(role, IoEvent::kClosed);
    EXPECT_FALSE(drive.communication_lost) << "Forward_Close";
  }
  for (const IoRole role : {IoRole::kInputOnly, IoRole::kListenOnly}) {
    tell(role, IoEvent::kOpened);
    tell(role, IoEvent::kTimedOut);
    EXPECT_FALSE(drive.communication_lost) << "no output data";
  }
  unit.on_explicit_connection(now, IoEvent::kOpened);
  unit.on_explicit_connection(now, IoEvent::kTimedOut);
  EXPECT_FALSE(drive.communication_lost) << "class 3";
  open_owner();
  tell(IoRole::kExclusiveOwner, IoEvent::kTimedOut);
  EXPECT_TRUE(drive.communication_lost);
  tell(IoRole::kInputOnly, IoEvent::kOpened);
  EXPECT_TRUE(drive.communication_lost);
  open_owner();
  EXPECT_FALSE(drive.communication_lost);
  unit.set_link(now, false);
  EXPECT_TRUE(drive.communication_lost);
  unit.set_link(now, true);
  EXPECT_FALSE(drive.communication_lost);
}

// Chapter 8: no cable and a setting that does not fit show 0.00 and a dark LED, not E.OP3.
TEST_F(FrA7neNetwork, LinkThatWasNeverThereIsNoLineError) {
  power(false);
  unit.set_link(now, false);
  power(true);
  EXPECT_FALSE(drive.communication_lost);
  EXPECT_FALSE(unit.on_network());
  EXPECT_EQ(link_led(unit.led_situation()), "off");
  unit.set_link(now, true);
  EXPECT_TRUE(unit.on_network());
  EXPECT_EQ(link_led(unit.led_situation()), "green");
  unit.set_link(now, false);
  EXPECT_TRUE(drive.communication_lost);
  power(false);
  EXPECT_FALSE(drive.communication_lost);
  unit.set_link(now, true);
  drive.parameters[540].value = 0b11101;  // 100 Mbit/s full duplex; the other end is automatic
  power(true);
  EXPECT_FALSE(unit.has_link());
  EXPECT_FALSE(unit.on_network());
  EXPECT_FALSE(drive.communication_lost);
}

// 4.6: when a communication line error has occurred, reset cannot be made from the network.
TEST_F(FrA7neNetwork, NoResetOverAnotherWayWhileTheLinkIsLost) {
  drive.status_now.alarm = true;
  unit.set_link(now, false);
  EXPECT_EQ(request("05 02 20 01 24 01 00"), "0C");
  EXPECT_EQ(request(set_request(0x2A, 1, 101, "01 00")), "0C");
  EXPECT_EQ(request(set_request(0x29, 1, 12, "01")), "0C");
  unit.set_link(now, true);
  EXPECT_EQ(request(set_request(0x29, 1, 12, "01")), "later");
}

// 1.2 (2), every row.
TEST_F(FrA7neNetwork, NetworkLedFollowsConnections) {
  EXPECT_EQ(led(), "green flashing");
  unit.on_explicit_connection(now, IoEvent::kOpened);
  EXPECT_EQ(led(), "green");
  open_owner();
  unit.on_explicit_connection(now, IoEvent::kTimedOut);
  EXPECT_EQ(led(), "red flashing");
  EXPECT_EQ(get(1, 1, 5), "00 01 04") << "owned; a LED flickers red";
  unit.on_explicit_connection(now, IoEvent::kOpened);  // reestablished
  EXPECT_EQ(led(), "green");
  tell(IoRole::kExclusiveOwner, IoEvent::kTimedOut);
  EXPECT_EQ(led(), "red flashing");
  EXPECT_EQ(get(1, 1, 5), "00 00 04");
  tell(IoRole::kInputOnly, IoEvent::kOpened);
  EXPECT_EQ(led(), "red flashing") << "another connection";
  open_owner();
  EXPECT_EQ(led(), "green");
  tell(IoRole::kExclusiveOwner, IoEvent::kTimedOut);
  power(false);
  EXPECT_EQ(led(), "off");
  power(true);
  EXPECT_EQ(led(), "green flashing") << "the option was reset";
  tell(IoRole::kInputOnly, IoEvent::kOpened);
  tell(IoRole::kInputOnly, IoEvent::kClosed);
  EXPECT_EQ(led(), "green flashing");
}

TEST_F(FrA7neNetwork, NetworkLedIsOffWithoutAddress) {
  drive.parameters[540].value = 3;  // by parameters, no DHCP: 0.0.0.0
  power(false);
  power(true);
  EXPECT_EQ(led(), "off");
  EXPECT_FALSE(unit.on_network());
}

// 1.2 (1): "option unit is being initialized", self-test, alarm.
TEST_F(FrA7neNetwork, ModuleLedFollowsStartAndAlarm) {
  EXPECT_EQ(module_led(unit.led_situation()), "green flashing");
  drive.status_now.alarm = true;
  EXPECT_EQ(module_led(unit.led_situation()), "red flashing");
  drive.status_now.alarm = false;
  drive.parameters[540].value = 0x0800;
  power(false);
  power(true);
  drive.is_ready = false;  // an inverter reset that the option outlives
  EXPECT_EQ(module_led(unit.led_situation()), "green");
  power(false);
  unit.handle_power(now, true);
  EXPECT_EQ(module_led(unit.led_situation()), "green and red flashing");
  tick(499);
  EXPECT_EQ(led(), "green and red flashing");
  tick();
  EXPECT_EQ(module_led(unit.led_situation()), "green") << "the inverter is not ready";
  EXPECT_EQ(led(), "off") << "no address yet";
  drive.is_ready = true;
  tick();
  EXPECT_EQ(module_led(unit.led_situation()), "green flashing");
  drive.is_ready = false;
  drive.parameters[540].value = 0;
  power(false);
  power(true);
  drive.is_ready = true;
  tick(600);
  drive.is_ready = false;  // an inverter reset that the option does not outlive
  tick(2);
  EXPECT_FALSE(unit.online());
  EXPECT_EQ(module_led(unit.led_situation()), "green") << "the self-test is at power-on";
}

// 1.2 (1), "major fault", and 4.5.2.
TEST_F(FrA7neNetwork, FailedOptionIsRedAndOffTheNetworkUntilTheNextStart) {
  open_owner();
  unit.take_restart();
  unit.set_failed(now, true);
  EXPECT_TRUE(drive.option_failed);
  EXPECT_FALSE(drive.communication_lost);
  EXPECT_TRUE(unit.take_restart());
  EXPECT_FALSE(unit.on_network());
  EXPECT_EQ(module_led(unit.led_situation()), "red");
  EXPECT_EQ(led(), "green flashing") << "its connections are gone";
  unit.set_failed(now, true);
  EXPECT_FALSE(unit.take_restart()) << "only once";
  unit.set_failed(now, false);
  EXPECT_TRUE(drive.option_failed);
  EXPECT_FALSE(unit.on_network());
  EXPECT_EQ(module_led(unit.led_situation()), "red");
  const Bytes snapshot = save_snapshot(unit);
  power(false);
  EXPECT_FALSE(drive.option_failed);
  power(true);
  EXPECT_TRUE(unit.on_network());
  EXPECT_EQ(module_led(unit.led_situation()), "green flashing");
  ASSERT_TRUE(load_snapshot(unit, snapshot).has_value());
  EXPECT_FALSE(unit.on_network());
  power(false);
  unit.set_failed(now, true);
  power(true);
  EXPECT_TRUE(drive.option_failed);
  EXPECT_FALSE(unit.on_network());
  // Mended before it has started.
  drive.is_ready = false;
  power(false);
  unit.set_failed(now, false);
  power(true);
  unit.set_failed(now, true);
  EXPECT_EQ(module_led(unit.led_situation()), "red");
  unit.set_failed(now, false);
  drive.is_ready = true;
  tick();
  EXPECT_TRUE(unit.on_network());
}

TEST_F(FrA7neNetwork, WhoLeavesTheNetworkAnswersNobody) {
  drive.ticks_to_decide = 3;
  EXPECT_EQ(request(set_request(0x66, 1, 17, "14 00")), "later");
  unit.set_failed(now, true);
  tick(5);
  EXPECT_EQ(poll(), "");
}

TEST_F(FrA7neNetwork, SupplyThatIsThereAlreadyChangesNothing) {
  unit.take_restart();
  unit.handle_power(now, true);
  EXPECT_FALSE(unit.take_restart());
  EXPECT_TRUE(unit.online());
}

// An inverter that resets right after the start.
TEST_F(FrA7neNetwork, ResetIsSeenFromTheFirstTickOn) {
  power(false);
  unit.handle_power(now, true);
  ASSERT_TRUE(unit.online());
  drive.is_ready = false;
  tick(2);
  EXPECT_FALSE(unit.online());
}

TEST_F(FrA7neNetwork, IdentityStateFollowsStartAndAddress) {
  EXPECT_EQ(unit.identity_state(), cip::IdentityState::kOperational);
  power(false);
  drive.is_ready = false;
  power(true);
  EXPECT_EQ(unit.identity_state(), cip::IdentityState::kSelfTesting);
  drive.is_ready = true;
  drive.parameters[540].value = 3;
  tick();
  EXPECT_EQ(unit.identity_state(), cip::IdentityState::kStandby);
}

TEST_F(FrA7neNetwork, AddressThatSomebodyHasIsFoundAtTheStart) {
  power(false);
  unit.set_address_conflict(now, true);
  power(true);
  EXPECT_TRUE(unit.duplicate_address());
  EXPECT_FALSE(unit.on_network());
  EXPECT_EQ(led(), "red");
  EXPECT_FALSE(drive.communication_lost) << "chapter 8: the panel shows 0.00";
  unit.set_address_conflict(now, false);
  EXPECT_EQ(led(), "red") << "until the inverter is reset";
  power(false);
  power(true);
  EXPECT_EQ(led(), "green flashing");
  EXPECT_TRUE(unit.on_network());
}

TEST_F(FrA7neNetwork, ConflictThatComesLaterEndsTheConnections) {
  unit.take_restart();
  unit.set_address_conflict(now, true);
  EXPECT_TRUE(unit.take_restart());
  EXPECT_FALSE(drive.communication_lost) << "nobody commanded";
  unit.set_address_conflict(now, false);
  power(false);
  power(true);
  unit.take_restart();
  open_owner();
  unit.set_address_conflict(now, true);
  EXPECT_TRUE(unit.take_restart());
  unit.set_address_conflict(now, true);
  EXPECT_FALSE(unit.take_restart()) << "only once";
  EXPECT_EQ(led(), "red");
  EXPECT_EQ(get(1, 1, 5).substr(0, 5), "00 00");
  EXPECT_TRUE(drive.communication_lost) << "the owner's data stays away";
  const Bytes snapshot = save_snapshot(unit);
  power(false);
  EXPECT_FALSE(drive.communication_lost);
  ASSERT_TRUE(load_snapshot(unit, snapshot).has_value());
  EXPECT_EQ(led(), "red");
}

TEST_F(FrA7neNetwork, WithoutLinkOrAddressNoConflictIsSeen) {
  power(false);
  unit.set_link(now, false);
  unit.set_address_conflict(now, true);
  power(true);
  EXPECT_FALSE(unit.duplicate_address());
  unit.set_link(now, true);
  EXPECT_TRUE(unit.duplicate_address());
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
