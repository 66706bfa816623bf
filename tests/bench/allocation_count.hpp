// Counts calls of operator new in this process. Link allocation_count.cpp into the executable that asks.
#pragma once

#include <cstdint>

namespace vinv::test {

std::uint64_t allocation_count();

}  // namespace vinv::test
