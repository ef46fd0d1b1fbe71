// Vehicles, planes and a drive line without engine, for the tests of sim/vehicle.
#pragma once

#include <cmath>
#include <memory>
#include <ostream>
#include <vector>

#include "fields/constants.h"
#include "sim/driveline/driveline.h"
#include "sim/vehicle/full_vehicle.h"

namespace rigwire::sim {

/// For test names.
inline void PrintTo(VehicleLevel level, std::ostream* out) {
  *out << (level == VehicleLevel::kinematic ? "kinematic"
           : level == VehicleLevel::planar  ? "planar"
                                            : "full");
}

}  // namespace rigwire::sim

namespace rigwire::sim::test {

inline constexpr double kGravity = 9.80665;

/// Torque and locks as the test sets them; nothing else.
class BareDriveline final : public Driveline {
 public:
  explicit BareDriveline(SpinEquations* equations) : equations_(equations) {}
  void command(const VehicleCommand&) override {}
  void fail(const PowerUnitDefects&) override {}
  void begin(double, double, WheelVector&) override {}
  [[nodiscard]] const SpinEquations& equations() const override { return *equations_; }
  bool accept(double, const WheelVector&) override { return true; }
  void finish(double, const WheelVector&) override {}
  void read(VehicleSample&) const override {}
  [[nodiscard]] EngineData engine_data() const override { return {}; }
  [[nodiscard]] DriveState state() const override { return {}; }
  [[nodiscard]] int select_gear(double, double, int) const override { return 0; }

 private:
  SpinEquations* equations_;
};

/// Rises towards +x.
inline Ground slope(double angle_rad, double friction = 0.8) {
  SoilParameters soil;
  soil.friction = friction;
  return Ground::plane({-std::sin(angle_rad), 0.0, std::cos(angle_rad)}, soil);
}

/// Rises towards +y.
inline Ground side_slope(double angle_rad, double friction = 0.8) {
  SoilParameters soil;
  soil.friction = friction;
  return Ground::plane({0.0, -std::sin(angle_rad), std::cos(angle_rad)}, soil);
}

inline VehicleCommand released() {
  VehicleCommand command;
  command.parking_brake = false;
  return command;
}

inline VehicleCommand braked() {
  VehicleCommand command = released();
  command.brake_share = 1.0;
  return command;
}

/// The full level without engine; equations can be changed between steps.
struct BareVehicle {
  explicit BareVehicle(const Ground& ground_under,
                       const WheeledVehicleParameters& parameters = WheeledVehicleParameters(),
                       const VehiclePlace& place = {})
      : ground(ground_under),
        machine(parameters, ground, std::make_unique<BareDriveline>(&equations), place) {}

  [[nodiscard]] Eigen::Vector3d position() const { return machine.links()[0].X_WL.translation(); }
  [[nodiscard]] double speed() const {
    return machine.links()[0].X_WL.linear().col(0).dot(machine.links()[0].v_WL_W);
  }
  [[nodiscard]] double total_load() const {
    double sum = 0.0;
    for (const WheelState& wheel : machine.wheels()) {
      sum += wheel.load_n;
    }
    return sum;
  }

  SpinEquations equations;
  Ground ground;
  FullVehicle machine;
};

/// Parameters as rigid as the solver's conditioning allows: for closed forms of rigid bodies.
inline WheeledVehicleParameters nearly_rigid(WheeledVehicleParameters p) {
  for (VehicleAxleParameters* axle : {&p.front, &p.rear}) {
    axle->beam.spring_npm *= 200.0;
    axle->beam.damper_nspm *= 15.0;
    axle->tyre.carcass_stiffness_npm *= 100.0;
    axle->tyre.stiffness_per_pressure_m *= 100.0;
    axle->tyre.vertical_damping_nspm *= 50.0;
  }
  return p;
}

/// What an accelerometer in the link's origin feels, in the link's axes.
inline Eigen::Vector3d specific_force(const LinkMotion& link, double gravity = kGravity) {
  return link.X_WL.linear().transpose() * (link.a_WL_W + Eigen::Vector3d(0.0, 0.0, gravity));
}

}  // namespace rigwire::sim::test
