// Objects declared as tables: what is checked before a value is given or taken, and in which order.
#include "option_boards/cip/table_object.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::cip {
namespace {

using test::from_hex;
using test::to_hex;

constexpr Instant kNow = instant_from_ns(1'000'000);

constexpr std::string_view kAttributes =
    "class,instance,attribute,last_attribute,name,type,access,min,max,default,binding,argument,detail,section\n"
    "0x01,0,1,,Revision,UINT,Get,,,1,constant,,,7.1.1\n"
    "0x01,1,1,,Vendor,UINT,Get,,,161,constant,,,7.1.2\n"
    "0x01,1,7,,Product name,SHORT_STRING,Get,,,\"A700\",constant,,,7.1.2\n"
    "0x64,1,5,,Limit,INT,Get/Set,-10,300,,word,3,,\n"
    "0x64,1,6,,Command,UINT,Set,,,,command,,,\n"
    "0x64,1,7,,Pair,STRUCT{USINT;USINT},Get/Set,,,,pair,,,\n"
    "0x70,1,10,19,Parameters,UINT,Get/Set,,,,word,0,,7.12\n"
    "0x70,2,10,,Broken,UINT,Get,,,,broken,,,\n";
constexpr std::string_view kServices =
    "class,last_class,instance,last_instance,service,name,binding,section\n"
    "0x01,,0,1,0x0E,Get_Attribute_Single,get_single,\n"
    "0x01,,1,,0x01,Get_Attributes_All,get_all,\n"
    "0x01,,1,,0x05,Reset,reset,\n"
    "0x64,0x70,1,2,0x0E,Get_Attribute_Single,get_single,\n"
    "0x64,0x70,1,2,0x10,Set_Attribute_Single,set_single,\n"
    "0x70,,2,,0x01,Get_Attributes_All,get_all,\n";

struct Host {
  std::array<std::int64_t, 10> words{0, 11, 22, 33, 44, 55, 66, 77, 88, 99};
  Bytes pair{1, 2};
  Bytes reset_data;
};

Got get_word(const Host& host, const Attribute& a) { return host.words[static_cast<std::size_t>(a.argument())]; }
SetResult set_word(Host& host, const SetRequest& s) {
  host.words[static_cast<std::size_t>(s.attribute.argument())] = s.number;
  return Handled::kAnswered;
}
SetResult refuse_command(Host&, const SetRequest&) { return Unexpected(Status(GeneralStatus::kObjectStateConflict)); }
GeneralStatus append_pair(const Host& host, const Attribute&, Bytes& out) {
  out.insert(out.end(), host.pair.begin(), host.pair.end());
  return GeneralStatus::kSuccess;
}
SetResult set_pair(Host& host, const SetRequest& s) {
  host.pair.assign(s.bytes.begin(), s.bytes.end());
  return Handled::kLater;
}
Got broken(const Host&, const Attribute&) { return Unexpected(GeneralStatus::kDeviceStateConflict); }
Handled reset(Host& host, Instant, const Request& request, Reply&) {
  host.reset_data.assign(request.data.begin(), request.data.end());
  return Handled::kAnswered;
}

constexpr std::array<Binding<Host>, 4> kBindings{{{"word", get_word, nullptr, set_word},
                                                  {"command", nullptr, nullptr, refuse_command},
                                                  {"pair", nullptr, append_pair, set_pair},
                                                  {"broken", broken}}};
constexpr std::array<OwnService<Host>, 1> kOwn{{{"reset", reset}}};

struct CipTableObject : testing::Test {
  AttributeTable table{kAttributes, names_of<Host>(std::span<const Binding<Host>>(kBindings)), kServices,
                       names_of<Host>(std::span<const OwnService<Host>>(kOwn))};
  Host host;
  BoundObject<Host> object{table, host, kBindings, kOwn};
  Reply reply;
  Handled handled = Handled::kAnswered;

  // The answer as hex: general status, then data.
  std::string ask(const char* request_hex) {
    const Bytes bytes = from_hex(request_hex);
    const auto parsed = parse_request(bytes);
    EXPECT_TRUE(parsed.request.has_value()) << request_hex;
    reply.clear();
    handled = object.handle(kNow, *parsed.request, reply);
    Bytes out{static_cast<std::uint8_t>(reply.status.general)};
    out.insert(out.end(), reply.data.begin(), reply.data.end());
    return to_hex(out);
  }
};

TEST_F(CipTableObject, BindingsHaveWhatTheRowsNeed) {
  EXPECT_TRUE(bindings_fit<Host>(table, kBindings));
  const std::array<Binding<Host>, 4> without_setter{{{"word", get_word}, kBindings[1], kBindings[2], kBindings[3]}};
  EXPECT_FALSE(bindings_fit<Host>(table, without_setter));
  EXPECT_EQ(table.classes(), (std::vector<std::uint16_t>{0x01, 0x64, 0x65, 0x66, 0x67, 0x68, 0x69, 0x6A, 0x6B, 0x6C,
                                                         0x6D, 0x6E, 0x6F, 0x70}));
}

TEST_F(CipTableObject, GivesConstantsAndBoundValues) {
  EXPECT_EQ(ask("0E 03 20 01 24 00 30 01"), "00 01 00");
  EXPECT_EQ(ask("0E 03 20 01 24 01 30 01"), "00 A1 00");
  EXPECT_EQ(ask("0E 03 20 01 24 01 30 07"), "00 04 41 37 30 30");
  EXPECT_EQ(ask("0E 03 20 64 24 01 30 05"), "00 21 00");
  EXPECT_EQ(ask("0E 03 20 70 24 01 30 0C"), "00 16 00");
  EXPECT_EQ(ask("0E 03 20 64 24 01 30 07"), "00 01 02");
}

TEST_F(CipTableObject, AllAttributesComeInOrder) {
  EXPECT_EQ(ask("01 02 20 01 24 01"), "00 A1 00 04 41 37 30 30");
  EXPECT_EQ(ask("01 02 20 01 24 01 00"), "15");
  EXPECT_EQ(ask("01 02 20 70 24 02"), "10");
}

TEST_F(CipTableObject, RefusalsComeInOrderInstanceServiceAttributeAccess) {
  EXPECT_EQ(ask("0E 03 20 01 24 02 30 01"), "16");
  EXPECT_EQ(ask("4B 03 20 01 24 02 30 01"), "16");
  EXPECT_EQ(ask("10 03 20 01 24 01 30 63 00 00"), "08");
  EXPECT_EQ(ask("01 02 20 01 24 00"), "08");
  EXPECT_EQ(ask("0E 03 20 01 24 01 30 02"), "14");
  EXPECT_EQ(ask("0E 02 20 01 24 01"), "14");
  EXPECT_EQ(ask("0E 03 20 64 24 01 30 06"), "14");
  EXPECT_EQ(ask("0E 04 20 01 24 01 30 01 28 01"), "28");
  EXPECT_EQ(ask("0E 03 20 01 24 01 30 01 00"), "15");
  EXPECT_EQ(ask("0E 03 20 70 24 02 30 0A"), "10");
  EXPECT_EQ(ask("10 03 20 64 24 01 30 63 00 00"), "14");
  EXPECT_EQ(ask("10 02 20 64 24 01"), "14");
  EXPECT_EQ(ask("10 03 20 70 24 02 30 0A 00 00"), "0E");
  EXPECT_EQ(ask("10 04 20 64 24 01 30 05 28 01 00 00"), "29");
}

TEST_F(CipTableObject, TakesValuesOfTheRightLengthWithinTheRange) {
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 2C 01"), "00");
  EXPECT_EQ(host.words[3], 300);
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 2D 01"), "09");
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 F6 FF"), "00");
  EXPECT_EQ(host.words[3], -10);
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 F5 FF"), "09");
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 01"), "13");
  EXPECT_EQ(ask("10 03 20 64 24 01 30 05 01 00 00"), "15");
  EXPECT_EQ(host.words[3], -10);
  EXPECT_EQ(ask("10 03 20 70 24 01 30 13 FF FF"), "00");
  EXPECT_EQ(host.words[9], 0xFFFF);
}

TEST_F(CipTableObject, SettersRefuseAndDefer) {
  EXPECT_EQ(ask("10 03 20 64 24 01 30 06 01 00"), "0C");
  EXPECT_EQ(handled, Handled::kAnswered);
  ask("10 03 20 64 24 01 30 07 08 09");
  EXPECT_EQ(handled, Handled::kLater);
  EXPECT_EQ(host.pair, (Bytes{8, 9}));
}

TEST_F(CipTableObject, OwnServicesGetTheRequest) {
  EXPECT_EQ(ask("05 02 20 01 24 01 01"), "00");
  EXPECT_EQ(host.reset_data, Bytes{1});
}

}  // namespace
}  // namespace vinv::cip
