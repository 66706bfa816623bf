// Counts every allocation of this test program. Its own file, so that the compiler does not look through the operators.
#pragma once

#include <cstdint>

std::uint64_t allocation_count();
