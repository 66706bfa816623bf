// Vector operations for a handful of states. SUNDIALS' serial ones are made for long vectors; with 18 states they took
// more than half of the run time (docs/decisions/0001-plant-solver.md). Clones inherit the operations.
#pragma once

// SUNDIALS' N_Vector, so that its headers stay out of this one.
struct _generic_N_Vector;  // NOLINT(bugprone-reserved-identifier): its name there

namespace vinv::plant {

// v is a serial vector of at most kLongestVector states.
inline constexpr int kLongestVector = 32;
void use_short_vector_operations(_generic_N_Vector* v);

}  // namespace vinv::plant
