#include "motor_model/drive/remote_setting.hpp"

#include <gtest/gtest.h>

namespace vinv::drive {
namespace {

void run(RemoteSetting& r, const RemoteSettings& s, const RemoteInputs& in, int ms) {
  for (int i = 0; i < ms; ++i) r.step(0.001, s, in);
}

TEST(RemoteSetting, RaisesLowersAndClearsWithItsRates) {
  RemoteSetting r;
  const RemoteSettings s{.raise_rate_hz_s = 10, .lower_rate_hz_s = 5, .max_hz = 60};
  run(r, s, {.raise = true, .start = true}, 2000);
  EXPECT_NEAR(r.frequency_hz(), 20, 1e-6);
  run(r, s, {.lower = true, .start = true}, 1000);
  EXPECT_NEAR(r.frequency_hz(), 15, 1e-6);
  run(r, s, {.raise = true, .lower = true, .start = true}, 1000);
  EXPECT_NEAR(r.frequency_hz(), 15, 1e-6);
  run(r, s, {.raise = true, .clear = true, .start = true}, 1);
  EXPECT_EQ(r.frequency_hz(), 0);
}

TEST(RemoteSetting, StaysBetweenZeroAndMaximum) {
  RemoteSetting r;
  const RemoteSettings s{.raise_rate_hz_s = 10, .lower_rate_hz_s = 10, .max_hz = 5};
  run(r, s, {.raise = true}, 2000);
  EXPECT_EQ(r.frequency_hz(), 5);
  run(r, s, {.lower = true}, 2000);
  EXPECT_EQ(r.frequency_hz(), 0);
}

TEST(RemoteSetting, StoresWhenTheStartSignalGoesOff) {
  RemoteSetting r;
  const RemoteSettings s{};
  run(r, s, {.raise = true, .start = true}, 1000);
  EXPECT_FALSE(r.take_store().has_value());
  run(r, s, {}, 1);
  const auto stored = r.take_store();
  ASSERT_TRUE(stored.has_value());
  EXPECT_NEAR(*stored, 10, 1e-6);
  run(r, s, {.start = true}, 10);
  run(r, s, {}, 10);
  EXPECT_FALSE(r.take_store().has_value());  // unchanged since
}

TEST(RemoteSetting, StoresAfterAMinuteOfRest) {
  RemoteSetting r;
  const RemoteSettings s{};
  run(r, s, {.raise = true, .start = true}, 1000);
  run(r, s, {.start = true}, 59'990);
  EXPECT_FALSE(r.take_store().has_value());
  run(r, s, {.start = true}, 20);
  EXPECT_TRUE(r.take_store().has_value());
  run(r, s, {.start = true}, 70'000);
  EXPECT_FALSE(r.take_store().has_value());
}

TEST(RemoteSetting, WithoutMemoryNothingIsStored) {
  RemoteSetting r;
  const RemoteSettings s{.memory = false};
  run(r, s, {.raise = true, .start = true}, 1000);
  run(r, s, {}, 70'000);
  EXPECT_FALSE(r.take_store().has_value());
  EXPECT_NEAR(r.frequency_hz(), 10, 1e-6);  // kept until power-off
}

TEST(RemoteSetting, PowerOnResumesTheStoredFrequency) {
  RemoteSetting r;
  r.power_on(12.5);
  EXPECT_EQ(r.frequency_hz(), 12.5);
  run(r, RemoteSettings{}, {}, 70'000);
  EXPECT_FALSE(r.take_store().has_value());
}

}  // namespace
}  // namespace vinv::drive
