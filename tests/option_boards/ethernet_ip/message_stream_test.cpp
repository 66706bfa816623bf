// Encapsulation messages in a stream of bytes. CIP Vol 2, 2-3.
#include "option_boards/ethernet_ip/message_stream.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using test::encapsulated;
using test::join;
using test::to_hex;

class MessageStreamTest : public ::testing::Test {
 protected:
  // All messages of these bytes as "command:data".
  std::vector<std::string> feed(ByteView bytes) {
    std::vector<std::string> found;
    while (const auto m = stream.take(now, bytes))
      found.push_back(std::to_string(m->header.command) + ":" + (m->oversized ? "too long" : to_hex(m->data)));
    EXPECT_TRUE(bytes.empty());
    return found;
  }
  Instant now = instant_from_ns(1'000'000'000);
  MessageStream stream;
};

TEST_F(MessageStreamTest, SeveralMessagesInOnePiece) {
  const Bytes bytes = join({encapsulated(4, 0, {}), encapsulated(0x6f, 7, {1, 2, 3}), encapsulated(0, 0, {9})});
  EXPECT_EQ(feed(bytes), (std::vector<std::string>{"4:", "111:01 02 03", "0:09"}));
  EXPECT_FALSE(stream.deadline());
}

TEST_F(MessageStreamTest, EveryCutGivesTheSameMessages) {
  const Bytes bytes = join({encapsulated(0x6f, 7, {1, 2, 3}), encapsulated(4, 0, {}), encapsulated(0x70, 1, {4})});
  for (std::size_t a = 0; a <= bytes.size(); ++a) {
    for (std::size_t b = a; b <= bytes.size(); b += 3) {
      std::vector<std::string> found;
      for (const ByteView part :
           {ByteView(bytes).first(a), ByteView(bytes).subspan(a, b - a), ByteView(bytes).subspan(b)})
        for (const auto& text : feed(part)) found.push_back(text);
      ASSERT_EQ(found, (std::vector<std::string>{"111:01 02 03", "4:", "112:04"})) << a << " " << b;
    }
  }
}

TEST_F(MessageStreamTest, TooLongIsReportedOnceAndSkipped) {
  Bytes bytes = encapsulated(0x6f, 7, Bytes(kMaxEncapsulatedData + 1, 0xaa));
  const Bytes next = encapsulated(4, 0, {});
  bytes.insert(bytes.end(), next.begin(), next.end());
  std::vector<std::string> found;
  for (std::size_t at = 0; at < bytes.size(); at += 1000)
    for (const auto& text : feed(ByteView(bytes).subspan(at, std::min<std::size_t>(1000, bytes.size() - at))))
      found.push_back(text);
  EXPECT_EQ(found, (std::vector<std::string>{"111:too long", "4:"}));
  EXPECT_FALSE(stream.deadline()) << "it is behind us";
}

TEST_F(MessageStreamTest, LongestMessageFits) {
  EXPECT_EQ(feed(encapsulated(0x6f, 7, Bytes(kMaxEncapsulatedData, 0))).size(), 1u);
}

TEST_F(MessageStreamTest, DeadlineRunsFromTheFirstByteOfAMessage) {
  const Bytes bytes = encapsulated(4, 0, {});
  feed(ByteView(bytes).first(1));
  const Instant first = now;
  now += std::chrono::seconds(3);
  feed(ByteView(bytes).subspan(1, 20));
  EXPECT_EQ(stream.deadline(), first + kPartialMessageTimeout);
  feed(ByteView(bytes).subspan(21));
  EXPECT_FALSE(stream.deadline());
}

}  // namespace
}  // namespace vinv::ethernet_ip
