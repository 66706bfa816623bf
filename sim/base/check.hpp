// VINV_CHECK: a broken invariant of ours, never bad input. On in every build; prints the place and ends the process.
#pragma once

namespace vinv {

[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace vinv

#define VINV_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::vinv::check_failed(#condition, __FILE__, __LINE__))
