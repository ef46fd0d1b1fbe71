// A vehicle against what lies loose: neither passes through the other, nothing comes from nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "bench/machine_files.h"
#include "sim/contact/closest.h"
#include "sim/contact/loose_bodies.h"
#include "sim/driveline/parameters.h"
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

struct Pusher {
  const char* name;
  WheeledVehicleParameters vehicle;
  DrivelineParameters driveline;
  double front_m;
  double crate_m;
  double crate_kg;
};

std::vector<Pusher> pushers() {
  const bench::Gator& gator = bench::gator_855d();
  return {{"Unimog", {}, {}, 4.75, 1.2, 1000.0},
          {"Gator", gator.vehicle, gator.driveline, 2.45, 0.9, 300.0}};
}

/// A crate in front of the vehicle, before a wall or not, and a vehicle in first gear.
struct Push {
  Push(const Pusher& by, double step_s, bool wall) : ground(before(by, wall)) {
    const double half_m = 0.5 * by.crate_m;
    LooseBody crate{.name = "crate",
                    .shape = ConvexShape::box(Vector(half_m, 1.3 * half_m, half_m))};
    crate.mass_kg = by.crate_kg;
    crate.inertia_kgm2.setConstant(by.crate_kg * by.crate_m * by.crate_m / 5.0);
    crate.X_WB.translation() << by.front_m + kApart_m + half_m, 0.05, half_m;
    ground.set_loose({crate});
    ground.loose()->settle(5.0);
    WheeledVehicleParameters parameters = by.vehicle;
    parameters.step_s = step_s;
    machine = make_wheeled_vehicle(parameters, ground, make_driveline(by.driveline), {});
    VehicleCommand command = released();
    command.gear = 1;
    command.engine_control = EngineControl::speed;
    command.engine_speed_radps = (by.crate_kg > 500.0 ? 1000.0 : 2000.0) * std::numbers::pi / 30.0;
    machine->command(command);
  }
  static Ground before(const Pusher& by, bool wall) {
    HeightField field;
    field.origin_m = {-100.0, -100.0};
    field.cell_m = 5.0;
    field.columns = field.rows = 61;
    field.heights_m.assign(61 * 61, 0.0);
    SoilParameters soil;
    soil.friction = 0.8;
    Obstacle stop;
    stop.X_WO.translation() << by.front_m + kApart_m + by.crate_m + 0.52, 0.0, 1.5;
    stop.half_lengths_m = Vector(0.5, 6.0, 1.5);
    return Ground(field, SoilMap{{soil}, {}}, wall ? std::vector{stop} : std::vector<Obstacle>());
  }
  /// By the shapes alone, of what is no tyre.
  [[nodiscard]] double overlap_m() const {
    double deepest = 0.0;
    const Mover& crate = ground.loose()->movers()[0];
    for (const ContactBody& body : machine->contact().bodies()) {
      if (!body.soft && body.meets_obstacles) {
        const Eigen::Isometry3d X_WS = machine->links()[body.link].X_WL * body.X_LS;
        deepest = std::max(deepest,
                           -separation({&body.shape, X_WS}, {crate.shape, crate.X_WM}, 0.0).gap_m);
      }
    }
    return deepest;
  }
  [[nodiscard]] double crate_x_m() const {
    return ground.loose()->movers()[0].X_WM.translation().x();
  }

  static constexpr double kApart_m = 0.2;
  Ground ground;
  std::unique_ptr<WheeledVehicle> machine;
};

class PushedThings : public testing::TestWithParam<double> {};

// The springs of a push that lasted were softened step by step: 0.56 m after a minute at a wall,
// 0.97 m after 15 m of the way.
TEST_P(PushedThings, StayOutsideOfWhatPushesThem) {
  constexpr double kBlow_s = 5.0;  // Until then it has run into it.
  const double step_s = GetParam();
  for (const Pusher& by : pushers()) {
    for (const bool wall : {true, false}) {
      Push push(by, step_s, wall);
      const double from_m = push.crate_x_m();
      double deepest_m = 0.0;
      double told_m = 0.0;
      double gave_j = 0.0;
      double lost_j = 0.0;
      const int steps = static_cast<int>(std::lround(60.0 / step_s));
      for (int i = 0; i < steps && push.crate_x_m() < from_m + 50.0; ++i) {
        push.machine->step(from_seconds(step_s));
        const ContactReport& report = *push.machine->contact_report();
        gave_j = std::max(gave_j, lost_j - report.lost_j);
        lost_j = std::max(lost_j, report.lost_j);
        if (i % 50 == 0 && i * step_s > kBlow_s) {
          deepest_m = std::max(deepest_m, push.overlap_m());
          told_m = std::max(told_m, report.deepest_m);
        }
      }
      const std::string what = std::string(by.name) + (wall ? " at a wall" : " free");
      EXPECT_FALSE(push.machine->non_finite()) << what;
      EXPECT_GT(push.machine->contact_report()->force_n, 500.0) << what;
      EXPECT_LT(deepest_m, 0.01) << what;
      // Where it is seen it stands one step behind.
      const double behind_m = step_s * push.machine->links()[0].v_WL_W.norm();
      EXPECT_NEAR(told_m, deepest_m, 1e-3 + behind_m) << what;
      EXPECT_LT(gave_j, 50.0) << what;
      if (!wall) {
        EXPECT_GT(push.crate_x_m(), from_m + 40.0) << what;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, PushedThings, testing::Values(5e-4, 1e-3, 2e-3),
                         [](const auto& step) {
                           return "step_" + std::to_string(std::lround(1e4 * step.param)) +
                                  "_tenths_of_ms";
                         });

}  // namespace
}  // namespace rigwire::sim::test
