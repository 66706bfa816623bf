// The independent copies of reference rows (data/*_reference.csv) that the families' tables are compared with.
#pragma once

#include "motor_model/inverter/csv.hpp"
#include "tests/support/read_file.hpp"

namespace vinv::inverter {

inline CsvTable reference(const std::string& name) {
  auto table = parse_csv(test::read_file(VINV_SOURCE_DIR "/tests/motor_model/inverter/data/" + name));
  EXPECT_TRUE(table.has_value()) << name;
  return *table;
}

}  // namespace vinv::inverter
