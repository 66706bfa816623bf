// Counts heap allocations of this process: malloc, calloc, realloc and with them operator new, also those inside shared
// libraries. Link allocation_count.cpp into the executable that asks. Under a sanitizer, which brings its own
// malloc, only operator new is counted.
#pragma once

#include <cstdint>

namespace vinv::test {

std::uint64_t allocation_count();

}  // namespace vinv::test
