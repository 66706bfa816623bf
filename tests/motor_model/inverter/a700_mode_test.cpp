// The complete matrix of Pr.79 and Pr.340: FR-A7NE manual 4.3.2.
#include <gtest/gtest.h>

#include <string>

#include "motor_model/inverter/a700/operation_mode.hpp"

namespace vinv::inverter::a700 {
namespace {

using port::OperationMode;
using port::Refusal;

constexpr auto kExt = OperationMode::kExternal;
constexpr auto kPu = OperationMode::kPu;
constexpr auto kNet = OperationMode::kNetwork;
constexpr auto kCombi1 = OperationMode::kCombined1;
constexpr auto kCombi2 = OperationMode::kCombined2;

struct Row {
  int pr340;
  int pr79;
  bool x12;
  OperationMode at_start;
};

TEST(A700Mode, AtPowerOnEveryRowOfTheMatrixHolds) {
  for (const Row& row : {
           Row{0, 0, false, kExt},  {0, 1, false, kPu},   {0, 2, false, kExt},  {0, 3, false, kCombi1},
           {0, 4, false, kCombi2},  {0, 6, false, kExt},  {0, 7, true, kExt},   {0, 7, false, kExt},
           {1, 0, false, kNet},     {1, 1, false, kPu},   {1, 2, false, kNet},  {1, 3, false, kCombi1},
           {1, 4, false, kCombi2},  {1, 6, false, kNet},  {1, 7, true, kNet},   {1, 7, false, kExt},
           {2, 0, false, kNet},     {2, 1, false, kPu},   {2, 2, false, kNet},  {2, 3, false, kCombi1},
           {2, 4, false, kCombi2},  {2, 6, false, kNet},  {2, 7, true, kNet},   {2, 7, false, kExt},
           {10, 0, false, kNet},    {10, 1, false, kPu},  {10, 2, false, kNet}, {10, 3, false, kCombi1},
           {10, 4, false, kCombi2}, {10, 6, false, kNet}, {10, 7, true, kExt},  {10, 7, false, kExt},
           {12, 0, false, kNet},    {12, 1, false, kPu},  {12, 2, false, kNet}, {12, 3, false, kCombi1},
           {12, 4, false, kCombi2}, {12, 6, false, kNet}, {12, 7, true, kExt},  {12, 7, false, kExt},
       }) {
    EXPECT_EQ(start_mode({.raw_pr79 = row.pr79, .raw_pr340 = row.pr340, .interlock_off = row.x12}), row.at_start)
        << "Pr.340=" << row.pr340 << " Pr.79=" << row.pr79 << " X12=" << row.x12;
  }
}

// Which of the four requests each mode answers with which mode; "-" refuses.
std::string answers(OperationMode now, const ModeSituation& s) {
  std::string out;
  for (ModeRequest request :
       {ModeRequest::kNetworkOn, ModeRequest::kNetworkOff, ModeRequest::kPanelByNetwork, ModeRequest::kPanelKey}) {
    const auto next = request_mode(now, request, s);
    out += !next ? '-' : *next == kExt ? 'E' : *next == kPu ? 'P' : *next == kNet ? 'N' : 'C';
  }
  return out;
}

TEST(A700Mode, SwitchesAsTheMatrixSays) {
  for (int pr340 : {0, 1, 2}) {
    SCOPED_TRACE(pr340);
    const auto s = [&](int pr79, bool x12 = false) {
      return ModeSituation{.raw_pr79 = pr79, .raw_pr340 = pr340, .interlock_off = x12};
    };
    // Among EXT, PU and NET; PU and NET not directly.
    for (const auto& free : {s(0), s(7, true)}) {
      EXPECT_EQ(answers(kExt, free), "NE-P");
      EXPECT_EQ(answers(kPu, free), "---E");
      EXPECT_EQ(answers(kNet, free), "NE--");
    }
    EXPECT_EQ(answers(kPu, s(1)), "----");   // PU fixed
    EXPECT_EQ(answers(kExt, s(2)), "NE--");  // EXT and NET only
    EXPECT_EQ(answers(kNet, s(2)), "NE--");
    EXPECT_EQ(answers(kCombi1, s(3)), "----");
    EXPECT_EQ(answers(kCombi2, s(4)), "----");
    EXPECT_EQ(answers(kExt, s(6)), "NEPP");
    EXPECT_EQ(answers(kPu, s(6)), "NEPE");
    EXPECT_EQ(answers(kNet, s(6)), "NEP-");
    EXPECT_EQ(answers(kExt, s(7)), "-E--");  // EXT fixed
  }
  for (int pr340 : {10, 12}) {
    SCOPED_TRACE(pr340);
    const auto s = [&](int pr79, bool x12 = false) {
      return ModeSituation{.raw_pr79 = pr79, .raw_pr340 = pr340, .interlock_off = x12};
    };
    // PU and NET by the key; EXT is out of reach.
    EXPECT_EQ(answers(kNet, s(0)), "N--P");
    EXPECT_EQ(answers(kPu, s(0)), "---N");
    EXPECT_EQ(answers(kPu, s(1)), "----");
    EXPECT_EQ(answers(kNet, s(2)), "N---");
    EXPECT_EQ(answers(kCombi1, s(3)), "----");
    EXPECT_EQ(answers(kNet, s(6)), "N-PP");
    EXPECT_EQ(answers(kPu, s(6)), "N-PN");
    EXPECT_EQ(answers(kExt, s(7, true)), "NE-P");  // as with Pr.340 = 0
    EXPECT_EQ(answers(kExt, s(7)), "-E--");
  }
}

TEST(A700Mode, OnlyPr79Is6SwitchesWhileRunningOrWithAStartSignal) {
  for (int pr79 : {0, 2, 6, 7}) {
    for (bool running : {true, false}) {
      ModeSituation s{.raw_pr79 = pr79, .interlock_off = true, .stopped = !running, .start_signal = !running};
      EXPECT_EQ(request_mode(kExt, ModeRequest::kNetworkOn, s).has_value(), pr79 == 6) << pr79 << running;
    }
  }
}

TEST(A700Mode, TakingAwayTheInterlockForcesExternalOperationAtOnce) {
  ModeSituation s{.raw_pr79 = 7, .interlock_off = false, .stopped = false};
  EXPECT_EQ(follow_settings(kPu, s), kExt);
  EXPECT_EQ(follow_settings(kNet, s), kExt);
  s.interlock_off = true;
  EXPECT_EQ(follow_settings(kPu, s), kPu);
}

TEST(A700Mode, ANewPr79ActsAtStandstill) {
  const auto follow = [](OperationMode now, int pr79, int pr340 = 0, bool stopped = true) {
    return follow_settings(now, {.raw_pr79 = pr79, .raw_pr340 = pr340, .stopped = stopped});
  };
  EXPECT_EQ(follow(kExt, 1), kPu);
  EXPECT_EQ(follow(kExt, 1, 0, false), kExt);
  EXPECT_EQ(follow(kExt, 3), kCombi1);
  EXPECT_EQ(follow(kNet, 4), kCombi2);
  EXPECT_EQ(follow(kCombi1, 0), kExt);
  EXPECT_EQ(follow(kCombi1, 0, 10), kNet);
  EXPECT_EQ(follow(kPu, 2), kExt);
  EXPECT_EQ(follow(kPu, 2, 12), kNet);
  EXPECT_EQ(follow(kNet, 2), kNet);
}

TEST(A700Mode, TerminalsChooseTheModeInTheirOrder) {
  const auto follow = [](OperationMode now, ModeSituation s) { return follow_settings(now, s); };
  EXPECT_EQ(follow(kExt, {.x16 = false}), kPu);
  EXPECT_EQ(follow(kPu, {.x16 = true}), kExt);
  EXPECT_EQ(follow(kExt, {.x66 = true}), kNet);
  EXPECT_EQ(follow(kNet, {.x66 = false}), kExt);
  EXPECT_EQ(follow(kNet, {.x65 = true}), kPu);
  EXPECT_EQ(follow(kPu, {.x65 = false}), kNet);
  // X66 before X65 before X16.
  EXPECT_EQ(follow(kExt, {.x16 = true, .x65 = true, .x66 = true}), kNet);
  EXPECT_EQ(follow(kExt, {.x16 = true, .x65 = true}), kPu);
  // Where there is no external operation only X65 chooses.
  EXPECT_EQ(follow(kNet, {.raw_pr340 = 10, .x16 = true}), kNet);
  EXPECT_EQ(follow(kPu, {.raw_pr340 = 10, .x65 = false}), kNet);
  // A request against the terminal is refused, and a running motor is left alone.
  EXPECT_FALSE(request_mode(kExt, ModeRequest::kNetworkOn, {.x66 = false}).has_value());
  EXPECT_EQ(follow(kExt, {.x66 = true, .stopped = false}), kExt);
}

}  // namespace
}  // namespace vinv::inverter::a700
