// A slave with a small dictionary of its own and an application that does what the test says; time jumps from deadline
// to deadline. Node 5.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "option_boards/canopen/slave.hpp"
#include "tests/option_boards/canopen/can_text.hpp"

namespace vinv::test {

using namespace std::chrono_literals;

inline constexpr std::string_view kSlaveTable =
    "first,last,sub_first,sub_last,type,access,pdo,item,argument,default,min,max,name\n"
    "0005,,0,,UNSIGNED32,RO,r,constant,,8,,,dummy byte\n"
    "0006,,0,,UNSIGNED32,RO,r,constant,,16,,,dummy word\n"
    "1000,,0,,UNSIGNED32,RO,,constant,,0x10192,,,device type\n"
    "1001,,0,,UNSIGNED8,RO,t,error_register,,,,,\n"
    "1005,,0,,UNSIGNED32,RW,,communication,,0x80,,,\n"
    "1008,,0,,VISIBLE_STRING,RO,,constant,,ABCD,,,\n"
    "100B,,0,,UNSIGNED32,RO,,communication,,,,,\n"
    "100C,,0,,UNSIGNED16,RW,,communication,,0,,,\n"
    "100D,,0,,UNSIGNED8,RW,,communication,,0,,,\n"
    "1014,,0,,UNSIGNED32,RW,,communication,,$NODEID+0x80,,,\n"
    "1400,,0,,UNSIGNED8,RO,,communication,,,,,\n"
    "1400,,1,,UNSIGNED32,RW,,communication,,$NODEID+0x200,,,\n"
    "1400,,2,,UNSIGNED8,RW,,communication,,255,,,\n"
    "1401,,0,,UNSIGNED8,RO,,communication,,,,,\n"
    "1401,,1,,UNSIGNED32,RW,,communication,,$NODEID+0x80000300,,,\n"
    "1401,,2,,UNSIGNED8,RW,,communication,,255,,,\n"
    "1600,,0,,UNSIGNED8,RW,,communication,,2,0,4,\n"
    "1600,,1,,UNSIGNED32,RW,,communication,,0x20000010,,,\n"
    "1600,,2,,UNSIGNED32,RW,,communication,,0x20010010,,,\n"
    "1600,,3,4,UNSIGNED32,RW,,communication,,0,,,\n"
    "1601,,0,,UNSIGNED8,RW,,communication,,0,0,4,\n"
    "1601,,1,4,UNSIGNED32,RW,,communication,,0,,,\n"
    "1800,,0,,UNSIGNED8,RO,,communication,,,,,\n"
    "1800,,1,,UNSIGNED32,RW,,communication,,$NODEID+0x180,,,\n"
    "1800,,2,,UNSIGNED8,RW,,communication,,253,,,\n"
    "1800,,3,,UNSIGNED16,RW,,communication,,0,,,\n"
    "1800,,4,,UNSIGNED8,RW,,communication,,0,,,\n"
    "1800,,5,,UNSIGNED16,RW,,communication,,0,,,\n"
    "1A00,,0,,UNSIGNED8,RW,,communication,,2,0,4,\n"
    "1A00,,1,,UNSIGNED32,RW,,communication,,0x20000010,,,\n"
    "1A00,,2,,UNSIGNED32,RW,,communication,,0x20020020,,,\n"
    "1A00,,3,4,UNSIGNED32,RW,,communication,,0,,,\n"
    "2000,2001,0,,UNSIGNED16,RW,rt,value,0,,0,1000,words\n"
    "2002,,0,,UNSIGNED32,RW,rt,value,2,,,,long\n"
    "2003,,0,,INTEGER8,RW,rt,value,3,,-5,5,signed byte\n"
    "2004,,0,,INTEGER16,RW,rt,value,4,,,,signed word\n"
    "2005,,0,,UNSIGNED16,WO,r,value,5,,,,write only\n"
    "2006,,0,,UNSIGNED16,RO,t,value,6,,,,read only\n"
    "2007,,0,,UNSIGNED16,RW,,value,7,,,,not in PDOs\n"
    "2008,,0,,UNSIGNED16,RW,,late,8,,,,decided later\n"
    "2100,2110,0,,UNSIGNED16,RW,rt,sparse,9,,,,2100H exists only\n"
    "2200,,0,,UNSIGNED8,RO,,constant,,2,,,\n"
    "2200,,1,2,UNSIGNED16,RW,,value,10,,,,\n";

class SlaveBench : public ::testing::Test, private canopen::Application {
 protected:
  enum Item : std::uint8_t { kValue = canopen::kFirstApplicationItem, kLate, kSparse };

  SlaveBench() { slave.start(now, 5); }

  // Sends a frame; "" if nothing comes back, several frames are joined by blanks.
  std::string tell(std::string_view text) {
    slave.handle_frame(now, can(text));
    return drain();
  }
  std::string drain() {
    std::string all;
    while (const auto frame = slave.poll_transmit(now)) all += (all.empty() ? "" : " ") + text_of(*frame);
    return all;
  }
  // What is sent on the way, each with the milliseconds since the beginning: "40:185#00".
  std::string advance(Duration by) {
    const Instant begin = now, end = now + by;
    std::string all;
    while (true) {
      const auto at = slave.next_deadline();
      if (!at || *at > end) break;
      now = std::max(now, *at);
      slave.handle_timeout(now);
      const std::string sent = drain();
      if (!sent.empty()) all += (all.empty() ? "" : " ") + milliseconds(now - begin) + ":" + sent;
    }
    now = end;
    return all;
  }
  static std::string milliseconds(Duration d) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(d).count();
    std::string text = std::to_string(us / 1000);
    if (us % 1000 != 0) text += "." + std::to_string(us % 1000 / 100);
    return text;
  }
  std::string new_data() {
    slave.handle_new_data(now);
    return drain();
  }

  // In a master's words. Writes answer "ok" or the abort code.
  static std::string hex(std::uint64_t value, int digits) {
    char buffer[24];
    std::snprintf(buffer, sizeof buffer, "%0*llX", digits, static_cast<unsigned long long>(value));
    return buffer;
  }
  static CanFrame sdo(std::uint8_t command, std::uint16_t index, std::uint8_t sub, std::uint32_t value = 0) {
    return CanFrame::standard(0x605, {command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8),
                                      sub, static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
                                      static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 24)});
  }
  std::string write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned size) {
    slave.handle_frame(now, sdo(static_cast<std::uint8_t>(0x23 | (4 - size) << 2), index, sub, value));
    return answer(index, sub);
  }
  std::string read(std::uint16_t index, std::uint8_t sub) {
    slave.handle_frame(now, sdo(0x40, index, sub));
    return answer(index, sub);
  }
  std::string answer(std::uint16_t index, std::uint8_t sub) {
    // PDOs that the write set off are not the answer.
    std::optional<CanFrame> found;
    while (const auto frame = slave.poll_transmit(now)) {
      if (frame->id == 0x585) {
        EXPECT_FALSE(found) << "two answers";
        found = frame;
      } else {
        others.push_back(text_of(*frame));
      }
    }
    if (!found) return "";
    EXPECT_EQ(found->length, 8);
    EXPECT_EQ(read_le16(found->bytes(), 1), index);
    EXPECT_EQ(found->data[3], sub);
    const std::uint32_t value = read_le32(found->bytes(), 4);
    switch (found->data[0]) {
      case 0x80: return hex(value, 8);
      case 0x60: EXPECT_EQ(value, 0u); return "ok";
      case 0x43: return "=" + hex(value, 8);
      case 0x4b: return "=" + hex(value, 4);
      case 0x4f: return "=" + hex(value, 2);
      default: return "?" + text_of(*found);
    }
  }
  void operational() {
    drain();
    EXPECT_EQ(tell("000#0105"), "");
  }
  // The whole procedure.
  void map(std::uint16_t index, std::vector<std::uint32_t> entries) {
    const auto communication = static_cast<std::uint16_t>(index - 0x200);
    const std::uint32_t cob_id = cob_id_of(communication);
    ASSERT_EQ(write(communication, 1, cob_id | 0x80000000, 4), "ok");
    ASSERT_EQ(write(index, 0, 0, 1), "ok");
    std::uint8_t sub = 0;
    for (const std::uint32_t entry : entries) ASSERT_EQ(write(index, ++sub, entry, 4), "ok");
    ASSERT_EQ(write(index, 0, sub, 1), "ok");
    ASSERT_EQ(write(communication, 1, cob_id & 0x7fffffff, 4), "ok");
  }
  std::uint32_t cob_id_of(std::uint16_t communication) {
    return static_cast<std::uint32_t>(std::stoul(read(communication, 1).substr(1), nullptr, 16));
  }

  // canopen::Application
  bool exists(const canopen::ObjectRow& row, std::uint16_t index) const override {
    return row.item != kSparse || index == 0x2100;
  }
  Result<std::uint32_t, canopen::AbortCode> read(const canopen::ObjectRow& row, std::uint16_t index,
                                                 std::uint8_t sub) const override {
    const auto found = values.find(slot(row, index, sub));
    return found == values.end() ? 0 : found->second;
  }
  std::optional<canopen::WriteResult> write(Instant, canopen::Origin origin, const canopen::ObjectRow& row,
                                            std::uint16_t index, std::uint8_t sub, std::uint32_t raw) override {
    writes.push_back((origin == canopen::Origin::kPdo ? "pdo " : "sdo ") + hex(index, 4) + " " + hex(raw, 4));
    values[slot(row, index, sub)] = raw;
    if (row.item == kLate) return std::nullopt;
    return canopen::WriteResult{};
  }
  static unsigned slot(const canopen::ObjectRow& row, std::uint16_t index, std::uint8_t sub) {
    return row.argument + (index - row.first) + (sub - row.first_sub);
  }
  void abandon_download() override { ++abandoned; }
  std::uint8_t error_register() const override { return error_bits; }
  void on_nmt_command(Instant, canopen::NmtCommand command, canopen::NmtState before) override {
    commands.emplace_back(command, before);
  }
  void on_guarding(Instant, bool lost) override { guarding.push_back(lost); }
  void on_pdo_fault(Instant, canopen::PdoFault fault, unsigned pdo) override { faults.emplace_back(fault, pdo); }

  std::map<unsigned, std::uint32_t> values;
  std::vector<std::string> writes;
  std::vector<std::string> others;
  std::vector<std::pair<canopen::NmtCommand, canopen::NmtState>> commands;
  std::vector<bool> guarding;
  std::vector<std::pair<canopen::PdoFault, unsigned>> faults;
  std::uint8_t error_bits = 0;
  int abandoned = 0;
  Instant now = instant_from_ns(3'000'000'000);

 private:
  static constexpr std::array<std::string_view, 3> kItems{"value", "late", "sparse"};
  canopen::ObjectTable table_{kSlaveTable, kItems};

 protected:
  canopen::Slave slave{table_, *this};
};

}  // namespace vinv::test
