// The steady-state tick allocates nothing, and two inverters told the same do the same.
#include <atomic>
#include <cstdlib>
#include <new>

#include "bench.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace vinv::inverter::test {
namespace {

void start(Bench& b) {
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(50));
  ASSERT_TRUE(b.command({port::NetTerminal::kStf}));
}

TEST(Tick, AllocatesNothingWhileRunning) {
  Bench b;
  start(b);
  b.run(1);
  const std::size_t before = allocations;
  for (int i = 0; i < 2000; ++i) b.tick();
  EXPECT_EQ(allocations, before);
}

TEST(Tick, IsReproducible) {
  Bench one;
  Bench two;
  start(one);
  start(two);
  for (int i = 0; i < 3000; ++i) {
    one.tick();
    two.tick();
    ASSERT_EQ(one->plant().measurements().torque_nm, two->plant().measurements().torque_nm) << i;
  }
  const auto a = one->signals();
  const auto b = two->signals();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].name;
}

}  // namespace
}  // namespace vinv::inverter::test
