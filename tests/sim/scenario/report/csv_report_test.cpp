#include "sim/scenario/report/csv_report.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/scenario/report/sample_run.hpp"

namespace vinv::scenario {
namespace {

TEST(CsvReport, SignalsHaveOneHeaderWithUnits) {
  EXPECT_EQ(signals_csv(small_run().recording),
            "time_s,fan.output_frequency [Hz],fan.fan\r\n"
            "0.000,0,1\r\n"
            "0.010,1.25,1\r\n"
            "0.020,50.1,1\r\n");
}

TEST(CsvReport, AColumnThatEndsEarlyOrHasNoNumberLeavesFieldsEmpty) {
  Recording r = small_run().recording;
  r.columns[0].values = {1, std::nan("")};
  EXPECT_EQ(signals_csv(r), "time_s,fan.output_frequency [Hz],fan.fan\r\n0.000,1,1\r\n0.010,,1\r\n0.020,,1\r\n");
}

TEST(CsvReport, ANumberReturnsAfterAnotherOne) {
  Recording r = small_run().recording;
  r.columns = {{"a", "x", "-", {0, -0.0, 0}}, {"", "y", "V", {1e-5, 123456.78, 1e-5}}};
  EXPECT_EQ(signals_csv(r), "time_s,a.x,y [V]\r\n0.000,0,1e-05\r\n0.010,-0,123456.78\r\n0.020,0,1e-05\r\n");
}

TEST(CsvReport, StatesHaveARowForEachChange) {
  EXPECT_EQ(states_csv(small_run().recording),
            "time_s,drive,state,value\r\n0.000,fan,alarm,none\r\n0.010,fan,alarm,E.OV3\r\n");
}

TEST(CsvReport, EventsNameTheirLineIfTheyHaveOne) {
  RunResult r = small_run();
  r.events[1].text = "trip E.OV3, DC link \"802 V\"";
  EXPECT_EQ(events_csv(r),
            "time_s,kind,drive,text,line\r\n"
            "0.000,action,fan,run: forward,12\r\n"
            "0.010,trip,fan,\"trip E.OV3, DC link \"\"802 V\"\"\",\r\n");
}

}  // namespace
}  // namespace vinv::scenario
