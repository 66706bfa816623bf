// A run as comma-separated values, RFC 4180 with CRLF: for spreadsheets, pandas and the like.
#pragma once

#include <string>

#include "sim/scenario/result.hpp"

namespace vinv::scenario {

// time_s, then a column per signal, headed "DRIVE.NAME [UNIT]". Numbers have the precision of a float (7 digits), and
// an empty field where there is none.
std::string signals_csv(const Recording& recording);
// time_s,drive,state,value: a row for each change.
std::string states_csv(const Recording& recording);
// time_s,kind,drive,text,line
std::string events_csv(const RunResult& result);

// "action", "trip" ...: in CSV and in pages.
std::string_view kind_word(Event::Kind kind);

}  // namespace vinv::scenario
