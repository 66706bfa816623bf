#include "sim/transports/parity_marks.hpp"

#include <gtest/gtest.h>

namespace vinv::transports {
namespace {

// termios(3), PARMRK.
TEST(ParityMarks, PlainBytesAndEscapedFfPass) {
  ParityMarks marks;
  Bytes out;
  EXPECT_FALSE(marks.decode(Bytes{1, 0, 0xff, 0xff, 2}, out));
  EXPECT_EQ(out, (Bytes{1, 0, 0xff, 2}));
}

TEST(ParityMarks, AMarkedByteComesThroughAsWrong) {
  ParityMarks marks;
  Bytes out;
  EXPECT_TRUE(marks.decode(Bytes{1, 0xff, 0, 0x42, 2}, out));
  EXPECT_EQ(out, (Bytes{1, 0x42, 2}));
  out.clear();
  EXPECT_TRUE(marks.decode(Bytes{0xff, 0, 0}, out));  // a break
  EXPECT_EQ(out, (Bytes{0}));
  out.clear();
  EXPECT_TRUE(marks.decode(Bytes{0xff, 0, 0xff}, out));  // FF itself, wrong
  EXPECT_EQ(out, (Bytes{0xff}));
}

TEST(ParityMarks, AMarkMayBeCutAnywhere) {
  const Bytes marked{5, 0xff, 0, 0x42, 0xff, 0xff, 6};
  for (std::size_t cut = 0; cut <= marked.size(); ++cut) {
    ParityMarks marks;
    Bytes out;
    const bool first = marks.decode(ByteView(marked).first(cut), out);
    const bool second = marks.decode(ByteView(marked).subspan(cut), out);
    EXPECT_NE(first, second) << cut;
    EXPECT_EQ(out, (Bytes{5, 0x42, 0xff, 6})) << cut;
  }
}

TEST(ParityMarks, AnUndocumentedMarkKeepsItsBytesAndIsWrong) {
  ParityMarks marks;
  Bytes out;
  EXPECT_TRUE(marks.decode(Bytes{0xff, 7, 8}, out));
  EXPECT_EQ(out, (Bytes{0xff, 7, 8}));
}

}  // namespace
}  // namespace vinv::transports
