// Pieces of text that the report writers share. All are pure functions; what comes from a scenario file may hold
// anything, including markup and bytes that are no UTF-8.
#pragma once

#include <string>
#include <string_view>

#include "sim/base/time.hpp"

namespace vinv::scenario {

// Well-formed UTF-8 without control characters except tab and line feed; others become U+FFFD.
std::string clean_utf8(std::string_view text);
// For HTML element content and quoted attributes: cleaned, with & < > " ' as entities.
std::string html_text(std::string_view text);
// For <script type="application/json">: no byte of it can end the element. json: valid JSON.
std::string json_for_script(std::string_view json);
// A reference to a file beside the page: percent-encoded.
std::string url_text(std::string_view file_name);
// A field of RFC 4180, quoted where it must be. A field that a spreadsheet would take for a formula gets an apostrophe.
std::string csv_field(std::string_view text);
// Exact seconds with at least three decimals, no unit: "3.412", "0.000000125".
std::string seconds_text(Instant at);
void append_seconds(std::string& out, Instant at);
// The path as outputs show it: absolute ones differ from machine to machine, so only the last two parts are kept.
std::string shown_path(std::string_view path);

}  // namespace vinv::scenario
