// The dig cycle in the rig that everybody sees first, in simulated time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "dig_cycle/estimator.h"
#include "hil/world/imu.h"
#include "pit_run.h"
#include "sanitized.h"
#include "sim/samples/imu_sample.h"

namespace rigwire::dig_cycle {
namespace {

using ::testing::HasSubstr;

const std::string kRig = std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/excavator_pit.yaml";
constexpr double kKgPerM3 = 1700.0;  // Density of the pit's gravel.

/// Ends the run with the bucket emptied: what is on its way is in neither account.
void finish_cycle(PitRun& run) {
  while (run.cycle().phase() != Phase::approach && !run.over()) {
    run.tick();
  }
}

// It put 36 % of its load into the truck, the rest between truck and machine, and dug where nothing
// was left: 1.1 t in 130 s, where a machine of its class moves 7 to 9 t.
class DigCycleInThePit : public testing::TestWithParam<int> {};

TEST_P(DigCycleInThePit, LoadsTheTruckAndNotTheGroundBesideIt) {
  PitRun run(kRig, {"seed=" + std::to_string(GetParam())}, {});
  const double span_s = kSanitized ? 30.0 : 130.0;
  while (run.seconds() < span_s && !run.over()) {
    run.tick();
  }
  ASSERT_FALSE(run.over()) << run.cycle().fault().value_or(run.cycle().finished().value_or(""));
  const double tonnes = 1e-3 * kKgPerM3 * run.in_truck_m3();
  EXPECT_GT(tonnes, 3.5 * span_s / 130.0 - (kSanitized ? 0.5 : 0.0));
  finish_cycle(run);
  EXPECT_GE(run.in_truck_m3(), 0.95 * run.lifted_m3());
  // What it believes of its work.
  EXPECT_NEAR(run.cycle().loaded_kg(), kKgPerM3 * run.lifted_m3(),
              0.1 * kKgPerM3 * run.lifted_m3());
}

INSTANTIATE_TEST_SUITE_P(Seeds, DigCycleInThePit, testing::Range(1, 6));

/// Four inertial units as the rig has them, and what the program makes of them.
class InertialUnits {
 public:
  InertialUnits(PitRun& run, std::uint64_t seed) {
    struct Mount {
      const char* link;
      Eigen::Vector3d place_m;
    };
    const std::array<Mount, kLinks> mounts{{{"upper", {-0.4, 0.0, 0.3}},
                                            {"boom", {2.5, 0.2, 0.5}},
                                            {"stick", {1.0, 0.17, 0.2}},
                                            {"bucket", {0.3, 0.3, 0.2}}}};
    const auto names = run.machine().link_names();
    for (std::size_t link = 0; link < kLinks; ++link) {
      hil::SensorMount mount;
      mount.link =
          static_cast<std::size_t>(std::ranges::find(names, mounts[link].link) - names.begin());
      mount.X_LS.translation() = mounts[link].place_m;
      run.attach(hil::make_world_imu(
                     link, mount, sim::ImuSensor(sim::openimu300_class(), seed, mounts[link].link)),
                 link, std::chrono::milliseconds{10});
    }
    run.on_slice = [this](const hil::SampleBatch& batch) { take(batch); };
    estimator_.swing(0.0, 0.0);
  }
  InertialUnits(const InertialUnits&) = delete;
  InertialUnits& operator=(const InertialUnits&) = delete;

  /// The swing encoder's angle, each control period.
  void swing_to(double angle_rad) {
    estimator_.swing(angle_rad, (angle_rad - swing_rad_) / PitRun::kControl_s);
    swing_rad_ = angle_rad;
  }

  [[nodiscard]] Belief belief() const { return estimator_.belief(); }

 private:
  void take(const hil::SampleBatch& batch) {
    for (std::size_t i = 0; i < kLinks; ++i) {
      if (const auto* samples = batch.samples.find<ImuSample>(i)) {
        for (const ImuSample& sample : *samples) {
          const auto link = static_cast<Link>(i);
          estimator_.imu_rate(link, -sample.angular_rate_radps.y);
          estimator_.imu_specific_force(link, sample.specific_force_mps2.x,
                                        sample.specific_force_mps2.z);
        }
      }
    }
  }

  Estimator estimator_;
  double swing_rad_ = 0.0;
};

class DigCycleBeliefs : public testing::TestWithParam<int> {};

// Offsets that were learnt too slowly, and the jerk of a start taken for gravity, put the boom off
// by 2 degrees.
TEST_P(DigCycleBeliefs, InertialUnitsShowTheArmToADegree) {
  PitRun run(kRig, {}, {});
  InertialUnits units(run, static_cast<std::uint64_t>(GetParam()));
  run.wait(2.5);
  ASSERT_TRUE(units.belief().rested);
  std::array<double, kJoints> squares{};
  int ticks = 0;
  for (; run.seconds() < 45.0 && !run.over(); ++ticks) {
    run.tick();
    units.swing_to(run.angles_rad()[swing]);
    for (const Joint joint : {boom, stick, bucket}) {
      const double error_deg =
          (units.belief().angles_rad[joint] - run.angles_rad()[joint]) / kDegree;
      squares[joint] += error_deg * error_deg;
    }
  }
  for (const Joint joint : {boom, stick, bucket}) {
    EXPECT_LT(std::sqrt(squares[joint] / ticks), 1.0) << "joint " << joint;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DigCycleBeliefs, testing::Range(1, 4));

TEST(DigCyclePit, GoesOnToWhereThereIsSoilUntilTheTruckIsFull) {
  PitRun run(kRig, {}, {.truck_load_kg = kSanitized ? 1e3 : 12e3});
  double least_rad = 0.0;
  double greatest_rad = 0.0;
  while (!run.over() && run.seconds() < 600.0) {
    run.tick();
    if (run.cycle().phase() == Phase::dig) {
      least_rad = std::min(least_rad, run.angles_rad()[swing]);
      greatest_rad = std::max(greatest_rad, run.angles_rad()[swing]);
    }
  }
  ASSERT_TRUE(run.cycle().done()) << run.cycle().fault().value_or("not in 600 s");
  EXPECT_THAT(*run.cycle().finished(), HasSubstr("the truck is full: "));
  if (!kSanitized) {
    EXPECT_GT(greatest_rad - least_rad, 15.0 * kDegree);
    EXPECT_GT(1e-3 * kKgPerM3 * run.in_truck_m3(), 11.0);
  }
}

}  // namespace
}  // namespace rigwire::dig_cycle
