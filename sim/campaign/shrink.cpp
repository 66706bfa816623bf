#include "sim/campaign/shrink.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>

#include "sim/campaign/isolation.hpp"
#include "sim/campaign/merge.hpp"
#include "sim/rig/words.hpp"

namespace vinv::campaign {
namespace {

using Path = std::vector<std::size_t>;  // indices of items

Document& at(Document& root, const Path& path) {
  Document* d = &root;
  for (const std::size_t i : path) d = &d->items[i];
  return *d;
}

void remove(Document& from, std::size_t begin, std::size_t end) {
  const auto cut = [&](auto& list) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(begin), list.begin() + static_cast<std::ptrdiff_t>(end));
  };
  cut(from.items);
  if (from.is_map()) cut(from.keys);
}

// With other expectations it would not be the same check any more.
bool expects(std::string_view key) {
  static const std::set<std::string_view> words{"check", "reached",   "ramp",       "trip",    "always",
                                                "never", "overshoot", "rising",     "falling", "expect_frame",
                                                "when",  "within",    "absent_for", "limit"};
  return words.count(key) > 0;
}

// What must stay as it is.
std::string signature(const CaseResult& r) {
  switch (r.verdict) {
    case CaseVerdict::kPassed: return {};
    case CaseVerdict::kFailed:
      return "failed\n" + r.failures.front().drive + "\n" + r.failures.front().what + "\n" + r.alarm;
    default: break;
  }
  // Places and times in a reason move.
  std::string out(verdict_word(r.verdict));
  for (const char c : r.reason.substr(0, r.reason.find('\n')))
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) out += c;
  return out;
}

// Shorter ways to write about the same number.
std::vector<std::string> simpler(const std::string& text) {
  const std::size_t end = std::min(text.find_first_not_of("+-.0123456789"), text.size());
  double number = 0;
  if (!rig::parse_number(text.substr(0, end), number)) return {};
  const std::string unit = text.substr(end);
  if (unit.find_first_of("0123456789$") != std::string::npos && unit.find("m2") == std::string::npos) return {};
  std::vector<std::string> out;
  const auto add = [&](const std::string& digits) {
    if (digits.size() < end && digits.find('e') == std::string::npos) out.push_back(digits + unit);
  };
  add("0");
  add("1");
  for (const int digits : {1, 2, 3, 4}) add(fmt::format("{:.{}g}", number, digits));
  return out;
}

class Shrinker {
 public:
  Shrinker(const Campaign& campaign, std::uint64_t number, const CampaignRunOptions& run, const ShrinkOptions& options)
      : campaign_(campaign), number_(number), run_(run), options_(options), best_(campaign.scenario(number)) {}

  ShrinkResult shrink() {
    out_.result = result_of(best_);
    out_.text = text(best_);
    out_.bytes_before = out_.text.size();
    wanted_ = signature(out_.result);
    if (wanted_.empty()) throw std::runtime_error(fmt::format("case {} passes; there is nothing to shrink.", number_));
    back_to_defaults();
    for (bool changed = true; changed && !spent();) {
      changed = false;
      // A list may be in a step that goes.
      for (std::size_t n = 0; n < step_lists(best_, {}).size(); ++n)
        changed = thin(step_lists(best_, {})[n]) || changed;
      changed = drives() || changed;
      changed = entries({}) || changed;
      changed = numbers({}) || changed;
    }
    out_.minimal = !spent();
    return std::move(out_);
  }

 private:
  bool spent() const { return out_.runs >= options_.max_runs; }
  std::string text(const Document& d) const {
    return Campaign::text_of(d, fmt::format("{}, case {} made small", campaign_.title, number_));
  }

  CaseResult result_of(const Document& candidate) {
    ++out_.runs;
    CaseResult result;
    bool asked = false;
    const std::string path = campaign_.case_name(number_) + ".yaml";
    run_isolated(
        1,
        [&]() -> std::optional<std::string> {
          if (std::exchange(asked, true)) return {};
          return text(candidate);
        },
        [&](const std::string& task) {
          const auto run = run_.run_one ? run_.run_one(task, path) : run_text(task, path, run_.load, run_.run);
          return to_line(summary(run, {}));
        },
        [&](std::size_t, const Answer& answer) {
          if (answer.kind == Answer::Kind::kStopped)
            throw std::runtime_error("a run was ended from outside: " + answer.text);
          if (answer.kind == Answer::Kind::kDone) {
            result = from_line(answer.text).value();
          } else {
            result.verdict = CaseVerdict::kCrashed;
            result.reason = answer.text;
          }
          return true;
        });
    return result;
  }

  bool keeps(const Document& candidate) {
    if (spent()) return false;
    std::string now = text(candidate);
    if (!tried_.insert(hash_text(now)).second) return false;
    CaseResult result = result_of(candidate);
    const bool same = signature(result) == wanted_;
    if (same) {
      best_ = candidate;
      out_.text = std::move(now);
      out_.result = std::move(result);
    }
    if (options_.on_run) options_.on_run(out_.runs, out_.text.size());
    return same;
  }

  // What varies, as the scenario itself has it.
  void back_to_defaults() {
    for (const auto& [name, value] : campaign_.assignment(number_)) {
      const std::string place = name.front() == '/' ? name : "/variables/" + name;
      std::string why;
      Document base = campaign_.base;
      const Document* before = find_place(base, place, false, why);
      Document candidate = best_;
      Document* now = find_place(candidate, place, false, why);
      if (before == nullptr || now == nullptr || before->text == now->text) continue;
      *now = *before;
      keeps(candidate);
    }
  }

  static std::vector<Path> step_lists(const Document& d, const Path& here) {
    std::vector<Path> out;
    for (std::size_t i = 0; i < d.items.size(); ++i) {
      Path path = here;
      path.push_back(i);
      const bool steps = d.is_map() && d.items[i].is_list() && !d.items[i].items.empty();
      if (steps && (d.keys[i] == "steps" || d.keys[i] == "during" || here.size() == 1)) out.push_back(path);
      for (Path& p : step_lists(d.items[i], path)) out.push_back(std::move(p));
    }
    return out;
  }

  // Delta debugging: halves, then quarters, down to one entry at a time.
  bool thin(const Path& list) {
    bool changed = false;
    for (std::size_t size = at(best_, list).items.size(); size >= 1; size /= 2) {
      for (std::size_t end = at(best_, list).items.size(); end > 0;) {
        const std::size_t begin = end > size ? end - size : 0;
        Document candidate = best_;
        remove(at(candidate, list), begin, end);
        changed = keeps(candidate) || changed;
        end = begin;
        if (spent()) return changed;
      }
    }
    return changed;
  }

  static void forget_drive(Document& d, const std::string& name) {
    for (std::size_t i = d.items.size(); i-- > 0;) {
      const Document* drive = d.items[i].is_map() ? d.items[i].find("drive") : nullptr;
      if (d.is_list() && drive != nullptr && drive->text == name)
        remove(d, i, i + 1);
      else
        forget_drive(d.items[i], name);
    }
  }

  bool drives() {
    bool changed = false;
    const auto list = [](Document& d) -> Document* {
      std::string why;
      return find_place(d, "/plant/drives", false, why);
    };
    Document* now = list(best_);
    for (std::size_t i = now == nullptr || !now->is_list() ? 0 : now->items.size(); i-- > 0;) {
      Document candidate = best_;
      Document& all = *list(candidate);
      if (i >= all.items.size()) continue;
      const Document* name = all.items[i].is_map() ? all.items[i].find("name") : nullptr;
      const std::string word = name == nullptr ? fmt::format("drive_{}", i + 1) : name->text;
      remove(all, i, i + 1);
      forget_drive(candidate, word);
      if (all.items.size() == 1) only_drive(candidate);
      changed = keeps(candidate) || changed;
    }
    return changed;
  }

  // A drive that is the only one need not be named.
  static void only_drive(Document& d) {
    for (std::size_t i = d.items.size(); i-- > 0;) {
      if (d.is_map() && d.keys[i] == "drive")
        remove(d, i, i + 1);
      else
        only_drive(d.items[i]);
    }
  }

  // Every entry of every mapping and list, the large ones first.
  bool entries(const Path& path) {
    bool changed = false;
    for (std::size_t i = at(best_, path).items.size(); i-- > 0 && !spent();) {
      Document candidate = best_;
      remove(at(candidate, path), i, i + 1);
      if (keeps(candidate)) {
        changed = true;
        continue;
      }
      Path below = path;
      below.push_back(i);
      changed = entries(below) || changed;
    }
    return changed;
  }

  bool numbers(const Path& path) {
    bool changed = false;
    const Document here = at(best_, path);
    for (std::size_t i = 0; i < here.items.size() && !spent(); ++i) {
      if (here.is_map() && expects(here.keys[i])) continue;
      Path below = path;
      below.push_back(i);
      if (!here.items[i].is_scalar()) {
        changed = numbers(below) || changed;
        continue;
      }
      for (const std::string& shorter : simpler(here.items[i].text)) {
        Document candidate = best_;
        at(candidate, below).text = shorter;
        if (!keeps(candidate)) continue;
        changed = true;
        break;
      }
    }
    return changed;
  }

  const Campaign& campaign_;
  std::uint64_t number_;
  const CampaignRunOptions& run_;
  const ShrinkOptions& options_;
  Document best_;
  std::string wanted_;
  std::set<std::uint64_t> tried_;
  ShrinkResult out_;
};

}  // namespace

ShrinkResult shrink_case(const Campaign& campaign, std::uint64_t number, const CampaignRunOptions& run,
                         const ShrinkOptions& options) {
  return Shrinker(campaign, number, run, options).shrink();
}

}  // namespace vinv::campaign
