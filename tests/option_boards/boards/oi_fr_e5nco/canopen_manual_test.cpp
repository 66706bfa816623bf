// The manual's own tables, line by line, asked for on the wire: the object lists of 6.2, 7 and 11 with their access,
// the abort codes of 6.1, the codes of the emergency message of 6.3. The lists here are typed from the manual and not
// taken from the board's tables.
#include <set>

#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

class OiFrE5ncoCanopenManual : public CanopenBench {
 protected:
  OiFrE5ncoCanopenManual() {
    for (const std::uint16_t n : {2, 8, 20, 45}) drive.parameters[n] = {50, 0, 36000};
    drive.parameters[21] = {0, 0, 1};
    drive.parameters[999] = {1, 0, 1};
    for (std::uint16_t n = 902; n <= 905; ++n) drive.calibration[{n, 1}] = drive.calibration[{n, 2}] = {100, 0, 1000};
  }
};

struct Line {
  unsigned first, last, first_sub, last_sub;
  const char* access;
  unsigned bytes;
};

// Sub-index 0 of a record is its number of entries and read only (DS-301); the manual gives such ranges one access.
TEST_F(OiFrE5ncoCanopenManual, EveryObjectHasThePrintedAccess) {
  const Line lines[] = {
      // 6.2 and 11.1
      {0x0006, 0x0006, 0, 0, "RO", 4},
      {0x1000, 0x1000, 0, 0, "RO", 4},
      {0x1001, 0x1001, 0, 0, "RO", 1},
      {0x1002, 0x1002, 0, 0, "RO", 4},
      {0x1005, 0x1005, 0, 0, "RW", 4},
      {0x1008, 0x100a, 0, 0, "RO", 4},
      {0x100b, 0x100b, 0, 0, "RO", 4},
      {0x100c, 0x100c, 0, 0, "RW", 2},
      {0x100d, 0x100d, 0, 0, "RW", 1},
      {0x1011, 0x1011, 0, 0, "RW", 4},
      {0x1014, 0x1014, 0, 0, "RW", 4},
      {0x1400, 0x1403, 0, 0, "RO", 1},
      {0x1400, 0x1403, 1, 1, "RW", 4},
      {0x1400, 0x1403, 2, 2, "RW", 1},
      {0x1600, 0x1603, 0, 0, "RW", 1},
      {0x1600, 0x1603, 1, 4, "RW", 4},
      {0x1800, 0x1803, 0, 0, "RO", 1},
      {0x1800, 0x1803, 1, 1, "RW", 4},
      {0x1800, 0x1803, 2, 2, "RW", 1},
      {0x1800, 0x1803, 3, 3, "RW", 2},
      {0x1800, 0x1803, 4, 4, "RW", 1},
      {0x1800, 0x1803, 5, 5, "RW", 2},
      {0x1a00, 0x1a03, 0, 0, "RW", 1},
      {0x1a00, 0x1a03, 1, 4, "RW", 4},
      {0x2000, 0x2002, 0, 0, "RO", 2},
      {0x2106, 0x2107, 0, 0, "WO", 2},
      {0x3000, 0x3000, 0, 0, "RW", 2},
      {0x3386, 0x3389, 0, 0, "RO", 1},
      {0x3386, 0x3389, 1, 2, "RW", 2},
      {0x33e7, 0x33e7, 0, 0, "RW", 2},
      {0x3400, 0x3403, 0, 0, "RO", 2},
      {0x4000, 0x4000, 0, 0, "RW", 2},
      {0x4001, 0x4001, 0, 1, "RW", 2},
      {0x4001, 0x4001, 2, 2, "WO", 2},
      // 7 and 11.2
      {0x6007, 0x6007, 0, 0, "RW", 2},
      {0x6040, 0x6040, 0, 0, "RW", 2},
      {0x6041, 0x6041, 0, 0, "RO", 2},
      {0x6042, 0x6042, 0, 0, "RW", 2},
      {0x6043, 0x6044, 0, 0, "RO", 2},
      {0x6046, 0x6046, 0, 0, "RO", 1},
      {0x6046, 0x6046, 1, 2, "RW", 4},
      {0x6048, 0x604a, 0, 0, "RO", 1},
      {0x6048, 0x604a, 1, 1, "RW", 4},
      {0x6048, 0x604a, 2, 2, "RW", 2},
      {0x6060, 0x6060, 0, 0, "WO", 1},
      {0x6061, 0x6061, 0, 0, "RO", 1},
      {0x67ff, 0x67ff, 0, 0, "RO", 4},
      {0x6fff, 0x6fff, 0, 0, "RO", 4},  // 7.15
  };
  for (const Line& line : lines) {
    for (unsigned index = line.first; index <= line.last; ++index) {
      for (unsigned sub = line.first_sub; sub <= line.last_sub; ++sub) {
        SCOPED_TRACE(hex(index, 4) + ":" + std::to_string(sub));
        const std::string value = read(index, sub);
        if (line.access[0] == 'W') {
          EXPECT_EQ(value, "06010001");
        } else {
          EXPECT_EQ(value.size(), 1 + 2 * line.bytes) << value;
        }
        // In a wrong length nothing is written, and a read-only object says so first.
        EXPECT_EQ(write(index, sub, 0, line.bytes == 2 ? 1 : 2),
                  std::string(line.access) == "RO" ? "06010002" : "06070010");
      }
    }
  }
  EXPECT_TRUE(drive.posted.empty());
}

// 6.1
TEST_F(OiFrE5ncoCanopenManual, EveryAbortCodeIsGiven) {
  std::set<std::string> given;
  const auto expect = [&](const char* code, const std::string& got) {
    EXPECT_EQ(got, code);
    given.insert(got);
  };
  expect("06020000", read(0x1018));
  expect("06090011", read(0x1000, 1));
  expect("06070010", write(0x100c, 0, 1, 4));
  expect("06010002", write(0x1000, 0, 0, 4));
  expect("06010001", read(0x2106));
  expect("08000021", write(0x4000, 0, 2, 2));  // the terminals command
  network();
  drive.ticks_to_decide = 1000;
  frames.clear();
  receive_frame(sdo(0x2b, 0x4000, 0, 2));
  drive.lose_mailbox();
  advance(2ms);
  expect("08000000", answer(0x4000, 0));
  drive.ticks_to_decide = 1;
  drive.status_now.running = true;
  expect("08000022", write(0x3007, 0, 60, 2));
  drive.status_now.running = false;
  drive.storage_fails = true;
  expect("06060000", write(0x3007, 0, 60, 2));
  drive.storage_fails = false;
  expect("06040041", write(0x1601, 1, 0x10000020, 4));
  for (unsigned sub = 1; sub <= 3; ++sub) EXPECT_EQ(write(0x1a01, sub, 0x10020020, 4), "ok");
  expect("06040042", write(0x1a01, 0, 3, 1));
  expect("06090030", write(0x6007, 0, 4, 2));
  EXPECT_EQ(given.size(), 12u);  // all of the table
  EXPECT_EQ(tell("619#2100400002000000"), "599#8000400001000405");
}

// 6.3: byte 3 and what stands in the bytes behind it.
TEST_F(OiFrE5ncoCanopenManual, EveryCodeOfTheEmergencyMessageIsSent) {
  map(0x1601, {0x30070010});
  EXPECT_EQ(write(0x1800, 2, 252, 1), "ok");
  network();
  tell("319#");
  EXPECT_EQ(tell("319#FFFF"), "099#0000000000050000");  // a good one after a short one
  EXPECT_EQ(wait(5ms), "099#0010001511050000");         // Pr.7 ends at 36000
  EXPECT_EQ(tell("199#R8"), "099#0082002C00050000");
  drive.storage_fails = true;
  tell("319#3300");
  EXPECT_EQ(wait(5ms), "099#3055003E00050000");
  EXPECT_EQ(tell("319#"), "099#1082112A00050000");
  tell("000#8019");
  EXPECT_EQ(write(0x100c, 0, 10, 2), "ok");
  EXPECT_EQ(write(0x100d, 0, 1, 1), "ok");
  tell("719#R1");
  EXPECT_EQ(wait(15ms), "099#3081111F007F0000");
  tell("000#0219");
  alarm(0x22);
  wait(60ms);
  EXPECT_EQ(tell("000#8019"), "099#1032150022040000");
}

// 4.2: the other commands that are no OPERATIONAL, from every state.
TEST_F(OiFrE5ncoCanopenManual, EveryOtherNmtCommandEndsNetworkOperation) {
  for (const char* before : {"000#0119", "000#0219", "000#8019"}) {
    for (const char* command : {"000#0219", "000#8019", "000#8119", "000#8219"}) {
      tell(before);
      wait(5ms);
      drive.mode = port::OperationMode::kNetwork;
      tell(command);
      wait(5ms);
      EXPECT_EQ(drive.mode, port::OperationMode::kExternal) << before << " " << command;
    }
  }
}

}  // namespace
}  // namespace vinv::test
