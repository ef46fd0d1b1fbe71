// The forces of one stage of a scheme that evaluates the equations of motion as they stand, and the
// slopes that an implicit scheme needs of them.
//
// A force F along u = J v depends on the speed u and on a deflection z, either a bristle's
// (z' = u - renewal z) or the displacement along J itself:
//
//     F = force - stiffness (z - z0) - damping (u - u0)
//
// around the state (z0, u0) of the stage.
#pragma once

#include <array>
#include <cstddef>

#include "sim/vehicle/velocity_system.h"

namespace rigwire::sim {

/// Deflections: per wheel along, across, turning, brake; per chassis point two across.
inline constexpr std::size_t kWheelBristles = 4;
inline constexpr std::size_t kChassisPoints = 16;
inline constexpr std::size_t kChassisBristle = 4 * kWheelBristles;
inline constexpr std::size_t kBristles = kChassisBristle + 2 * kChassisPoints;
using Deflections = std::array<double, kBristles>;

enum class DeflectionOf : std::uint8_t {
  bristle,
  place,    ///< The displacement along the row.
  limited,  ///< Nothing: the force is at its limit, and only its slope over the speed is left.
};

struct StageForce {
  VelocityRow row;
  double force = 0.0;
  double stiffness = 0.0;
  double damping = 0.0;
  double renewal = 0.0;
  DeflectionOf deflection = DeflectionOf::place;
  std::size_t bristle = 0;

  /// Of an implicit stage of h seconds, as ImplicitForce::gain.
  [[nodiscard]] double gain(double h) const { return damping + h * share(h); }
  /// Stiffness that is left of a bristle at the end of h seconds.
  [[nodiscard]] double share(double h) const { return stiffness / (1.0 + h * renewal); }
};

class StageForces {
 public:
  void clear() { count_ = 0; }
  void add(const StageForce& force) {
    if (count_ < forces_.size()) {
      forces_[count_++] = force;
    }
  }
  [[nodiscard]] const StageForce* begin() const { return forces_.data(); }
  [[nodiscard]] const StageForce* end() const { return forces_.data() + count_; }

 private:
  /// Wheels: normal, along, across, rolling, brake; axles: two coordinates, roll bar; chassis
  /// points: normal, two across.
  std::array<StageForce, 4 * 5 + 2 * 3 + 3 * kChassisPoints> forces_;
  std::size_t count_ = 0;
};

}  // namespace rigwire::sim
