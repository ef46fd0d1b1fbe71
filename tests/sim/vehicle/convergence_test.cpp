// How the full level's error falls with its step.
#include <gtest/gtest.h>

#include "bench/extrapolated_step.h"
#include "bench/machine_files.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

/// Half a second at 10 m/s under torque, heaving, rolling and drifting a little: all forces within
/// their limits and smooth.
Eigen::Vector3d manoeuvre(Duration step, WheeledVehicleParameters parameters) {
  parameters.step_s = to_seconds(step);
  BareVehicle rig(slope(2.0 * kDegree), parameters);
  rig.machine.command(released());
  rig.machine.start_rolling(10.0);
  FullVehicleState state = rig.machine.state();
  state.v_WC_W += Eigen::Vector3d(0.0, 0.3, 0.1);
  state.w_WB_B += Eigen::Vector3d(0.05, 0.02, 0.1);
  rig.machine.set_state(state);
  rig.equations.torque_nm = WheelVector::Constant(0.1 * parameters.mass_kg());
  rig.machine.step(500ms);
  EXPECT_FALSE(rig.machine.non_finite());
  for (const WheelState& wheel : rig.machine.wheels()) {
    EXPECT_FALSE(wheel.slipping);
  }
  return rig.position();
}

TEST(VehicleConvergence, TheStepIsOfFirstOrderAndItsExtrapolationOfSecond) {
  for (const WheeledVehicleParameters& parameters :
       {WheeledVehicleParameters(), bench::gator_855d().vehicle}) {
    const auto end = [&](int order, Duration step) {
      return bench::extrapolated(order,
                                 [&](int parts) { return manoeuvre(step / parts, parameters); });
    };
    const Eigen::Vector3d exact = end(2, 20us);
    for (const int order : {1, 2}) {
      const double coarse = (end(order, 1ms) - exact).norm();
      const double fine = (end(order, 500us) - exact).norm();
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.2);
    }
  }
}

TEST(VehicleConvergence, NearlyRigidSpringsHoldAtFiveMilliseconds) {
  WheeledVehicleParameters stiff = nearly_rigid({});
  stiff.step_s = 5e-3;
  BareVehicle rig(slope(0.0), stiff);
  rig.machine.command(released());
  rig.machine.start_rolling(5.0);
  rig.machine.step(3s);
  ASSERT_FALSE(rig.machine.non_finite());
  EXPECT_NEAR(rig.total_load(), stiff.mass_kg() * kGravity, 100.0);
}

}  // namespace
}  // namespace rigwire::sim::test
