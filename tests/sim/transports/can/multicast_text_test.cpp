#include "sim/transports/can/multicast_text.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/base/random.hpp"
#include "sim/transports/can/number_text.hpp"

namespace vinv::transports {
namespace {

Bytes bytes_of(const std::string& hex) {
  Bytes out;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(*parse_hex(std::string_view(hex).substr(i, 2))));
  }
  return out;
}

// As python-can 4.1 packs can.Message(arbitration_id=0x123, data=[1, 2, 3], is_extended_id=False).
const std::string kData =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f6964cd0123ae69735f657874656e6465645f6964c2af6973"
    "5f"
    "72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6303a464617461c403010203a569735f"
    "66"
    "64c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";
// can.Message(arbitration_id=0x18ff1234, is_remote_frame=True, dlc=3, channel="x", timestamp=1.5)
const std::string kRemote =
    "8ba974696d657374616d70cb3ff8000000000000ae6172626974726174696f6e5f6964ce18ff1234ae69735f657874656e6465645f6964c3af"
    "69"
    "735f72656d6f74655f6672616d65c3ae69735f6572726f725f6672616d65c2a76368616e6e656ca178a3646c6303a464617461c400a569735f"
    "66"
    "64c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";

TEST(MulticastText, ReadsWhatPythonCanPacks) {
  EXPECT_EQ(parse_multicast_datagram(bytes_of(kData)), CanFrame::standard(0x123, {1, 2, 3}));
  CanFrame remote = CanFrame::remote_request(0x18ff1234, 3);
  remote.extended = true;
  EXPECT_EQ(parse_multicast_datagram(bytes_of(kRemote)), remote);
  EXPECT_EQ(parse_multicast_datagram(multicast_datagram(remote, 1.5)), remote);
}

TEST(MulticastText, FdAndErrorFramesAreNone) {
  Bytes fd = bytes_of(kData);
  const std::size_t at = kData.find("69735f6664c2") / 2 + 5;
  fd[at] = 0xc3;
  EXPECT_FALSE(parse_multicast_datagram(fd));
  Bytes error = bytes_of(kData);
  error[kData.find("6672616d65c2a7") / 2 + 5] = 0xc3;
  EXPECT_FALSE(parse_multicast_datagram(error));
}

TEST(MulticastText, DamagedDatagramsAreNoneAndHarmless) {
  const Bytes good = bytes_of(kData);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(parse_multicast_datagram(ByteView(good).subspan(0, size))) << size;
  }
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bad = good;
    for (int k = 0; k < 3; ++k) bad[random.below(bad.size())] = static_cast<std::uint8_t>(random.next());
    const auto frame = parse_multicast_datagram(bad);
    if (frame) {
      EXPECT_LE(frame->length, 8);
    }
  }
  EXPECT_FALSE(parse_multicast_datagram(Bytes{0x80}));
  EXPECT_FALSE(parse_multicast_datagram(Bytes{0xde, 0xff, 0xff}));
}

}  // namespace
}  // namespace vinv::transports
