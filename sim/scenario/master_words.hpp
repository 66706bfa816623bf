// Words that masters are told, from the values of a scenario file. What cannot be understood is told when the file is
// read.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"
#include "sim/masters/eip_task.hpp"
#include "sim/masters/profile.hpp"
#include "sim/masters/words.hpp"
#include "sim/rig/commands.hpp"

namespace vinv::scenario {

// What a monitor must show.
struct SaidRange {
  double low = 0;
  double high = 0;
  std::string text;  // as written
  VINV_ARCHIVE(SaidRange, low, high, text);
};
struct SaidOrder {
  std::string name;  // of a parameter or monitor that is read
  masters::Order order;
  std::optional<SaidRange> range;
  VINV_ARCHIVE(SaidOrder, name, order, range);
};

// One of them.
struct Said {
  std::vector<SaidOrder> orders;  // node and increments are the drive's
  std::optional<masters::EipTask> task;
  std::optional<bool> silence;
};

// A profile of the protocol says which monitors there are. The error is a sentence without full stop that names what is
// allowed.
Result<Said, std::string> read_master_word(const masters::BoardProfile& profile, std::string_view word,
                                           const rig::Json& value);

// Of all protocols; EtherNet/IP has scanner_words() beside them.
const std::vector<std::string_view>& common_master_words();

}  // namespace vinv::scenario
