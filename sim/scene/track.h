// Tracks through a terrain: a smooth line through given points, carved into the ground as a way
// that can be driven.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "fields/rules.h"
#include "sim/scene/height_field.h"

namespace rigwire::sim {

struct TrackPoint {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  ///< [east, north].
};
void visit(fields::Visitor& v, TrackPoint& p);

struct Track {
  std::string name = "track";
  std::vector<TrackPoint> points;  ///< The centre line passes through each; at least two.
  bool closed = false;             ///< The last point joins the first; then at least three.
  double width_m = 4.0;            ///< Level across.
  double shoulder_m = 3.0;         ///< On each side, over which it blends into the ground.
  /// Standard deviation of the Gaussian over which the ground's height is averaged along the line:
  /// waves much shorter than this are cut and filled.
  double grading_m = 8.0;
  double roughness_m = 0.02;  ///< Standard deviation of the noise on it, waves of 3 m and shorter.
  std::string soil;           ///< Name of a soil of the scene; empty = as around it.
};
void visit(fields::Visitor& v, Track& p);

/// Throws std::invalid_argument naming the key, the value and what is allowed.
void validate(const Track& track);

/// A track's centre line as points kTrackSpacing_m apart (the last piece may be shorter), without
/// the first point repeated at the end of a closed line.
struct TrackLine {
  std::vector<Eigen::Vector2d> points_m;
  bool closed = false;
  double length_m = 0.0;

  /// Distance of the nearest point of the line, and how far along the line that is.
  struct Nearest {
    double distance_m = 0.0;
    double along_m = 0.0;
  };
  [[nodiscard]] Nearest nearest(const Eigen::Vector2d& p_m) const;
};
inline constexpr double kTrackSpacing_m = 0.5;

/// Centripetal Catmull-Rom spline (E. Catmull, R. Rom, 1974; C. Yuksel, S. Schaefer, J. Keyser,
/// "Parameterization and applications of Catmull-Rom curves", CAD 43(7), 2011: no cusps and no
/// loops between points), then resampled by arc length. Validates.
[[nodiscard]] TrackLine track_line(const Track& track);

/// Cuts and fills the ground to the track. The same seed gives the same roughness. Validates.
void carve(HeightField& field, const Track& track, std::uint64_t seed);

}  // namespace rigwire::sim
