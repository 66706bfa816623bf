// The whole dictionary: every object and sub-index is read, written in and out of range, in the wrong length, and asked
// for a sub-index that it does not have. OI-FR-E5NCO manual, 6.2, 7 and 11.
#include <map>
#include <set>

#include "option_boards/boards/oi_fr_e5nco/canopen_unit.hpp"
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

using boards::oi_fr_e5nco::object_table;
using canopen::ObjectRow;

class OiFrE5ncoCanopenSweep : public CanopenBench {
 protected:
  OiFrE5ncoCanopenSweep() {
    for (std::uint16_t n = 0; n < 1000; ++n) {
      if (n >= 902 && n <= 905) {
        drive.calibration[{n, 1}] = {n, 0, 40000};
        drive.calibration[{n, 2}] = {n, 0, 1000};
      } else if (n != 345 && n != 346 && n != 347 && n != 144 && n != 21) {
        drive.parameters[n] = {n, 0, 40000};
      }
    }
    drive.parameters[346] = {132, 0, 255};
    drive.parameters[21] = {0, 0, 1};
    network();
  }
  template <class F>
  void for_each_object(F visit) {
    for (const ObjectRow& row : object_table().rows()) {
      for (unsigned index = row.first; index <= row.last; ++index) {
        for (unsigned sub = row.first_sub; sub <= row.last_sub; ++sub) {
          SCOPED_TRACE(hex(index, 4) + ":" + std::to_string(sub));
          visit(row, index, sub);
        }
      }
    }
  }
};

TEST_F(OiFrE5ncoCanopenSweep, EveryReadHasTheTypesLength) {
  for_each_object([&](const ObjectRow& row, unsigned index, unsigned sub) {
    const std::string value = read(index, sub);
    if (!row.readable) {
      EXPECT_EQ(value, "06010001");
    } else {
      EXPECT_EQ(value.size(), 1 + 2 * size_of(row.type)) << value;
    }
  });
}

TEST_F(OiFrE5ncoCanopenSweep, ReadOnlyObjectsAreNotWritten) {
  for_each_object([&](const ObjectRow& row, unsigned index, unsigned sub) {
    if (!row.writable) {
      EXPECT_EQ(write(index, sub, 0, size_of(row.type)), "06010002");
    }
  });
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenSweep, WrongLengthsAreRefusedEverywhere) {
  for_each_object([&](const ObjectRow& row, unsigned index, unsigned sub) {
    if (!row.writable || (index > 0x3010 && index < 0x3380)) return;
    for (unsigned size = 1; size <= 4; ++size) {
      if (size == size_of(row.type)) continue;
      EXPECT_EQ(write(index, sub, 0, size), "06070010") << size;
    }
  });
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenSweep, WhatWasReadIsTakenBack) {
  for_each_object([&](const ObjectRow& row, unsigned index, unsigned sub) {
    if (!row.writable || !row.readable) return;
    // Commands read back as status; the mapping and the inhibit time of a valid PDO stand.
    if (index == 0x1011 || index == 0x4000) return;
    if (index == 0x1600 || index == 0x1a00 || (index == 0x1800 && sub == 3)) return;
    const std::string value = read(index, sub);
    ASSERT_EQ(value[0], '=');
    const auto raw = static_cast<std::uint32_t>(std::stoul(value.substr(1), nullptr, 16));
    EXPECT_EQ(write(index, sub, raw, size_of(row.type)), "ok") << value;
    EXPECT_EQ(read(index, sub), value);
  });
}

TEST_F(OiFrE5ncoCanopenSweep, OneBelowAndOneAboveTheRangeAreRefused) {
  unsigned tried = 0;
  for_each_object([&](const ObjectRow& row, unsigned index, unsigned sub) {
    if (!row.writable) return;
    const std::int64_t type_max = (std::int64_t{1} << 8 * size_of(row.type)) - 1;
    const bool has_sign =
        row.min < 0 || row.type == canopen::DataType::kInteger8 || row.type == canopen::DataType::kInteger16;
    if (row.max < (has_sign ? type_max / 2 : type_max)) {
      ++tried;
      EXPECT_EQ(write(index, sub, static_cast<std::uint32_t>(row.max + 1), size_of(row.type)), "06090030");
    }
    if (row.min > 0 || (has_sign && row.min > -type_max / 2 - 1)) {
      ++tried;
      EXPECT_EQ(write(index, sub, static_cast<std::uint32_t>(row.min - 1), size_of(row.type)), "06090030");
    }
  });
  EXPECT_GT(tried, 15u);
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenSweep, SubIndexPastTheLastIsMissing) {
  std::map<unsigned, unsigned> last;
  for_each_object([&](const ObjectRow&, unsigned index, unsigned sub) { last[index] = std::max(last[index], sub); });
  for (const auto& [index, sub] : last) {
    EXPECT_EQ(read(index, sub + 1), "06090011") << index;
    EXPECT_EQ(write(index, sub + 1, 0, 2), "06090011") << index;
    EXPECT_EQ(read(index, 255), "06090011") << index;
  }
}

TEST_F(OiFrE5ncoCanopenSweep, EveryOtherIndexIsMissing) {
  std::set<unsigned> known;
  for_each_object([&](const ObjectRow&, unsigned index, unsigned) { known.insert(index); });
  EXPECT_EQ(known.size(), 13u + 16 + 3 + 2 + 1000 + 4 + 2 + 14);
  unsigned wrong = 0;
  for (unsigned index = 0; index <= 0xffff; ++index) {
    if (known.count(index) != 0) continue;
    receive_frame(sdo(0x40, index, 0));
    wrong += frames.size() != 1 || text_of(frames[0].frame).substr(12) != "00000206" ? 1u : 0u;
    frames.clear();
  }
  EXPECT_EQ(wrong, 0u);
}

TEST_F(OiFrE5ncoCanopenSweep, EveryParameterIsReadAndWritten) {
  for (std::uint16_t n = 0; n < 1000; ++n) {
    if ((n >= 902 && n <= 905) || n == 144 || n == 345 || n == 346 || n == 347) continue;
    EXPECT_EQ(read(0x3000u + n), "=" + hex(drive.parameters[n].value, 4)) << n;
    const std::uint32_t value = drive.parameters[n].max;
    EXPECT_EQ(write(0x3000u + n, 0, value, 2), "ok") << n;
    EXPECT_EQ(drive.parameters[n].value, value) << n;
    EXPECT_EQ(write(0x3000u + n, 0, value + 1, 2), "06090030") << n;
  }
}

TEST_F(OiFrE5ncoCanopenSweep, CalibrationParametersHaveTwoWords) {
  for (unsigned n = 902; n <= 905; ++n) {
    const unsigned index = 0x3000 + n;
    EXPECT_EQ(read(index, 0), "=02");
    EXPECT_EQ(write(index, 0, 2, 1), "06010002");
    for (std::uint8_t sub = 1; sub <= 2; ++sub) {
      EXPECT_EQ(read(index, sub), "=" + hex(n, 4));
      EXPECT_EQ(write(index, sub, 700u + sub, 2), "ok");
      EXPECT_EQ((drive.calibration[{static_cast<std::uint16_t>(n), sub}].value), 700u + sub);
    }
    EXPECT_EQ(write(index, 2, 1001, 2), "06090030");
  }
  EXPECT_EQ(read(0x3089), "=0089");  // the misprint of Pr.905 is Pr.137
}

TEST_F(OiFrE5ncoCanopenSweep, ParameterThatTheFamilyDoesNotHaveIsNoObject) {
  drive.parameters.erase(500);
  drive.calibration.erase({903, 1});
  drive.calibration.erase({903, 2});
  for (const unsigned sub : {0u, 1u}) {
    EXPECT_EQ(read(0x31f4, sub), "06020000");
    EXPECT_EQ(write(0x31f4, sub, 0, 2), "06020000");
    EXPECT_EQ(read(0x3387, sub), "06020000");
  }
}

TEST_F(OiFrE5ncoCanopenSweep, RefusedParametersHaveTheirReasons) {
  drive.parameters[8].read_only = true;
  EXPECT_EQ(write(0x3008, 0, 8, 2), "06010002");
  drive.write_disabled = true;
  EXPECT_EQ(write(0x3009, 0, 8, 2), "08000022");
  drive.write_disabled = false;
  drive.status_now.running = true;
  EXPECT_EQ(write(0x3009, 0, 8, 2), "08000022");
}

}  // namespace
}  // namespace vinv::test
