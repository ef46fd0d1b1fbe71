// How the frame's plane lies on the ground under both drums: heave along its z, roll and pitch.
//
// A drum is round: it feels obstacles and edges of the terrain along its arc, as the lift that
// frees each strip's disc from them, so that a kerb raises the drum from where its edge first
// touches it and a drum rolls over the edge that it leaves. An edge beyond the climbing limit by
// both drums' friction (sim/contact/rolling_climb.h) stops the drum as a wall does.
//
// Rigid drums rest on the terrain in the least-squares sense: the plane through the lowest lines of
// the drums that best fits the heights under all bearing strips. A strip that is farther than 0.15
// m above the ground (from 0.05 m on less and less), or over a face steeper than 2 to 1, hangs free
// and bears nothing. A drum of which all strips hang free is in the air, and the machine tips
// (tipped_roller.h). The frame follows the plane like a damped oscillator (the mat and the rubber
// mounts are compliant), with the plane's own rate fed forward: on a plane, however steep, there is
// no deviation at all, and at rest there is exactly none. The rates are solved by the backward
// Euler rule; accelerations are their change over the step.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/contact/rolling_climb.h"
#include "sim/ground/ground.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

/// A strip's lowest point and the surface there.
struct StripGround {
  Eigen::Vector2d p_B_m = Eigen::Vector2d::Zero();  ///< Position in the frame's plane.
  GroundPoint point;
  double gap_m = 0.0;  ///< From the strip up to the surface, along the frame's z.
  /// Slope of the surface against the frame's plane.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double weight = 1.0;  ///< Weight in the fit: less where it comes off the ground, 0 in the air.

  [[nodiscard]] bool bears() const { return weight > 0.0; }
};
inline constexpr std::size_t kRollerStripsMax = 2 * kDrumStripsMax;

/// Heave and rates about the frame's x and y: displacement and its rate in the frame's axes.
struct RestMotion {
  double heave = 0.0;  ///< m or m/s, along z at the frame's origin.
  double roll = 0.0;   ///< rad or rad/s, about x.
  double pitch = 0.0;  ///< rad or rad/s, about y: nose down positive.
};

class GroundRest {
 public:
  GroundRest(const RollerParameters& parameters, const Ground& ground);

  /// Finds the ground under the strips; `steer_rad` front and rear. 2 x strips look-ups. With
  /// `put_down`, all strips bear, however far from the ground.
  void look(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
            const std::array<double, 2>& steer_rad, bool put_down = false);
  /// Sets what a drum rolls over from now on; its contact handles all other obstacles.
  void limit(std::size_t drum, const RollingClimb& climb) { climbs_[drum] = climb; }
  /// Mean friction under a drum, of the strips that bear.
  [[nodiscard]] double friction(std::size_t drum) const;
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Front drum's strips first, each from right to left.
  [[nodiscard]] const StripGround& strip(std::size_t index) const { return strips_[index]; }

  /// False: all strips of a drum are in the air.
  [[nodiscard]] bool stands() const { return stands_; }
  /// Returns whether no strip hangs free.
  [[nodiscard]] bool bears_all() const { return bears_all_; }
  /// Returns the range of a drum's strips that bear: the first, and one past the last.
  /// Precondition: stands().
  [[nodiscard]] std::array<std::size_t, 2> bearing(std::size_t drum) const;
  /// Returns the frame's distance from its pose on the ground.
  [[nodiscard]] const RestMotion& deviation() const { return deviation_; }
  /// Returns the rates at the end of a step of h, from those before; `planar` are u, v at the
  /// origin and r.
  [[nodiscard]] RestMotion rates(double h, const Eigen::Vector3d& planar,
                                 const RestMotion& before) const;

 private:
  void place_strips(const std::array<double, 2>& steer_rad);
  /// Determines the strips that bear, and the normal equations of their fit.
  void find_bearing(bool put_down);
  struct Disc;
  static void roll_over(const Disc& disc, const RollingClimb& climb, const Eigen::Matrix3d& R_WB,
                        double steer_rad, StripGround& strip);
  [[nodiscard]] static bool rises(double angle_rad, const Disc& disc, const RollingClimb& climb,
                                  const GroundPoint& point);
  /// Returns whether the terrain within a drum's reach has edges; checked again after 0.1 m of way.
  [[nodiscard]] bool rough(std::size_t drum, const Eigen::Vector3d& p_WB,
                           const Eigen::Matrix3d& R_WB);
  /// Raises the gap and slopes of one strip at p_W where there are obstacles beside the terrain
  /// below.
  void climb(std::size_t drum, const Eigen::Vector3d& p_W, const Eigen::Matrix3d& R_WB,
             StripGround& strip) const;
  /// Returns the fitted heave, roll and pitch; `right`: sums of heights times (1, y, -x).
  [[nodiscard]] RestMotion fit(const Eigen::Vector3d& right) const;

  const Ground* ground_;
  double radius_m_;
  double pivot_x_m_;
  double width_m_;
  double frequency_radps_;
  double damping_ratio_;
  RestMotion fall_;  ///< Accelerations at which it falls about its edges.
  std::size_t drum_strips_;
  std::size_t count_;
  std::vector<std::uint32_t> near_;  ///< Obstacles within a radius of the drums.
  std::array<double, 2> steer_rad_{};
  std::array<RollingClimb, 2> climbs_;
  struct Seen {
    std::array<Eigen::Vector3d, 2> ends_W{Eigen::Vector3d::Constant(1e300),
                                          Eigen::Vector3d::Constant(1e300)};
    bool rough = false;
  };
  std::array<Seen, 2> seen_;  ///< One for each drum.
  std::array<StripGround, kRollerStripsMax> strips_;
  RestMotion deviation_;
  bool stands_ = true;
  /// Sum of the positions of strips that hang free.
  Eigen::Vector2d hangs_m_ = Eigen::Vector2d::Zero();
  bool bears_all_ = true;
  bool even_ = false;  ///< The normal equations are those of equal weights.
  /// Inverse of the normal equations' matrix.
  Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Identity();
};

}  // namespace rigwire::sim
