#include "sim/scenario/report/html_data.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/scenario/report/csv_report.hpp"
#include "sim/scenario/report/text.hpp"

namespace vinv::scenario {
namespace {

std::string json_string(std::string_view text) { return json_for_script(nlohmann::json(clean_utf8(text)).dump()); }

void append_base64(std::string& out, ByteView bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t begin = out.size();
  out.resize(begin + (bytes.size() + 2) / 3 * 4, '=');
  char* to = out.data() + begin;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
    const std::uint32_t v =
        static_cast<std::uint32_t>(bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0));
    *to++ = kDigits[v >> 18U];
    *to++ = kDigits[v >> 12U & 63U];
    if (left > 1) *to++ = kDigits[v >> 6U & 63U];
    if (left > 2) *to++ = kDigits[v & 63U];
  }
}

// The page's numbers are little endian, as those of the machines that this runs on.
static_assert(std::endian::native == std::endian::little);
template <class T>
void append_numbers(std::string& out, const std::vector<T>& numbers) {
  append_base64(out, {reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size() * sizeof(T)});
}

void append_hex(std::string& out, std::uint32_t value) {
  char digits[8];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value, 16).ptr);
}

void append_number(std::string& out, std::int64_t value) {
  char digits[24];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void open_blob(std::string& page, const std::string& id) { page += "<script type=\"text/plain\" id=\"" + id + "\">"; }
constexpr std::string_view kCloseScript = "</script>\n";

// Finds the index of a word, and gives each new one the next.
class WordList {
 public:
  std::size_t index(const std::string& word) {
    const auto [it, is_new] = indices_.try_emplace(word, words_.size());
    if (is_new) words_.push_back(word);
    return it->second;
  }
  std::string json() const {
    std::string out = "[";
    for (const std::string& w : words_) out += (out.size() > 1 ? "," : "") + json_string(w);
    return out + "]";
  }

 private:
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> words_;
};

// A column whose samples are all the same number, which needs no element of its own.
bool is_constant(const SignalColumn& column) {
  return std::all_of(column.values.begin(), column.values.end(), [&](double v) {
    return std::bit_cast<std::uint64_t>(v) == std::bit_cast<std::uint64_t>(column.values.front());
  });
}

void append_columns(std::string& json, std::string& blobs, const Recording& recording) {
  std::vector<double> seconds;
  seconds.reserve(recording.times.size());
  for (const Instant t : recording.times) seconds.push_back(static_cast<double>(to_ns(t)) / 1e9);  // the nearest number
  open_blob(blobs, "times");
  append_numbers(blobs, seconds);
  blobs += kCloseScript;
  std::vector<float> packed;
  json += "\"columns\":[";
  for (std::size_t i = 0; i < recording.columns.size(); ++i) {
    const SignalColumn& c = recording.columns[i];
    if (i > 0) json += ',';
    json +=
        "{\"drive\":" + json_string(c.drive) + ",\"name\":" + json_string(c.name) + ",\"unit\":" + json_string(c.unit);
    const bool constant = is_constant(c);
    json += constant ? ",\"constant\":true}" : "}";
    packed.assign(c.values.begin(),
                  constant ? c.values.begin() + std::min<long>(1, std::ssize(c.values)) : c.values.end());
    open_blob(blobs, "c" + std::to_string(i));
    append_numbers(blobs, packed);
    blobs += kCloseScript;
  }
  json += "],";
}

void append_states(std::string& json, const Recording& recording) {
  json += "\"states\":[";
  for (std::size_t i = 0; i < recording.states.size(); ++i) {
    const StateTrace& s = recording.states[i];
    WordList words;
    std::string times;
    std::string values;
    for (const StateTrace::Change& change : s.changes) {
      if (!times.empty()) {
        times += ',';
        values += ',';
      }
      append_seconds(times, change.at);
      append_number(values, static_cast<std::int64_t>(words.index(change.value)));
    }
    if (i > 0) json += ',';
    json += "{\"drive\":" + json_string(s.drive) + ",\"name\":" + json_string(s.name) +
            ",\"lost\":" + std::to_string(s.lost) + ",\"words\":" + words.json() + ",\"t\":[" + times + "],\"v\":[" +
            values + "]}";
  }
  json += "],";
}

void append_events(std::string& json, const RunResult& result) {
  json += "\"events\":[";
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const Event& e = result.events[i];
    json += i > 0 ? ",[" : "[";
    append_seconds(json, e.at);
    json += ",\"";
    json += kind_word(e.kind);
    json += "\"," + json_string(e.drive) + "," + json_string(e.text) + "," + std::to_string(e.line) + "]";
  }
  json += "],\"checks\":[";
  for (std::size_t i = 0; i < result.checks.size(); ++i) {
    const CheckResult& c = result.checks[i];
    json += i > 0 ? ",[" : "[";
    append_seconds(json, c.at);
    json += c.passed ? ",true," : ",false,";
    json += json_string(c.what) + "]";
  }
  json += "],";
}

void append_wire(std::string& json, std::string& blobs, const Recording& recording) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  const std::size_t shown = std::min(recording.wire.size(), kMaxWireRecordsInPage);
  WordList networks;
  WordList senders;
  std::int64_t last = 0;
  open_blob(blobs, "wire");
  for (std::size_t i = 0; i < shown; ++i) {
    const WireRecord& r = recording.wire[i];
    if (i > 0) blobs += '\n';
    append_number(blobs, to_ns(r.at) - last);
    last = to_ns(r.at);
    blobs += {' ', static_cast<char>('0' + static_cast<int>(r.kind)), ' '};
    append_number(blobs, static_cast<std::int64_t>(networks.index(r.network)));
    blobs += ' ';
    append_number(blobs, static_cast<std::int64_t>(senders.index(r.sender)));
    blobs += ' ';
    append_hex(blobs, r.id);
    blobs += ' ';
    for (const std::uint8_t b : r.bytes) blobs += {kHex[b >> 4U], kHex[b & 15U]};
  }
  blobs += kCloseScript;
  json += "\"wire\":{\"records\":" + std::to_string(recording.wire.size()) + ",\"shown\":" + std::to_string(shown) +
          ",\"networks\":" + networks.json() + ",\"senders\":" + senders.json() + "}";
}

}  // namespace

void append_data_elements(std::string& page, const RunResult& result) {
  std::string blobs;
  std::string json = "{\"name\":" + json_string(result.name) + ",\"end\":" + seconds_text(result.end) + ",";
  append_columns(json, blobs, result.recording);
  append_states(json, result.recording);
  append_events(json, result);
  append_wire(json, blobs, result.recording);
  page += "<script type=\"application/json\" id=\"run\">" + json + "}</script>\n" + blobs;
}

}  // namespace vinv::scenario
