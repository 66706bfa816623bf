#include "sim/campaign/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/check.hpp"
#include "sim/base/random.hpp"

namespace vinv::campaign {
namespace {

constexpr std::uint64_t kRounds = 4;

std::string number_text(double v, int decimals) {
  std::string out = fmt::format("{:.{}f}", v, decimals);
  if (out.find('.') != std::string::npos) {
    while (out.back() == '0') out.pop_back();
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

std::uint64_t points(const Axis& a) { return a.values.empty() ? a.count : a.values.size(); }

// Middle, then each axis at its edges, then the corners.
std::uint64_t edges(const Axis& a) { return a.values.empty() && a.step ? 4 : 2; }

std::uint64_t boundary_cases(const std::vector<Axis>& axes) {
  if (axes.empty()) return 1;
  std::uint64_t n = 1;
  for (const Axis& a : axes) n += edges(a);
  return axes.size() > 1 ? n + (std::uint64_t{1} << axes.size()) : n;
}

std::string edge(const Axis& a, std::uint64_t which) {
  if (which < 2) return a.value_at(static_cast<double>(which));
  const double span = a.to - a.from;
  const double inwards = span == 0 ? 0 : std::min(std::abs(*a.step / span), 1.0);
  Axis plain = a;
  plain.logarithmic = false;
  return plain.value_at(which == 2 ? inwards : 1 - inwards);
}

void boundary_values(const std::vector<Axis>& axes, std::uint64_t i, Assignment& out) {
  const std::size_t begin = out.size();
  for (const Axis& a : axes) out.emplace_back(a.name, a.value_at(0.5));
  if (i-- == 0) return;
  for (std::size_t n = 0; n < axes.size(); ++n) {
    if (i < edges(axes[n])) {
      out[begin + n].second = edge(axes[n], i);
      return;
    }
    i -= edges(axes[n]);
  }
  for (std::size_t n = 0; n < axes.size(); ++n)
    out[begin + n].second = axes[n].value_at(static_cast<double>(i >> (axes.size() - 1 - n) & 1));
}

}  // namespace

std::uint64_t mix(std::uint64_t a, std::uint64_t b) { return Random(a ^ Random(b).next()).next(); }

std::uint64_t hash_text(std::string_view text, std::uint64_t seed) {
  for (const char c : text) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return seed;
}

// A Feistel network over the next even number of bits; results beyond n go round again.
std::uint64_t permuted(std::uint64_t i, std::uint64_t n, std::uint64_t key) {
  VINV_CHECK(i < n);
  unsigned half = 1;
  while (half < 31 && (std::uint64_t{1} << (2 * half)) < n) ++half;
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  do {
    std::uint64_t left = i >> half;
    std::uint64_t right = i & mask;
    for (std::uint64_t round = 0; round < kRounds; ++round) {
      const std::uint64_t next = left ^ (mix(key + round, right) & mask);
      left = right;
      right = next;
    }
    i = left << half | right;
  } while (i >= n);
  return i;
}

std::string Axis::value_at(double part) const {
  if (!values.empty()) {
    const auto n = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::clamp(std::floor(part * n), 0.0, n - 1))];
  }
  double v = logarithmic ? from * std::pow(to / from, part) : from + (to - from) * part;
  if (step) v = from + std::round((v - from) / *step) * *step;
  v = std::clamp(v, std::min(from, to), std::max(from, to));
  return number_text(v, decimals) + unit;
}

std::string Axis::point(std::uint64_t i, std::uint64_t n) const {
  if (!values.empty()) return values[i];
  return value_at(n < 2 ? 0 : static_cast<double>(i) / static_cast<double>(n - 1));
}

std::optional<std::uint64_t> Block::cases(std::uint64_t limit) const {
  std::uint64_t n = samples;
  if (boundary.size() > kMaxBoundaryAxes) return {};
  const auto times = [&](std::uint64_t m) {
    if (m == 0 || n > limit / m) return false;
    n *= m;
    return true;
  };
  if (n > limit || !times(boundary_cases(boundary))) return {};
  for (const Axis& a : grid)
    if (!times(points(a))) return {};
  return n;
}

Assignment Block::assignment(std::uint64_t index, std::uint64_t seed) const {
  Assignment out(set.begin(), set.end());
  const std::uint64_t sample = index % samples;
  const std::uint64_t outer = index / samples;  // each point of the grid has samples of its own
  std::uint64_t rest = outer;
  const std::uint64_t edge_cases = boundary_cases(boundary);
  const std::uint64_t edge_index = rest % edge_cases;
  rest /= edge_cases;
  const std::size_t begin = out.size();
  for (const Axis& a : grid) out.emplace_back(a.name, "");
  for (std::size_t n = grid.size(); n-- > 0;) {
    const std::uint64_t count = points(grid[n]);
    out[begin + n].second = grid[n].point(rest % count, count);
    rest /= count;
  }
  if (!boundary.empty()) boundary_values(boundary, edge_index, out);
  for (const Axis& a : latin_hypercube) {
    const std::uint64_t key = mix(seed, mix(hash_text(a.name), outer));
    const std::uint64_t stratum = permuted(sample, samples, key);
    const double within = Random(mix(key + 1, sample)).uniform();
    out.emplace_back(a.name, a.value_at((static_cast<double>(stratum) + within) / static_cast<double>(samples)));
  }
  for (const Axis& a : random)
    out.emplace_back(a.name, a.value_at(Random(mix(mix(seed, hash_text(a.name)), index)).uniform()));
  return out;
}

}  // namespace vinv::campaign
