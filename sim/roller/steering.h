// One steered pivot: first-order lag behind its set point with a limited rate,
//
//     rate = clamp((set point - angle) / time constant, +-rate limit)
//
// solved exactly over any step: at the rate limit while far away, exponentially when near. The
// angle at a given time does not depend on how the time before was divided.
#pragma once

#include <numbers>

#include "fields/rules.h"

namespace rigwire::sim {

struct PivotSteeringParameters {
  double angle_max_rad = std::numbers::pi / 6.0;            ///< Stop on both sides (estimate).
  double rate_max_radps = 17.5 * std::numbers::pi / 180.0;  ///< Estimate.
  double time_constant_s = 0.15;                            ///< Estimate; 0 = none.

  friend bool operator==(const PivotSteeringParameters&, const PivotSteeringParameters&) = default;
};

void visit(fields::Visitor& v, PivotSteeringParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const PivotSteeringParameters& parameters);

class PivotSteering {
 public:
  explicit PivotSteering(const PivotSteeringParameters& parameters) : parameters_(parameters) {}

  /// Clamped to the stops. Not a number: the old set point stays.
  void command(double angle_rad);
  /// Precondition: h > 0.
  void step(double h);

  [[nodiscard]] double angle_rad() const { return angle_rad_; }
  [[nodiscard]] double set_point_rad() const { return set_point_rad_; }
  /// At the end of the last step.
  [[nodiscard]] double rate_radps() const { return rate_radps_; }
  [[nodiscard]] double acceleration_radps2() const { return acceleration_radps2_; }
  /// Way over the last step by its length.
  [[nodiscard]] double mean_rate_radps() const { return mean_rate_radps_; }

 private:
  PivotSteeringParameters parameters_;
  double set_point_rad_ = 0.0;
  double angle_rad_ = 0.0;
  double rate_radps_ = 0.0;
  double acceleration_radps2_ = 0.0;
  double mean_rate_radps_ = 0.0;
};

}  // namespace rigwire::sim
