// Which value each varied thing has in which case: grids, edges, random values and Latin hypercubes. A case is a pure
// function of its number; nothing is drawn one after the other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vinv::campaign {

// The values that one thing may have.
struct Axis {
  std::string name;                 // a variable, or a place ("/steps/3/after")
  std::vector<std::string> values;  // as written; empty: the range below
  double from = 0;
  double to = 0;
  std::uint64_t count = 0;     // points of a grid
  std::optional<double> step;  // values lie on from, from + step, ...
  bool logarithmic = false;
  int decimals = 0;
  std::string unit;  // with the space before it

  // part: 0 to 1, from the first value to the last; a list falls into equal parts.
  std::string value_at(double part) const;
  std::string point(std::uint64_t i, std::uint64_t n) const;  // of n, evenly
};

using Assignment = std::vector<std::pair<std::string, std::string>>;  // name, value

// Plans of one block multiply: each point of the grid comes with each edge and each sample.
struct Block {
  std::vector<std::pair<std::string, std::string>> set;
  std::vector<Axis> grid;
  std::vector<Axis> boundary;
  std::vector<Axis> latin_hypercube;
  std::vector<Axis> random;
  std::uint64_t samples = 1;  // of latin_hypercube and random

  // Empty if there are more than the limit.
  std::optional<std::uint64_t> cases(std::uint64_t limit) const;
  // index: from 0. seed: of this block.
  Assignment assignment(std::uint64_t index, std::uint64_t seed) const;
};

// With more there would be too many corners.
inline constexpr std::size_t kMaxBoundaryAxes = 12;

// Where i lands in a permutation of 0 ... n-1 that the key chooses.
std::uint64_t permuted(std::uint64_t i, std::uint64_t n, std::uint64_t key);
// A hash of both.
std::uint64_t mix(std::uint64_t a, std::uint64_t b);
// FNV-1a.
std::uint64_t hash_text(std::string_view text, std::uint64_t seed = 0xcbf29ce484222325ULL);

}  // namespace vinv::campaign
