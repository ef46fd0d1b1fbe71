// What a device is told of a quantity while a fault of it holds.
#include "emulators/sample_fault.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using Fault = SampleFault<ImuSample>;

const FaultPeriod kOneToThree{.at = 1s, .length = 2s};
constexpr std::size_t kForceX = 0;
constexpr std::size_t kRateZ = 5;

/// Forward forces that a client sees: samples come each 100 ms, and the force put in is their time
/// in seconds.
std::vector<double> seen(const Fault& fault) {
  FaultySamples<ImuSample> faults({fault}, 1);
  std::vector<double> forces;
  for (int i = 0; i < 50; ++i) {
    ImuSample sample;
    sample.time = kStart + i * 100ms;
    sample.specific_force_mps2.x = 0.1 * i;
    sample.angular_rate_radps.z = 7.0;
    faults.lay_over(sample);
    EXPECT_EQ(sample.angular_rate_radps.z, 7.0) << "another quantity";
    forces.push_back(sample.specific_force_mps2.x);
  }
  return forces;
}

/// Outside the fault it is what it is; within, as `expected(i)` says of sample i.
template <class Expected>
void expect(const Fault& fault, const Expected& expected) {
  const std::vector<double> forces = seen(fault);
  for (int i = 0; i < 50; ++i) {
    EXPECT_DOUBLE_EQ(forces[static_cast<std::size_t>(i)], i >= 10 && i < 30 ? expected(i) : 0.1 * i)
        << i;
  }
}

TEST(SampleFault, AnOffsetGrowsOverItsRamp) {
  expect({kOneToThree, OffsetFault<ImuSample>{{kForceX}, 0.5}},
         [](int i) { return 0.1 * i + 0.5; });
  expect({kOneToThree, OffsetFault<ImuSample>{{kForceX}, 0.5, 1s}},
         [](int i) { return 0.1 * i + 0.5 * std::min(1.0, (i - 10) / 10.0); });
}

TEST(SampleFault, AScaleIsAFactor) {
  expect({kOneToThree, ScaleFault<ImuSample>{{kForceX}, 0.9}},
         [](int i) { return 0.9 * (0.1 * i); });
}

TEST(SampleFault, AStuckQuantityStaysWhatItWasWhenTheFaultBegan) {
  expect({kOneToThree, StuckFault<ImuSample>{{kForceX}}}, [](int) { return 1.0; });
  const std::vector<double> again =
      seen({{.length = 500ms, .every = 1s}, StuckFault<ImuSample>{{kForceX}}});
  EXPECT_DOUBLE_EQ(again[4], 0.0);
  EXPECT_DOUBLE_EQ(again[14], 1.0) << "what it was in the repetition before";
}

TEST(SampleFault, ALimitAndADeadZoneCutWhatIsBeyondAndWithin) {
  expect({kOneToThree, SaturatedFault<ImuSample>{{kForceX}, 2.0}},
         [](int i) { return std::min(2.0, 0.1 * i); });
  expect({kOneToThree, DeadZoneFault<ImuSample>{{kForceX}, 2.0}},
         [](int i) { return 0.1 * i < 2.0 ? 0.0 : 0.1 * i; });
}

TEST(SampleFault, NoiseHasItsDeviation) {
  FaultySamples<ImuSample> faults({{FaultPeriod{}, NoisierFault<ImuSample>{{kRateZ}, 0.2}}}, 3);
  double sum = 0.0;
  double square = 0.0;
  constexpr int kSamples = 10'000;
  for (int i = 0; i < kSamples; ++i) {
    ImuSample sample;
    sample.time = kStart + i * 1ms;
    faults.lay_over(sample);
    sum += sample.angular_rate_radps.z;
    square += sample.angular_rate_radps.z * sample.angular_rate_radps.z;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 4 * 0.2 / 100.0);
  EXPECT_NEAR(std::sqrt(square / kSamples), 0.2, 4 * 0.2 / std::sqrt(2.0 * kSamples));
}

}  // namespace
}  // namespace rigwire::emulators
