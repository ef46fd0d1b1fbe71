// The roller leaves its drums where the resultant of weight and inertia leaves what they stand on,
// falls as a rigid body does, and comes to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "../contact/free_body.h"
#include "roller_rig.h"

namespace rigwire::sim::test {
namespace {

/// Steel that would hold on any of these slopes: it tips before it slides.
constexpr double kGrip = 2.0;

Ground shaped(const std::function<double(double, double)>& height_m, double cell_m,
              std::vector<Obstacle> obstacles = {}, double friction = kGrip) {
  constexpr double kHalf_m = 30.0;
  HeightField field;
  field.origin_m = {-kHalf_m, -kHalf_m};
  field.cell_m = cell_m;
  const auto count = static_cast<std::size_t>(2.0 * kHalf_m / cell_m) + 1;
  field.columns = field.rows = count;
  for (std::size_t row = 0; row < count; ++row) {
    for (std::size_t column = 0; column < count; ++column) {
      field.heights_m.push_back(height_m(-kHalf_m + cell_m * static_cast<double>(column),
                                         -kHalf_m + cell_m * static_cast<double>(row)));
    }
  }
  return Ground(field, SoilMap{{surface(friction)}, {}}, std::move(obstacles));
}

/// A slope across the machine's way, its left side up where positive, that ends in level ground
/// 1.5 m beside the machine's middle.
Ground across(double slope_rad) {
  const double side = slope_rad < 0.0 ? -1.0 : 1.0;
  return shaped(
      [=](double, double y) {
        return std::tan(std::abs(slope_rad)) * std::max(0.0, 1.5 + side * y);
      },
      0.5);
}

double limit_rad(const TandemRoller& machine) {
  return std::atan2(0.5 * machine.parameters().drum.width_m, machine.mass().height_m);
}

/// About the frame's x, left side up positive.
double roll_rad(const TandemRoller& machine) {
  const Eigen::Matrix3d R = frame(machine).X_WL.linear();
  return std::atan2(R(2, 1), R(2, 2));
}

/// Kinetic and potential energy of the body and both drums.
double energy_j(const TandemRoller& machine) {
  const RollerMass& mass = machine.mass();
  const LinkMotion& link = frame(machine);
  const Eigen::Matrix3d R = link.X_WL.linear();
  const Eigen::Vector3d c_W = R * Eigen::Vector3d(mass.x_m, 0.0, mass.height_m);
  const Eigen::Vector3d v = link.v_WL_W + link.w_WL_W.cross(c_W);
  const Eigen::Vector3d w = R.transpose() * link.w_WL_W;
  double sum = 0.5 * mass.mass_kg * v.squaredNorm() +
               0.5 * w.dot(mass.inertia_kgm2.cwiseProduct(w)) +
               mass.mass_kg * kGravity * (link.X_WL.translation() + c_W).z();
  for (std::size_t i = 0; i < 2; ++i) {
    const double spin = machine.drum_rate_radps(i) + w.y();
    sum += 0.5 * machine.parameters().drum.spin_inertia_kgm2 * spin * spin;
  }
  return sum;
}

RollerParameters loaded(double chips_kg) {
  RollerParameters p;
  p.spreader.initial_kg = chips_kg;
  return p;
}

TEST(RollerTipping, PlacedAcrossASlopeItFallsFromItsClosedFormsAngleOn) {
  for (const double chips_kg : {0.0, 2400.0}) {
    RollerParameters p = loaded(chips_kg);
    const Ground flat = level();
    const double limit = limit_rad(TandemRoller(p, flat, {0.0, 0.0}, 0.0));
    for (const double side : {-1.0, 1.0}) {
      for (const double beyond_deg : {-0.1, 0.1}) {
        const double slope = side * (limit + beyond_deg * kDegree);
        const Ground ground = across(slope);
        TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
        EXPECT_NEAR(roll_rad(machine), slope, 1e-9);
        machine.step(20s);
        EXPECT_FALSE(machine.non_finite());
        EXPECT_EQ(machine.tipped(), beyond_deg > 0.0) << chips_kg << ' ' << beyond_deg;
        if (beyond_deg > 0.0) {  // On its side, and at rest there.
          EXPECT_GT(std::abs(roll_rad(machine)), slope * side + 60.0 * kDegree);
        } else {
          EXPECT_NEAR(roll_rad(machine), slope, 1e-6);
        }
      }
    }
  }
}

TEST(RollerTipping, DrivenSlowlyOntoASlopeItFallsAtTheSameAngle) {
  // A surface that turns about the way: level at x = -15 m, and by 2 degrees per metre from there.
  const Ground ground = shaped(
      [](double x, double y) { return y * std::tan(std::max(0.0, 2.0 * kDegree * (x + 15.0))); },
      0.5);
  TandemRoller machine({}, ground, {-20.0, 0.0}, 0.0);
  machine.command(travel(0.4));
  double roll = 0.0;
  for (int i = 0; i < 80000 && !machine.tipped(); ++i) {
    roll = roll_rad(machine);
    machine.step(1ms);
  }
  EXPECT_TRUE(machine.tipped());
  EXPECT_NEAR(std::abs(roll), limit_rad(machine), 0.5 * kDegree);
}

TEST(RollerTipping, StandsForAnHourJustBelow) {
  RollerParameters p;
  p.step_s = 5e-3;
  const Ground flat = level();
  const double limit = limit_rad(TandemRoller(p, flat, {0.0, 0.0}, 0.0));
  const Ground ground = across(limit - 0.1 * kDegree);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.step(10s);
  const Eigen::Vector3d before = position(machine);
  machine.step(std::chrono::hours(1));
  EXPECT_FALSE(machine.tipped());
  EXPECT_LT((position(machine) - before).norm(), 1e-5);
}

TEST(RollerTipping, FallsByTheEnergyOfARodAboutItsEdgeAndGainsNone) {
  RollerParameters p;
  const Ground flat = level();
  const double limit = limit_rad(TandemRoller(p, flat, {0.0, 0.0}, 0.0));
  const Ground ground = across(limit + 0.3 * kDegree);
  for (const double step_s : {2e-4, 1e-3, 5e-3}) {
    p.step_s = step_s;
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    const double start_j = energy_j(machine);
    const double start_z =
        (frame(machine).X_WL * Eigen::Vector3d(machine.mass().x_m, 0.0, machine.mass().height_m))
            .z();
    double gained_j = 0.0;
    bool compared = false;
    for (int i = 0; i < 4000; ++i) {
      machine.step(5ms);
      // What the contacts have lost, and the springs that they hold, came from the machine.
      gained_j = std::max(gained_j, energy_j(machine) + machine.contact_report()->lost_j - start_j);
      if (!compared && roll_rad(machine) > limit + 25.0 * kDegree) {
        compared = true;
        // I w^2 / 2 about the edge is what the centre of mass has come down.
        const RollerMass& mass = machine.mass();
        const Eigen::Vector3d c(mass.x_m, 0.0, mass.height_m);
        const double down = start_z - (frame(machine).X_WL * c).z();
        const double arm2 = std::pow(0.5 * p.drum.width_m, 2) + std::pow(mass.height_m, 2);
        const double inertia = mass.inertia_kgm2.x() + mass.mass_kg * arm2;
        const double wanted = std::sqrt(2.0 * mass.mass_kg * kGravity * down / inertia);
        EXPECT_NEAR(frame(machine).w_WL_W.norm(), wanted, 0.05 * wanted) << step_s;
      }
    }
    EXPECT_TRUE(compared);
    EXPECT_LT(gained_j, 20.0) << step_s;
    EXPECT_GT(start_j - energy_j(machine), 2e4);
    EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-3) << step_s;
  }
}

TEST(RollerTipping, LyingItRestsAndItsAccelerometerFeelsGravityAcross) {
  const Ground ground = across(43.0 * kDegree);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  machine.step(20s);
  ASSERT_TRUE(machine.tipped());
  const Eigen::Vector3d felt = specific_force(frame(machine));
  EXPECT_NEAR(felt.norm(), kGravity, 1e-3);
  EXPECT_GT(std::abs(felt.y()), 0.8 * kGravity);
  EXPECT_TRUE(machine.contact_report()->terrain);
  const Eigen::Vector3d before = position(machine);
  machine.step(60s);
  EXPECT_LT((position(machine) - before).norm(), 1e-3);
}

TEST(RollerTipping, VelocityIsTheChangeOfPositionWhileItFalls) {
  const Ground ground = across(43.0 * kDegree);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  for (int i = 0; i < 3000; ++i) {
    const LinkMotion before = frame(machine);
    machine.step(1ms);
    const LinkMotion& after = frame(machine);
    const Eigen::Vector3d mean = 0.5 * (before.v_WL_W + after.v_WL_W);
    const Eigen::Vector3d moved = after.X_WL.translation() - before.X_WL.translation();
    // A blow changes it within a step.
    const double change = (after.v_WL_W - before.v_WL_W).norm();
    ASSERT_LT((moved - 1e-3 * mean).norm(), 1e-3 * (0.01 + change)) << i;
    const Eigen::Matrix3d turned = before.X_WL.linear().transpose() * after.X_WL.linear();
    const Eigen::AngleAxisd turn(turned);
    ASSERT_NEAR(turn.angle(), 1e-3 * after.w_WL_W.norm(), 1e-9) << i;
  }
}

TEST(RollerTipping, AKerbUnderOneEdgeIsClimbedAndLeftWithoutTipping) {
  // Under the left third of both drums.
  const Ground ground = shaped([](double, double) { return 0.0; }, 5.0,
                               {box_obstacle({8.0, 1.5, 0.0}, {2.0, 1.2, 0.25})}, 0.8);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.0));
  double most_rad = 0.0;
  double most_mps2 = 0.0;
  for (int i = 0; i < 20000; ++i) {
    machine.step(1ms);
    most_rad = std::max(most_rad, std::abs(roll_rad(machine)));
    most_mps2 = std::max(most_mps2, frame(machine).a_WL_W.norm());
  }
  EXPECT_FALSE(machine.non_finite());
  EXPECT_FALSE(machine.tipped());
  EXPECT_GT(position(machine).x(), 13.0);
  // Over the far rim: 0.25 m on 1.14 to 1.68 m.
  EXPECT_GT(most_rad, 6.0 * kDegree);
  EXPECT_LT(most_rad, 13.0 * kDegree);
  EXPECT_LT(most_mps2, 8.0 * kGravity);
}

TEST(RollerTipping, OverABanksEdgeItFallsWhenItsCentreOfMassIsOverIt) {
  constexpr double kEdge_m = -2.0;
  const Ground ground = shaped([](double, double y) { return y < kEdge_m ? -2.0 : 0.0; }, 0.1);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  // Crabs to its right.
  machine.command(travel(0.5, -20.0 * kDegree, -20.0 * kDegree));
  for (int i = 0; i < 40000 && !machine.tipped(); ++i) {
    machine.step(1ms);
  }
  ASSERT_TRUE(machine.tipped());
  const double centre_m =
      (frame(machine).X_WL * Eigen::Vector3d(machine.mass().x_m, 0.0, machine.mass().height_m)).y();
  EXPECT_NEAR(centre_m, kEdge_m, 0.2);
  machine.command(VehicleCommand{});
  machine.step(10s);
  EXPECT_FALSE(machine.non_finite());
  EXPECT_TRUE(machine.tipped());
  EXPECT_LT(position(machine).z(), -0.5);
  EXPECT_LT(frame(machine).v_WL_W.norm(), 0.05);
}

TEST(RollerTipping, ADrumOverAnEdgeCarriesNothingAndTheMachineNosesDown) {
  const Ground ground = shaped([](double x, double) { return x > 3.0 ? -1.5 : 0.0; }, 0.1);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(0.8));
  for (int i = 0; i < 40000 && !machine.tipped(); ++i) {
    machine.step(1ms);
  }
  ASSERT_TRUE(machine.tipped());
  // It rolls about the edge until that is farther round than 2 to 1 from below its axle.
  EXPECT_NEAR(position(machine).x(), 3.0 - 1.7 + 0.6 * std::sin(std::atan(2.0)), 0.1);
  machine.step(50ms);
  EXPECT_EQ(machine.drum_load_n(0), 0.0);
  EXPECT_GT(machine.drum_load_n(1), 1e4);
  // It never falls faster than a body does.
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    machine.step(1ms);
    fastest = std::max(fastest, -frame(machine).v_WL_W.z());
  }
  EXPECT_FALSE(machine.non_finite());
  EXPECT_LT(fastest, std::sqrt(2.0 * kGravity * 1.7));
  EXPECT_LT(frame(machine).X_WL.linear()(2, 0), -0.15);
}

/// Level up to x = 3 m, and from there so much higher.
Ground stepped(double rise_m) {
  return shaped([=](double x, double) { return x > 3.0 ? rise_m : 0.0; }, 0.1, {}, 0.8);
}

struct Passage {
  bool fell = false;
  double deepest_m = 0.0;
  double most_mps2 = 0.0;
};

/// Drives at walking pace until it is beyond x = 12 m, or for 20 s.
Passage drive_over(TandemRoller& machine) {
  Passage passage;
  machine.command(travel(0.8));
  for (int i = 0; i < 20000 && position(machine).x() < 12.0; ++i) {
    machine.step(1ms);
    passage.fell = passage.fell || machine.tipped();
    passage.deepest_m = std::max(passage.deepest_m, machine.contact_report()->deepest_m);
    passage.most_mps2 = std::max(passage.most_mps2, frame(machine).a_WL_W.norm());
  }
  return passage;
}

TEST(RollerTipping, OverALowEdgeOfTheTerrainItsDrumsRoll) {
  for (const double rise_m : {-0.4, -0.25, -0.1, 0.1, 0.2}) {
    const Ground ground = stepped(rise_m);
    TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
    const Passage passage = drive_over(machine);
    EXPECT_FALSE(passage.fell) << rise_m;
    EXPECT_LT(passage.most_mps2, 8.0 * kGravity) << rise_m;
    EXPECT_GT(position(machine).x(), 11.9) << rise_m;
    EXPECT_NEAR(position(machine).z(), rise_m, 1e-3);
  }
}

TEST(RollerTipping, OffAnEdgeItFallsRollsOnAndStandsAgain) {
  for (const double drop_m : {0.5, 0.8, 1.0}) {
    const Ground ground = stepped(-drop_m);
    TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
    const Passage passage = drive_over(machine);
    EXPECT_TRUE(passage.fell) << drop_m;
    EXPECT_FALSE(machine.tipped()) << drop_m;
    EXPECT_NEAR(position(machine).z(), -drop_m, 2e-3);
    EXPECT_NEAR(frame(machine).v_WL_W.norm(), 0.8, 0.01);
    EXPECT_LT(passage.deepest_m, 0.02) << drop_m;
  }
}

TEST(RollerTipping, ABankAheadStopsItAndItDrivesBack) {
  for (const double rise_m : {0.6, 1.5, 2.5}) {
    const Ground ground = stepped(rise_m);
    TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
    const Passage passage = drive_over(machine);
    EXPECT_FALSE(passage.fell) << rise_m;
    EXPECT_LT(passage.deepest_m, 0.02) << rise_m;
    // A blow of 0.8 m/s within some milliseconds.
    EXPECT_LT(passage.most_mps2, 15.0 * kGravity) << rise_m;
    EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-3);
    // Its front drum's side at the bank.
    const TandemRoller& m = machine;
    EXPECT_NEAR(position(m).x(), 3.0 - m.parameters().pivot_x_m - m.parameters().drum.radius_m,
                0.15);
    EXPECT_TRUE(machine.contact_report()->terrain);
    machine.command(travel(-0.8));
    machine.step(6s);
    EXPECT_LT(position(machine).x(), -1.0) << rise_m;
    EXPECT_NEAR(position(machine).z(), 0.0, 1e-3);
  }
}

TEST(RollerTipping, RollingOnWhileItHasTippedItDoesNotSink) {
  // The front drum over the edge, the rear one on the level all the way.
  const Ground ground = stepped(-0.8);
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(0.8));
  while (!machine.tipped() && position(machine).x() < 4.0) {
    machine.step(1ms);
  }
  ASSERT_TRUE(machine.tipped());
  double lowest_m = 0.0;
  while (machine.tipped() && machine.links()[4].X_WL.translation().x() < 2.5) {
    machine.step(1ms);
    const double axle_m = machine.links()[4].X_WL.translation().z();
    lowest_m = std::min(lowest_m, axle_m - machine.parameters().drum.radius_m);
  }
  EXPECT_GT(lowest_m, -5e-3);
}

TEST(RollerTipping, WithoutForcesItNeverTips) {
  RollerParameters p;
  p.level = RollerLevel::kinematic;
  const Ground ground = Ground::plane({0.0, -std::sin(1.0), std::cos(1.0)}, surface(kGrip));
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.step(5s);
  EXPECT_FALSE(machine.tipped());
  EXPECT_NEAR(roll_rad(machine), 1.0, 1e-6);
}

}  // namespace
}  // namespace rigwire::sim::test
