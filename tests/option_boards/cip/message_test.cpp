// CIP Vol 1, 2-4: message router request and reply; DeviceNet message body formats; 3-5.5.4: Unconnected_Send.
#include "option_boards/cip/message.hpp"

#include <gtest/gtest.h>

#include "option_boards/cip/identity.hpp"
#include "option_boards/cip/unconnected_send.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::cip {
namespace {

using test::from_hex;
using test::to_hex;

TEST(CipMessage, RequestHasServicePathAndData) {
  const Bytes bytes = from_hex("10 03 20 2A 24 01 30 08 DC 05");
  const auto parsed = parse_request(bytes);
  ASSERT_TRUE(parsed.request.has_value());
  EXPECT_EQ(parsed.service, 0x10);
  EXPECT_TRUE(parsed.request->is(Service::kSetAttributeSingle));
  EXPECT_EQ(parsed.request->path, (ObjectPath{0x2A, 1, 8, {}}));
  EXPECT_EQ(to_hex(parsed.request->data), "DC 05");
  Bytes again;
  append_request(again, *parsed.request);
  EXPECT_EQ(again, bytes);
}

TEST(CipMessage, RequestThatDoesNotHoldTogetherIsRefused) {
  EXPECT_EQ(parse_request({}).request.error(), GeneralStatus::kNotEnoughData);
  EXPECT_EQ(parse_request(from_hex("0E")).request.error(), GeneralStatus::kNotEnoughData);
  EXPECT_EQ(parse_request(from_hex("0E 03 20 01 24 01")).request.error(), GeneralStatus::kPathSizeInvalid);
  EXPECT_EQ(parse_request(from_hex("0E 00")).request.error(), GeneralStatus::kPathSegmentError);
  const auto reply = parse_request(from_hex("8E 02 20 01 24 01"));
  EXPECT_EQ(reply.service, 0x0E);
  EXPECT_EQ(reply.request.error(), GeneralStatus::kServiceNotSupported);
}

TEST(CipMessage, ReplyCarriesStatusWordsAndData) {
  Bytes out;
  append_reply(out, 0x0E, {{}, from_hex("A1 00")});
  EXPECT_EQ(to_hex(out), "8E 00 00 00 A1 00");
  out.clear();
  append_reply(out, 0x54, {{GeneralStatus::kConnectionFailure, 0x0127, 10}, {}});
  EXPECT_EQ(to_hex(out), "D4 00 01 02 27 01 0A 00");
  const auto parsed = parse_reply(out);
  ASSERT_TRUE(parsed.has_value());
  EXPECT_EQ(parsed->service, 0x54);
  EXPECT_EQ(parsed->status, (Status{GeneralStatus::kConnectionFailure, 0x0127, 10}));
  EXPECT_TRUE(parsed->data.empty());
  for (const char* bad : {"", "8E 00 00", "0E 00 00 00", "8E 00 01 01", "8E 00 01 02 00 00 00"}) {
    EXPECT_FALSE(parse_reply(from_hex(bad)).has_value()) << bad;
  }
}

TEST(CipMessage, DeviceNetPutsTheAttributeIntoTheData) {
  const Bytes data = from_hex("08 DC 05");
  const auto set = request_without_path(0x10, 0x2A, 1, data);
  ASSERT_TRUE(set.has_value());
  EXPECT_EQ(set->path, (ObjectPath{0x2A, 1, 8, {}}));
  EXPECT_EQ(to_hex(set->data), "DC 05");
  const auto reset = request_without_path(0x05, 1, 1, data);
  EXPECT_EQ(reset->path, (ObjectPath{1, 1, {}, {}}));
  EXPECT_EQ(reset->data.size(), 3u);
  EXPECT_EQ(request_without_path(0x0E, 1, 1, {}).error(), GeneralStatus::kNotEnoughData);
}

TEST(CipUnconnectedSend, HoldsARequestAndItsRoute) {
  // Get_Attribute_Single of the vendor, to slot 0 behind port 1; a tick is 8 ms.
  const Bytes bytes = from_hex("03 FA 08 00 0E 03 20 01 24 01 30 01 01 00 01 00");
  const auto send = parse_unconnected_send(bytes);
  ASSERT_TRUE(send.has_value());
  EXPECT_EQ(send->timeout(), std::chrono::milliseconds(2000));
  EXPECT_EQ(to_hex(send->message), "0E 03 20 01 24 01 30 01");
  EXPECT_EQ(to_hex(send->route_path), "01 00");
  Bytes again;
  append_unconnected_send(again, *send);
  EXPECT_EQ(again, bytes);
}

TEST(CipUnconnectedSend, OddMessagesArePadded) {
  const Bytes bytes = from_hex("00 01 03 00 05 00 01 00 00 00");
  const auto send = parse_unconnected_send(bytes);
  ASSERT_TRUE(send.has_value());
  EXPECT_EQ(to_hex(send->message), "05 00 01");
  EXPECT_TRUE(send->route_path.empty());
  Bytes again;
  append_unconnected_send(again, *send);
  EXPECT_EQ(again, bytes);
}

TEST(CipUnconnectedSend, LengthsThatDoNotFitAreRefused) {
  using enum GeneralStatus;
  struct Row {
    const char* bytes;
    GeneralStatus status;
  };
  for (const Row& row :
       {Row{"", kNotEnoughData}, Row{"03 FA 08", kNotEnoughData},
        Row{"03 FA 08 00 0E 03 20 01 24 01 30 01", kNotEnoughData}, Row{"03 FA FF FF 0E 03", kNotEnoughData},
        Row{"00 01 01 00 0E 00 01 00 01", kNotEnoughData}, Row{"00 01 01 00 0E 00 00 00 01", kTooMuchData},
        Row{"00 01 01 00 0E 01 00 00", kInvalidParameter}, Row{"00 01 02 00 0E 00 00 01", kInvalidParameter}}) {
    const auto send = parse_unconnected_send(from_hex(row.bytes));
    ASSERT_FALSE(send.has_value()) << row.bytes;
    EXPECT_EQ(send.error(), row.status) << row.bytes;
  }
}

TEST(CipUnconnectedSend, RouteOfADeviceWithoutPortsEndsThere) {
  Reply reply;
  UnconnectedSend send;
  EXPECT_TRUE(route_ends_here(send, reply));
  const Bytes backplane = from_hex("01 00 12 02 31 32");
  send.route_path = backplane;
  EXPECT_FALSE(route_ends_here(send, reply));
  Bytes out;
  append_reply(out, kUnconnectedSend, reply);
  EXPECT_EQ(to_hex(out), "D2 00 01 01 11 03 03 00");
  const Bytes object = from_hex("20 01 24 01");
  send.route_path = object;
  EXPECT_FALSE(route_ends_here(send, reply));
  EXPECT_EQ(reply.status, (Status{GeneralStatus::kConnectionFailure, kInvalidSegmentInPath}));
}

TEST(CipIdentity, KeyMatchesWhatItNames) {
  const Identity is{161, 2, 56, 1, 10, 7, "A700"};
  EXPECT_EQ(match_key({}, is), KeyMatch::kMatches);
  EXPECT_EQ(match_key({161, 2, 56, 1, false, 10}, is), KeyMatch::kMatches);
  EXPECT_EQ(match_key({160, 0, 0, 0, false, 0}, is), KeyMatch::kVendorOrProductCode);
  EXPECT_EQ(match_key({0, 0, 55, 0, false, 0}, is), KeyMatch::kVendorOrProductCode);
  EXPECT_EQ(match_key({0, 1, 0, 0, false, 0}, is), KeyMatch::kDeviceType);
  EXPECT_EQ(match_key({0, 0, 0, 2, false, 0}, is), KeyMatch::kRevision);
  EXPECT_EQ(match_key({0, 0, 0, 1, false, 9}, is), KeyMatch::kRevision);
  EXPECT_EQ(match_key({0, 0, 0, 1, true, 9}, is), KeyMatch::kMatches);
  EXPECT_EQ(match_key({0, 0, 0, 1, true, 11}, is), KeyMatch::kRevision);
  EXPECT_EQ(match_key({0, 0, 0, 1, true, 10}, is), KeyMatch::kMatches);
  EXPECT_EQ(match_key({0, 0, 0, 1, true, 0}, is), KeyMatch::kRevision) << "what a device is compatible with has a name";
  EXPECT_EQ(match_key({0, 0, 0, 0, true, 9}, is), KeyMatch::kRevision);
  EXPECT_EQ(match_key({0, 0, 0, 2, true, 9}, is), KeyMatch::kRevision);
  EXPECT_EQ(match_key({0, 0, 0, 0, false, 9}, is), KeyMatch::kMatches) << "any major has any minor";
}

}  // namespace
}  // namespace vinv::cip
