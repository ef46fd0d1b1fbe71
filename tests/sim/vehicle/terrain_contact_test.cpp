// The body of a vehicle against the terrain: overturned it lies on what it has, and stays.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;
using Vector = Eigen::Vector3d;

/// The lowest corner of the vehicle's boxes over level ground.
double lowest_m(const BareVehicle& rig) {
  double lowest = 1e300;
  for (const ContactBox& box : rig.machine.parameters().solid.boxes) {
    for (int i = 0; i < 8; ++i) {
      const Vector corner =
          box.position_m +
          0.5 * box.size_m.cwiseProduct(Vector((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                                               (i & 4) != 0 ? 1.0 : -1.0));
      lowest = std::min(lowest, (rig.machine.links()[0].X_WL * corner).z());
    }
  }
  return lowest;
}

class Overturned : public testing::TestWithParam<double> {};

// Only points of a list met the ground before: the cab passed into it.
TEST_P(Overturned, AUnimogLiesOnItsBodyAndComesToRestWithoutGainingEnergy) {
  BareVehicle rig(slope(0.0, 0.6));
  rig.machine.command(released());
  FullVehicleState state = rig.machine.state();
  state.q_WB = Eigen::AngleAxisd(GetParam() * kDegree, Vector::UnitX());
  state.p_WC.z() = 2.4;
  rig.machine.set_state(state);
  const auto energy = [&] {
    const VehicleMomentum m = rig.machine.momentum();
    return m.kinetic_j + m.potential_j + m.spring_j;
  };
  const double start = energy();
  double most_after = 0.0;
  bool touched = false;
  double deepest = 0.0;
  double pressed_in = 0.0;
  for (int i = 0; i < 12000; ++i) {
    rig.machine.step(1ms);
    const ContactReport& report = *rig.machine.contact_report();
    touched = touched || (report.points > 0 && report.terrain);
    deepest = std::max(deepest, report.deepest_m);
    pressed_in = std::max(pressed_in, report.sunk_m);
    most_after = std::max(most_after, energy());
  }
  EXPECT_TRUE(touched);
  EXPECT_LT(most_after, 1.005 * start);
  EXPECT_LT(energy(), start);
  EXPECT_LT(rig.machine.links()[0].v_WL_W.norm(), 0.02);
  EXPECT_LT(rig.machine.links()[0].w_WL_W.norm(), 0.02);
  // No deeper than what it has bent of itself and pressed in of the ground, and half a centimetre
  // of springs: it sank by 9 cm.
  const double lies_m = lowest_m(rig);
  EXPECT_GT(lies_m, -(rig.machine.contact_report()->dent_m + pressed_in + 0.005));
  EXPECT_LT(pressed_in, 0.1);
  rig.machine.step(10s);
  EXPECT_NEAR(lowest_m(rig), lies_m, 1e-3) << "neither sinks nor rises";
  EXPECT_LT(deepest, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Degrees, Overturned, testing::Values(90.0, 180.0, -120.0),
                         [](const auto& turn) {
                           return "turned_" + std::to_string(std::lround(turn.param + 360.0));
                         });

// The points of its list pressed the ground as if it were rock, where its boxes sank in.
TEST(TerrainContact, AChassisPointIsBorneByWhatSoilBears) {
  SoilParameters mud;
  mud.soft = true;
  mud.cohesion_pa = 5e3;
  mud.internal_friction_rad = 0.1;
  WheeledVehicleParameters points = WheeledVehicleParameters();
  points.solid.boxes.clear();
  // Depth of the deepest point, the vehicle put down on its roof.
  const auto deepest_m = [&](const SoilParameters& soil) {
    BareVehicle rig(Ground::plane({0.0, 0.0, 1.0}, soil), points);
    rig.machine.command(released());
    FullVehicleState state = rig.machine.state();
    state.q_WB = Eigen::AngleAxisd(std::numbers::pi, Vector::UnitX());
    state.p_WC.z() = 1.5;
    rig.machine.set_state(state);
    rig.machine.step(8s);
    EXPECT_LT(rig.machine.links()[0].v_WL_W.norm(), 0.05);
    double lowest = 0.0;
    for (const BodyPoint& point : rig.machine.body_points()) {
      lowest = std::min(lowest, point.p_W.z());
    }
    return -lowest;
  };
  const double on_hard_m = deepest_m({});
  EXPECT_LT(on_hard_m, 0.15);
  EXPECT_GT(deepest_m(mud), on_hard_m + 0.1);
}

TEST(TerrainContact, AUnimogOnItsWheelsFeelsNothingOfItsBody) {
  BareVehicle rig(slope(0.2));
  rig.machine.command(released());
  for (int i = 0; i < 2000; ++i) {
    rig.machine.step(1ms);
    ASSERT_EQ(rig.machine.contact_report()->points, 0U);
  }
}

}  // namespace
}  // namespace rigwire::sim::test
