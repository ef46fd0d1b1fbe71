// Tilting, twisting, hitting with the chassis: dynamics cases 13, 14, 20.
#include <gtest/gtest.h>

#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

double uphill_load(const BareVehicle& rig) {
  return rig.machine.wheels()[0].load_n + rig.machine.wheels()[2].load_n;
}

double roll_of(const LinkMotion& link) {
  return std::atan2(link.X_WL.linear()(2, 1), link.X_WL.linear()(2, 2));
}

TEST(VehicleTilt, RigidVehicleUnloadsAsStaticsSay) {
  const WheeledVehicleParameters parameters = nearly_rigid({});
  const Eigen::Vector3d centre = static_loads(parameters).center_of_mass_m;
  const double weight = 9000.0 * kGravity;
  for (const double degrees : {10.0, 25.0, 35.0}) {
    const double tilt = degrees * kDegree;
    const BareVehicle rig(side_slope(tilt, 1.5), parameters);
    const double expected =
        weight * (0.5 * std::cos(tilt) - std::sin(tilt) * centre.z() / parameters.front.track_m);
    EXPECT_NEAR(uphill_load(rig), expected, 0.012 * weight) << degrees;
  }
}

TEST(VehicleTilt, SpringsTipItEarlierThanTheRigidAngle) {
  const WheeledVehicleParameters parameters;
  const double rigid =
      std::atan(0.5 * parameters.front.track_m / static_loads(parameters).center_of_mass_m.z());
  EXPECT_GT(rigid, 39.5 * kDegree);
  const BareVehicle tips(side_slope(0.99 * rigid, 1.5), parameters);
  EXPECT_FALSE(tips.machine.non_finite());
  EXPECT_LT(uphill_load(tips), 1.0);
}

// Finding: placed on a slope it toppled from 29.3 degrees, through its start's own swing. The press
// says 38 (docs/machines/unimog-u5023.md).
TEST(VehicleTilt, PlacedItTipsAtThePressFigure) {
  for (const double degrees : {30.0, 34.0, 37.0}) {
    BareVehicle stands(side_slope(degrees * kDegree, 1.5));
    EXPECT_GT(uphill_load(stands), 0.0) << degrees;
    EXPECT_LT(stands.machine.links()[0].v_WL_W.norm(), 1e-9);
    stands.machine.step(5s);
    EXPECT_GT(uphill_load(stands), 0.0) << degrees;
    EXPECT_LT(stands.machine.links()[0].v_WL_W.norm(), 1e-3) << degrees;
  }
  const BareVehicle tips(side_slope(39.0 * kDegree, 1.5));
  EXPECT_LT(uphill_load(tips), 1.0);
}

// Finding: driven slowly onto it, it toppled at 35.1 degrees.
TEST(VehicleTilt, DrivenOntoItItTipsAtThePressFigure) {
  // Twisted ground: the side slope grows from 30 degrees by 0.2 per metre of way.
  HeightField field;
  field.origin_m = {-10.0, -20.0};
  field.cell_m = 0.5;
  field.columns = 141;
  field.rows = 81;
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      const double x = field.origin_m.x() + 0.5 * static_cast<double>(column);
      const double y = field.origin_m.y() + 0.5 * static_cast<double>(row);
      field.heights_m.push_back(y * std::tan((30.0 + 0.2 * std::max(0.0, x)) * kDegree));
    }
  }
  SoilMap soils;
  soils.soils[0].friction = 1.5;
  BareVehicle rig(Ground(field, soils, {}));
  rig.machine.command(released());
  rig.machine.start_rolling(1.0);
  double tipped_at = 0.0;
  for (int i = 0; i < 60'000 && tipped_at == 0.0; ++i) {
    // Held at 1 m/s by a torque on all wheels.
    rig.equations.torque_nm.setConstant(5e3 * (1.0 - rig.speed()));
    rig.machine.step(1ms);
    if (uphill_load(rig) < 1.0) {
      const double middle = 0.5 * (rig.machine.links()[1].X_WL.translation().x() +
                                   rig.machine.links()[2].X_WL.translation().x());
      tipped_at = 30.0 + 0.2 * middle;
    }
  }
  EXPECT_NEAR(tipped_at, 38.0, 1.0);
}

// Finding: 20 degrees/g. What is left is an estimate: 8 degrees/g.
TEST(VehicleTilt, RollGradientIsThatOfItsPage) {
  const BareVehicle rig(side_slope(5.0 * kDegree, 1.5));
  const double roll = std::abs(roll_of(rig.machine.links()[0])) / kDegree;
  EXPECT_NEAR((roll - 5.0) / std::sin(5.0 * kDegree), 7.6, 0.3);
}

// A steady circle: what was measured on a side slope is so while driving, and it understeers.
TEST(VehicleHandling, SteadyCircleGivesTheGradientsOfItsPage) {
  struct Steady {
    double curve_rad;  // L r / v: the steer that the circle would need without slip.
    double across_mps2;
    double roll_rad;
  };
  const auto circle = [](double start_mps) {
    BareVehicle rig(slope(0.0));
    VehicleCommand command = released();
    command.front_steer_rad = 0.1;
    rig.machine.command(command);
    rig.machine.start_rolling(start_mps);
    Steady mean{};
    for (int i = 0; i < 5000; ++i) {
      rig.machine.step(std::chrono::milliseconds(1));
      if (i >= 4000) {
        const LinkMotion body = rig.machine.links()[0];
        const double speed = body.v_WL_W.norm();
        const double turn = body.w_WL_W.z();
        mean.curve_rad += 1e-3 * WheeledVehicleParameters{}.wheelbase_m() * turn / speed;
        mean.across_mps2 += 1e-3 * speed * turn;
        mean.roll_rad += 1e-3 * std::asin(body.X_WL.linear()(2, 1));
      }
    }
    return mean;
  };
  const Steady slow = circle(2.0);
  const Steady fast = circle(12.0);
  ASSERT_GT(fast.across_mps2, 2.0);
  const double per_g = kGravity / (fast.across_mps2 - slow.across_mps2) / kDegree;
  EXPECT_NEAR((slow.curve_rad - fast.curve_rad) * per_g, 0.84, 0.1) << "understeer, deg/g";
  EXPECT_NEAR((fast.roll_rad - slow.roll_rad) * per_g, 7.8, 0.3) << "roll, deg/g";
}

/// Front left and rear right wheel on blocks.
Ground diagonal_blocks(double height_m) {
  HeightField field;
  field.origin_m = {-50.0, -50.0};
  field.cell_m = 100.0;
  field.columns = 2;
  field.rows = 2;
  field.heights_m.assign(4, 0.0);
  std::vector<Obstacle> blocks(2);
  for (Obstacle& block : blocks) {
    block.half_lengths_m = {0.8, 0.5, 0.5 * height_m};
    block.friction = 0.9;
  }
  blocks[0].X_WO.translation() = Eigen::Vector3d(3.85, 0.97, 0.5 * height_m);
  blocks[1].X_WO.translation() = Eigen::Vector3d(0.0, -0.97, 0.5 * height_m);
  return {std::move(field), SoilMap{}, std::move(blocks)};
}

TEST(VehicleArticulation, FrameRollsBetweenTheAxlesByTheirStiffness) {
  WheeledVehicleParameters parameters;
  parameters.front.beam.roll_bar_nmprad = 9e4;
  const BareVehicle rig(diagonal_blocks(0.1), parameters);
  ASSERT_FALSE(rig.machine.non_finite());
  const double base = 0.5 * 1.6e5 * 1.05 * 1.05;
  const double front = base + 9e4;
  const double rear = base + parameters.rear.beam.roll_bar_nmprad;
  const auto links = rig.machine.links();
  // The sprung mass leans over its roll axis.
  const StaticLoads loads = static_loads(parameters);
  const double above = parameters.body.center_of_mass_m.z() - loads.wheel_height_m[0] -
                       parameters.front.portal_offset_m - parameters.front.beam.roll_centre_rise_m;
  const double leaning = parameters.body.mass_kg * kGravity * above;
  const double expected =
      (front * roll_of(links[1]) + rear * roll_of(links[2])) / (front + rear - leaning);
  EXPECT_GT(roll_of(links[1]), 1.0 * kDegree);
  EXPECT_LT(roll_of(links[2]), -1.0 * kDegree);
  EXPECT_NEAR(roll_of(links[0]), expected, 0.06 * std::abs(expected) + 1e-4);
}

TEST(VehicleArticulation, LimiterHoldsAndTheDiagonalIsUnloaded) {
  BareVehicle rig(diagonal_blocks(0.55));
  rig.machine.step(2s);
  ASSERT_FALSE(rig.machine.non_finite());
  const auto& s = rig.machine.suspension();
  EXPECT_LT(std::abs(s[1]), 32.0 * kDegree);
  EXPECT_LT(std::abs(s[3]), 17.0 * kDegree);
  EXPECT_GT(std::abs(s[3]), 10.0 * kDegree);
  EXPECT_NEAR(rig.total_load(), 9000.0 * kGravity, 0.02 * 9000.0 * kGravity);
  double least = 1e9;
  for (const WheelState& wheel : rig.machine.wheels()) {
    EXPECT_GE(wheel.load_n, 0.0);
    least = std::min(least, wheel.load_n);
  }
  EXPECT_LT(least, 1.2e4);  // 21 kN on level ground.
}

TEST(VehicleChassis, UpsideDownItLiesOnItsRoof) {
  BareVehicle rig(slope(0.0));
  FullVehicleState state = rig.machine.state();
  state.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  state.p_WC = {2.0, 0.0, 2.2};
  rig.machine.set_state(state);
  rig.machine.step(6s);
  ASSERT_FALSE(rig.machine.non_finite());
  EXPECT_LT(rig.machine.links()[0].v_WL_W.norm(), 5e-2);
  EXPECT_GT(rig.machine.state().p_WC.z(), 0.5);
  EXPECT_EQ(rig.total_load(), 0.0);
}

TEST(VehicleMotion, FastYawSpinHasTheCentripetalAcceleration) {
  WheeledVehicleParameters parameters;
  parameters.gravity_mps2 = 0.0;
  parameters.air_drag_ns2pm2 = 0.0;
  for (VehicleAxleParameters* axle : {&parameters.front, &parameters.rear}) {
    axle->beam.mass_kg = 1e-6;
    axle->beam.roll_inertia_kgm2 = 1e-6;
    axle->beam.pitch_inertia_kgm2 = 1e-6;
    axle->wheel_spin_inertia_kgm2 = 1e-6;
  }
  BareVehicle rig(slope(0.0), parameters);
  FullVehicleState state = rig.machine.state();
  state.p_WC.z() += 100.0;
  state.w_WB_B = {0.0, 0.0, 20.0};
  rig.machine.set_state(state);
  rig.machine.step(1s);
  const LinkMotion& body = rig.machine.links()[0];
  // B's origin turns about the centre of mass, 2.05 m ahead of it.
  const Eigen::Vector3d a_B = body.X_WL.linear().transpose() * body.a_WL_W;
  EXPECT_NEAR(a_B.x(), 400.0 * 2.05, 1e-3);
  EXPECT_NEAR(a_B.y(), 0.0, 1e-3);
  EXPECT_NEAR(body.w_WL_W.z(), 20.0, 1e-9);
}

}  // namespace
}  // namespace rigwire::sim::test
