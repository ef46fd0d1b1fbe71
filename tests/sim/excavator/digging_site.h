// What the digging tests share: sandy ground and an excavator about to dig in it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "sim/excavator/bucket_soil.h"
#include "sim/excavator/digging_excavator.h"

namespace rigwire::sim::test {

inline constexpr double kGravity = 9.80665;

inline SoilParameters sand() {
  SoilParameters soil;
  soil.name = "sand";
  soil.soft = true;
  soil.density_kgpm3 = 1700.0;
  soil.cohesion_pa = 2000.0;
  soil.repose_rad = 35.0 * std::numbers::pi / 180.0;
  return soil;
}

inline HeightField level_field(double cell_m) {
  HeightField field;
  field.cell_m = cell_m;
  field.columns = static_cast<std::size_t>(std::lround(40.0 / cell_m)) + 1;
  field.rows = field.columns;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  return field;
}

inline Ground sandy(double cell_m = 0.4) {
  return Ground(level_field(cell_m), SoilMap{{sand()}, {}}, {});
}

/// Stands at the origin, looks east, teeth 0.2 m over the ground.
inline ExcavatorParameters ready_to_dig() {
  ExcavatorParameters parameters;
  parameters.initial.boom_rad = 0.25;
  parameters.initial.stick_rad = -1.1;
  parameters.initial.bucket_rad = -0.35;
  return parameters;
}

struct Site {
  explicit Site(const Ground& made = sandy(), const DiggingParameters& digging = {},
                const ExcavatorParameters& excavator = ready_to_dig())
      : ground(made), machine(excavator, digging, Eigen::Isometry3d::Identity(), ground) {}

  void run(double seconds, double swing, double boom, double stick, double bucket) {
    ValveCommand command;
    command.opening = {swing, boom, stick, bucket};
    machine.valve_port()->command(command);
    const int steps = static_cast<int>(std::lround(seconds * 100.0));
    for (int i = 0; i < steps; ++i) {
      machine.step(std::chrono::milliseconds(10));
      worst_imbalance = std::max(worst_imbalance, std::abs(machine.balance_units()));
    }
  }
  /// Down into the soil, through it, out with a full bucket.
  void dig() {
    run(0.75, 0.0, -0.35, 0.0, 0.0);
    run(4.0, 0.0, 0.1, 0.6, 0.1);
    run(2.0, 0.0, 0.2, 0.0, 0.9);
    run(2.0, 0.0, 0.5, 0.0, 0.0);
  }
  void settle() {
    while (!machine.terrain().settled()) {
      machine.terrain().settle();
    }
  }

  Ground ground;
  DiggingExcavator machine;
  std::int64_t worst_imbalance = 0;
};

/// A bucket at a point, x to the teeth at that pitch in the plane y = 0.
inline LinkMotion bucket_at(double x, double z, double pitch,
                            const Eigen::Vector3d& v_W = Eigen::Vector3d::Zero()) {
  LinkMotion motion;
  motion.X_WL.linear() = Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitY()).toRotationMatrix();
  motion.X_WL.translation() << x, 0.0, z;
  motion.v_WL_W = v_W;
  return motion;
}

}  // namespace rigwire::sim::test
