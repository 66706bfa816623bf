#include "sim/kernel/lateness.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace vinv::kernel {
namespace {

std::string micro(Duration d) {
  char text[48];
  std::snprintf(text, sizeof text, "%.0f us", static_cast<double>(d.count()) * 1e-3);
  return text;
}

}  // namespace

// Bucket 0 holds what is less than 1 us late, bucket i from 2^(i-1) to below 2^i us, the last one also all above.
void LatenessHistogram::add(Duration late) {
  const auto us = static_cast<std::uint64_t>(std::max<std::int64_t>(late.count(), 0) / 1000);
  const auto bucket = std::min<int>(std::bit_width(us), kBuckets - 1);
  ++buckets_[static_cast<std::size_t>(bucket)];
  ++count_;
  maximum_ = std::max(maximum_, late);
}

void LatenessHistogram::merge(const LatenessHistogram& other) {
  for (std::size_t i = 0; i < buckets_.size(); ++i) buckets_[i] += other.buckets_[i];
  count_ += other.count_;
  maximum_ = std::max(maximum_, other.maximum_);
}

Duration LatenessHistogram::quantile(double fraction) const {
  if (count_ == 0) return Duration{};
  const double wanted = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i + 1 < buckets_.size(); ++i) {
    below += buckets_[i];
    if (static_cast<double>(below) >= wanted) return std::chrono::microseconds(std::int64_t{1} << i);
  }
  // In the bucket without a limit: the maximum is one.
  return std::max(maximum_, Duration(std::chrono::microseconds(std::int64_t{1} << (kBuckets - 1))));
}

std::string LatenessHistogram::text() const {
  if (count_ == 0) return "no events ran\n";
  return std::to_string(count_) + " events; late by less than " + micro(quantile(0.5)) + " in 50 %, " +
         micro(quantile(0.99)) + " in 99 %, " + micro(quantile(0.999)) + " in 99.9 %; at most " + micro(maximum_) +
         "\n";
}

}  // namespace vinv::kernel
