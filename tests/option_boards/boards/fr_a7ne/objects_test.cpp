// Every row of the object tables, and nothing else. FR-A7NE manual, 7; written values: 7.4 to 7.12.
#include <gtest/gtest.h>

#include <set>

#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using test::from_hex;
using test::to_hex;

class FrA7neObjects : public test::UnitBench {
 protected:
  // Every parameter and monitor exists; its value is its number.
  void fill_drive() {
    for (unsigned number = 0; number < 900; ++number) {
      auto& parameter = drive.parameters[static_cast<std::uint16_t>(number)];
      if (number != 346 && number != 540 && (number < 434 || number > 445)) parameter = {number, 0, 0xFFFF};
    }
    for (unsigned number = 0; number < 100; ++number) {
      drive.calibration[{static_cast<std::uint16_t>(900 + number), 1}] = {900 + number, 0, 0xFFFF};
      drive.calibration[{static_cast<std::uint16_t>(900 + number), 2}] = {2000 + number, 0, 0xFFFF};
    }
    for (unsigned number = 1; number <= 60; ++number) drive.monitors[number] = static_cast<std::uint16_t>(number);
  }
  static std::string word(unsigned value) {
    return to_hex(Bytes{static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)});
  }
};

// 7.1: 161 Mitsubishi Electric, AC drive, product 56, A700 as 04 41 37 30 30.
TEST_F(FrA7neObjects, IdentityIsThePrintedOne) {
  EXPECT_EQ(get(1, 0, 1), "00 01 00");
  EXPECT_EQ(get(1, 0, 2), "00 01 00");
  EXPECT_EQ(get(1, 0, 6), "00 07 00");
  EXPECT_EQ(get(1, 0, 7), "00 07 00");
  EXPECT_EQ(get(1, 1, 1), "00 A1 00");
  EXPECT_EQ(get(1, 1, 2), "00 02 00");
  EXPECT_EQ(get(1, 1, 3), "00 38 00");
  EXPECT_EQ(get(1, 1, 4), "00 01 0A");
  EXPECT_EQ(get(1, 1, 6), "00 78 56 34 12");
  EXPECT_EQ(get(1, 1, 7), "00 04 41 37 30 30");
  EXPECT_EQ(ask("01 02 20 01 24 01"), "00 A1 00 02 00 38 00 01 0A 00 00 78 56 34 12 04 41 37 30 30");
}

TEST_F(FrA7neObjects, IdentityStatusTellsOwnerAndAlarm) {
  EXPECT_EQ(get(1, 1, 5), "00 00 00");
  open_owner();
  EXPECT_EQ(get(1, 1, 5), "00 01 00");
  drive.status_now.alarm = true;
  EXPECT_EQ(get(1, 1, 5), "00 01 05");
  unit.on_connection(now, owner(), cip::IoEvent::kClosed);
  EXPECT_EQ(get(1, 1, 5), "00 00 05");
}

// 7.7: port object as printed.
TEST_F(FrA7neObjects, PortObjectIsThePrintedOne) {
  EXPECT_EQ(get(0xF4, 0, 1), "00 01 00");
  EXPECT_EQ(get(0xF4, 0, 2), "00 02 00");
  EXPECT_EQ(get(0xF4, 0, 3), "00 01 00");
  EXPECT_EQ(get(0xF4, 0, 8), "00 02 00");
  EXPECT_EQ(get(0xF4, 0, 9), "00 00 00 00 00 00 00 00 00 04 00 02 00");
  EXPECT_EQ(get(0xF4, 2, 1), "00 04 00");
  EXPECT_EQ(get(0xF4, 2, 2), "00 02 00");
  EXPECT_EQ(get(0xF4, 2, 3), "00 02 00 20 F5 24 01");
  EXPECT_EQ(get(0xF4, 2, 4), "00 06 54 43 50 2F 49 50");
  EXPECT_EQ(get(0xF4, 2, 7), "00 12 09 31 32 37 2E 30 2E 30 2E 32 00");
  EXPECT_EQ(set(0xF4, 2, 1, "04 00"), "0E");
}

TEST_F(FrA7neObjects, EveryGettableAttributeAnswersWithItsType) {
  fill_drive();
  for (const cip::AttributeRow& row : Unit::objects().rows()) {
    for (unsigned number = row.first; number <= row.last; ++number) {
      const std::string answer = ask(get_request(row.class_id, row.instance, number));
      const std::string_view what = row.name;
      if (!row.gettable) {
        EXPECT_EQ(answer, "14") << what;
        continue;
      }
      const bool encoder = what == "Position pulse" || what == "Orientation status" || what == "Feedback pulse";
      ASSERT_EQ(answer.substr(0, 2), encoder ? "14" : "00") << what << " " << number;
      if (encoder) continue;
      const Bytes value = from_hex(answer.substr(2));
      EXPECT_EQ(row.type.check(value), cip::GeneralStatus::kSuccess) << what << " " << answer;
    }
  }
}

TEST_F(FrA7neObjects, NothingElseAnswers) {
  fill_drive();
  for (const std::uint16_t class_id : Unit::objects().classes()) {
    for (const unsigned instance : {0u, 1u, 2u, 3u}) {
      const bool exists = Unit::objects().has_instance(class_id, instance);
      for (unsigned number = 0; number <= 256; ++number) {
        if (Unit::objects().find(class_id, instance, static_cast<std::uint16_t>(number)) != nullptr) continue;
        EXPECT_EQ(request(get_request(class_id, instance, number)), exists ? "14" : "16")
            << class_id << " " << instance << " " << number;
      }
    }
  }
  for (const unsigned class_id : {0u, 2u, 3u, 5u, 6u, 0x2Bu, 0x65u, 0x68u, 0x6Fu, 0x7Au, 0x81u, 0xF3u, 0xF7u, 0x101u}) {
    EXPECT_EQ(request(get_request(class_id, 1, 1)), "05") << class_id;
  }
}

// 7.6.1: exactly the printed attributes, without the gaps filled.
TEST_F(FrA7neObjects, AcDriveHasThePrintedAttributes) {
  std::set<unsigned> printed{3, 4, 6, 7, 8, 9, 15, 17, 18, 19, 20, 21, 29, 101, 102, 103, 105, 106, 112, 113, 114, 120};
  for (unsigned number = 141; number <= 148; ++number) printed.insert(number);
  for (unsigned number = 170; number <= 194; ++number) printed.insert(number);
  printed.erase(173);
  printed.erase(190);
  std::set<unsigned> here;
  for (const auto& row : Unit::objects().instance(0x2A, 1)) here.insert(row.first);
  EXPECT_EQ(here, printed);
}

TEST_F(FrA7neObjects, ServicesThatAreNotListedAreRefused) {
  for (const char* service : {"02", "03", "04", "06", "07", "08", "09", "0A", "0D", "11", "15", "16", "18", "4B"}) {
    EXPECT_EQ(request(std::string(service) + " 02 20 01 24 01"), "08") << service;
    EXPECT_EQ(request(std::string(service) + " 02 20 2A 24 01"), "08") << service;
  }
  EXPECT_EQ(request("10 03 20 01 24 01 30 01 00 00"), "08");
  EXPECT_EQ(request("10 03 20 80 24 01 30 0B 00 00"), "08");
  EXPECT_EQ(request("01 02 20 2A 24 01"), "08");
}

// 7.10 to 7.12: the numbers of all parameters.
TEST_F(FrA7neObjects, ParametersAreReadByTheirNumbers) {
  fill_drive();
  for (unsigned attribute = 10; attribute <= 206; ++attribute) {
    if (Unit::objects().find(0x66, 1, static_cast<std::uint16_t>(attribute)) == nullptr) continue;
    EXPECT_EQ(get(0x66, 1, attribute), "00 " + word(attribute - 10)) << attribute;
  }
  for (unsigned attribute = 212; attribute <= 249; ++attribute) {
    if (Unit::objects().find(0x66, 1, static_cast<std::uint16_t>(attribute)) == nullptr) continue;
    EXPECT_EQ(get(0x66, 1, attribute), "00 " + word(attribute + 20)) << attribute;
  }
  EXPECT_EQ(get(0x67, 1, 10), "00 " + word(270));
  EXPECT_EQ(get(0x67, 1, 38), "00 " + word(338));
  EXPECT_EQ(get(0x67, 1, 192), "00 " + word(500));
  EXPECT_EQ(get(0x67, 1, 202), "00 " + word(902));
  EXPECT_EQ(get(0x67, 1, 203), "00 " + word(2002));
  EXPECT_EQ(get(0x67, 1, 209), "00 " + word(2005));
  for (unsigned number = 0; number < 900; ++number) {
    if (number == 346 || number == 540 || (number >= 434 && number <= 445)) continue;
    EXPECT_EQ(request(get_request(0x70 + number / 100, 1, 10 + number % 100)), "00 " + word(number));
  }
  EXPECT_EQ(get(0x79, 1, 12), "00 " + word(902));
  EXPECT_EQ(get(0x79, 2, 12), "00 " + word(2002));
  EXPECT_EQ(get(0x79, 2, 50), "14");
  drive.calibration.clear();
  EXPECT_EQ(get(0x79, 1, 12), "14");
}

TEST_F(FrA7neObjects, ReadOnlyParametersAreSoInEveryClass) {
  fill_drive();
  for (const unsigned number : {77u, 79u, 173u, 174u, 255u, 259u, 345u, 346u}) {
    EXPECT_EQ(set(0x70 + number / 100, 1, 10 + number % 100, "00 00"), "0E") << number;
  }
  EXPECT_EQ(set(0x66, 1, 87, "00 00"), "0E");
  EXPECT_EQ(set(0x67, 1, 46, "00 00"), "0E");
  EXPECT_EQ(set(0x67, 1, 67, "00 00"), "0E");
  EXPECT_EQ(set(0x73, 1, 78, "00 00"), "0E");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(FrA7neObjects, MonitorsAreReadByTheirCodes) {
  fill_drive();
  for (const unsigned code : {1u, 2u, 3u, 5u, 6u, 7u, 8u, 16u, 17u, 18u, 20u, 23u, 24u, 25u}) {
    EXPECT_EQ(get(0x2A, 1, 169 + code), "00 " + word(code)) << code;
    EXPECT_EQ(get(0x80, 1, 10 + code), "00 " + word(code)) << code;
  }
  EXPECT_EQ(get(0x80, 1, 64), "00 " + word(54));
  for (const unsigned attribute : {68u, 69u, 70u}) EXPECT_EQ(get(0x80, 1, attribute), "00 00 00");
  for (const unsigned attribute : {29u, 32u, 45u}) EXPECT_EQ(get(0x80, 1, attribute), "14");
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
