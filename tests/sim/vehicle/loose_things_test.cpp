// A vehicle against what lies loose: neither passes through the other, nothing comes from nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/contact/loose_bodies.h"
#include "sim/random.h"
#include "sim/scene/loose_rock.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;
using Vector = Eigen::Vector3d;

LooseBody rock_ahead(double radius_m, double x_m, double y_m) {
  RandomStream random(3, "rock");
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x_m, y_m, radius_m;
  return loose_rock(make_rock("rock", random), X, radius_m, 2650.0, "rock").body;
}

struct Hit {
  double radius_m = 0.5;
  double speed_mps = 13.9;
};

class RockInTheWay : public testing::TestWithParam<Hit> {};

// 3 kg to 3 t, in the way of a front wheel and in the middle, up to 50 km/h.
TEST_P(RockInTheWay, IsHitAndNeverGivesBackMoreThanTheVehicleCameWith) {
  constexpr double kClear_m = 0.3;  // Smaller ones go under the vehicle.
  for (const double y_m : {0.0, 0.85}) {
    if (y_m == 0.0 && GetParam().radius_m < kClear_m) {
      continue;
    }
    Ground ground = slope(0.0, 0.6);
    ground.set_loose({rock_ahead(GetParam().radius_m, 7.0, y_m)});
    LooseBodies& loose = *ground.loose();
    loose.settle(5.0);
    BareVehicle rig(ground);
    rig.machine.command(released());
    rig.machine.start_rolling(GetParam().speed_mps);
    const auto energy = [&] {
      const VehicleMomentum m = rig.machine.momentum();
      return m.kinetic_j + m.potential_j + m.spring_j + loose.energy_j();
    };
    const double start = energy();
    double most = start;
    double fastest = 0.0;
    for (int i = 0; i < 3000; ++i) {
      rig.machine.step(1ms);
      most = std::max(most, energy());
      fastest = std::max(fastest, loose.motion(0).v_WL_W.norm());
    }
    const std::string what = std::to_string(GetParam().radius_m) + " m at y " + std::to_string(y_m);
    EXPECT_FALSE(rig.machine.non_finite()) << what;
    EXPECT_GT(rig.machine.contact_report()->touches, 0U) << what;
    EXPECT_TRUE(loose.moved(0)) << what;
    // A light one flies ahead with twice the speed at most, and what its turning adds.
    EXPECT_LT(fastest, 2.5 * GetParam().speed_mps) << what;
    EXPECT_LT(most, start + 0.005 * std::abs(start)) << what;
  }
}

INSTANTIATE_TEST_SUITE_P(Rocks, RockInTheWay,
                         testing::Values(Hit{0.08, 5.0}, Hit{0.5, 5.0}, Hit{0.25, 13.9},
                                         Hit{0.5, 13.9}, Hit{0.8, 13.9}),
                         [](const auto& hit) {
                           return std::to_string(std::lround(100.0 * hit.param.radius_m)) +
                                  "_cm_at_" + std::to_string(std::lround(hit.param.speed_mps)) +
                                  "_mps";
                         });

}  // namespace
}  // namespace rigwire::sim::test
