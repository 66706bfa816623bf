#include "sim/base/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace vinv {

void check_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "vinverter: broken invariant: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace vinv
