#include "dig_cycle/sensor_watch.h"

#include <gtest/gtest.h>

namespace rigwire::dig_cycle {
namespace {

using namespace std::chrono_literals;

TEST(DigCycleSensorWatch, NeverHeardIsAbsentButNotSilent) {
  SensorWatch watch;
  EXPECT_FALSE(watch.silent(10s).has_value());
  EXPECT_FALSE(watch.all_alive(10s));
  EXPECT_EQ(watch.absent(10s), "gnss, lidar, imu_chassis, imu_boom, imu_stick, imu_bucket, valves");
}

TEST(DigCycleSensorWatch, EachSensorHasItsOwnPatience) {
  const std::array<std::chrono::milliseconds, kSensors> expected{3000ms, 500ms, 500ms, 500ms,
                                                                 500ms,  500ms, 500ms};
  for (std::size_t i = 0; i < kSensors; ++i) {
    const auto sensor = static_cast<Sensor>(i);
    SensorWatch watch;
    watch.heard(sensor, 100s);
    EXPECT_FALSE(watch.silent(100s + expected[i]).has_value()) << name(sensor);
    EXPECT_EQ(watch.silent(100s + expected[i] + 1ns), sensor) << name(sensor);
  }
}

TEST(DigCycleSensorWatch, AllAliveAfterEveryoneSpokeAndAgainAfterASilence) {
  SensorWatch watch;
  for (std::size_t i = 0; i < kSensors; ++i) {
    EXPECT_FALSE(watch.all_alive(1s));
    watch.heard(static_cast<Sensor>(i), 1s);
  }
  EXPECT_TRUE(watch.all_alive(1s));
  watch.heard(Sensor::lidar, 1300ms);
  watch.heard(Sensor::valves, 1300ms);
  EXPECT_EQ(watch.absent(1600ms), "imu_chassis, imu_boom, imu_stick, imu_bucket");
  for (std::size_t link = 0; link < 4; ++link) {
    watch.heard(imu_of(link), 1600ms);
  }
  EXPECT_TRUE(watch.all_alive(1600ms));
}

}  // namespace
}  // namespace rigwire::dig_cycle
