// How late events ran: counts in powers of two of a microsecond.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "sim/base/time.hpp"

namespace vinv::kernel {

class LatenessHistogram {
 public:
  // Early counts as on time.
  void add(Duration late);
  void merge(const LatenessHistogram& other);
  std::uint64_t count() const { return count_; }
  Duration maximum() const { return maximum_; }
  // Smallest bucket limit below which at least fraction (0 to 1) of the samples lie; 0 if there is no sample.
  Duration quantile(double fraction) const;
  // A few lines for a person: count, median, 99 %, 99.9 %, maximum.
  std::string text() const;

 private:
  static constexpr int kBuckets = 32;  // up to 2^31 us
  std::array<std::uint64_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  Duration maximum_{};
};

}  // namespace vinv::kernel
