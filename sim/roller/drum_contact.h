// One rigid drum on the ground: strips side by side along its width, each with a bristle along and
// one across its direction of rolling.
//
// A drum in one piece turns at one rate, so that on a curve its outer strips are dragged and its
// inner ones pushed: scrub, the moment that holds a turning pivot (mu N b / 4 when all strips
// slide) and the curve's resistance all come out of the strips. Each strip's force is limited to
// the circle of friction times load, tested after the velocity solve (roller_dynamics.h).
//
// Coordinates: velocities are (u, v, r, w): the body's centre of mass forward and left, its yaw
// rate, the drum's rate. With the drum steered by d, x forward of the centre of mass, strip i at
// y_i along its axle:
//
//     along   s = u cos d + (v + r x) sin d - (r + d') y_i - R w
//     across  t = -u sin d + (v + r x) cos d
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "sim/contact/bristle.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

/// Position and loads of the drum in this step.
struct DrumSituation {
  double x_m = 0.0;  ///< Pivot forward of the centre of mass.
  double steer_rad = 0.0;
  double steer_rate_radps = 0.0;
  double spin_radps = 0.0;                       ///< At the start of the step.
  std::array<double, kDrumStripsMax> load_n{};   ///< >= 0.
  std::array<double, kDrumStripsMax> limit_n{};  ///< Limit of the tangential force.
};

/// Sums of one drum over its strips: generalised force offset - gain (u, v, r, w).
struct DrumForces {
  Eigen::Matrix4d gain = Eigen::Matrix4d::Zero();
  Eigen::Vector4d offset = Eigen::Vector4d::Zero();
};

class DrumContact {
 public:
  /// `carried_mass_kg`: what the bristles' damping is tuned for.
  DrumContact(const DrumParameters& parameters, double carried_mass_kg);

  [[nodiscard]] int strips() const { return parameters_.strips; }
  /// Along the axle from the pivot, left positive.
  [[nodiscard]] double strip_y_m(int strip) const { return y_m_[static_cast<std::size_t>(strip)]; }

  /// Begins a step; which strips slide is guessed from the velocities before it.
  void begin(double h, const DrumSituation& situation, const Eigen::Vector4d& before);
  /// Returns the terms for the solve in the strips' present states.
  [[nodiscard]] DrumForces forces() const;
  /// Compares the strips' forces at the velocities found with their limits. Returns true when a
  /// strip changed between holding and sliding, so that the step is to be solved again.
  [[nodiscard]] bool test(const Eigen::Vector4d& velocity);
  /// Ends the step.
  void settle(const Eigen::Vector4d& velocity);
  /// Bends the bristles so that they carry these forces at rest, spread over the strips in
  /// proportion to their limits.
  void preload(double along_n, double across_n, const std::array<double, kDrumStripsMax>& limit_n);
  /// Straightens all bristles and clears all forces: the drum is in the air.
  void leave_ground();

  /// Force on the drum in the last step, along and across its own direction.
  [[nodiscard]] double along_n() const { return along_n_; }
  [[nodiscard]] double across_n() const { return across_n_; }
  /// Moment of the ground about the pivot in the last step, left positive; it opposes a turning
  /// pivot.
  [[nodiscard]] double pivot_moment_nm() const { return pivot_moment_nm_; }
  /// Force of the ground in the generalised coordinates, last step.
  [[nodiscard]] const Eigen::Vector4d& generalised() const { return generalised_; }
  /// Power that the strips turned into heat.
  [[nodiscard]] double loss_w() const { return loss_w_; }
  [[nodiscard]] int sliding_strips() const;

 private:
  struct Strip {
    Bristle along;
    Bristle across;
    double force_along_n = 0.0;  ///< While sliding.
    double force_across_n = 0.0;
    bool sliding = false;
    ImplicitForce law_along;
    ImplicitForce law_across;
    double trial_along_n = 0.0;
    double trial_across_n = 0.0;
  };

  [[nodiscard]] double slide_along(const Eigen::Vector4d& velocity, std::size_t strip) const;
  [[nodiscard]] double slide_across(const Eigen::Vector4d& velocity) const;
  void limit(Strip& strip, double limit_n);

  DrumParameters parameters_;
  std::size_t count_;
  BristleParameters along_parameters_;
  BristleParameters across_parameters_;
  std::array<double, kDrumStripsMax> y_m_{};
  std::array<Strip, kDrumStripsMax> strips_;
  // Values of the current step.
  double h_ = 0.0;
  double rolling_mps_ = 0.0;
  DrumSituation situation_;
  Eigen::Vector4d along_row_ = Eigen::Vector4d::Zero();  ///< Row of a strip at y = 0.
  Eigen::Vector4d across_row_ = Eigen::Vector4d::Zero();
  // Results of the last step.
  double along_n_ = 0.0;
  double across_n_ = 0.0;
  double pivot_moment_nm_ = 0.0;
  Eigen::Vector4d generalised_ = Eigen::Vector4d::Zero();
  double loss_w_ = 0.0;
};

}  // namespace rigwire::sim
