// Lanes side by side, rolled to and fro in crab offset: what is wanted where.
//
// Frame of the lanes: x along the first lane's direction from the machine's initial position, y
// left. Forward on the first lane, back on the second, and so on. On each leg the first
// `transition_m` lead over from the last lane to its own and from one crab side to the other, as
// smooth as a machine can follow that steers at a standstill only little.
#pragma once

namespace rigwire::roll_lane {

struct LaneSettings {
  int lanes = 4;
  double length_m = 60.0;  ///< Length of each lane, transition included.
  double transition_m = 18.0;
  double drum_width_m = 1.68;
  double drum_distance_m = 3.4;  ///< Distance of the two drums' axles.
  double crab_offset_m = 0.6;    ///< Lateral offset of one drum against the other.
  double overlap_m = 0.15;       ///< Overlap of neighbouring lanes.
  bool to_the_left = true;       ///< Side of the next lane.

  /// Throws std::invalid_argument naming the member.
  void validate() const;
  /// Returns the width that both drums roll together.
  [[nodiscard]] double rolled_width_m() const { return drum_width_m + crab_offset_m; }
  /// Returns the distance from lane to lane.
  [[nodiscard]] double pitch_m() const { return rolled_width_m() - overlap_m; }
  /// Returns the angle of both drums that makes the offset.
  [[nodiscard]] double crab_angle_rad() const;
};

/// Set point at a place along a leg.
struct LanePoint {
  double y_m = 0.0;
  double slope = 0.0;             ///< dy/dx.
  double curvature_1pm = 0.0;     ///< d2y/dx2.
  double crab_rad = 0.0;          ///< Crab angle of both drums, left positive.
  double crab_slope_radpm = 0.0;  ///< d crab/dx.
};

class LanePlan {
 public:
  /// Throws std::invalid_argument.
  explicit LanePlan(const LaneSettings& settings);

  [[nodiscard]] int lanes() const { return settings_.lanes; }
  /// Returns the direction of a leg: +1 forward, -1 backward.
  [[nodiscard]] static int direction(int leg) { return leg % 2 == 0 ? 1 : -1; }
  /// Returns x at the end of a leg.
  [[nodiscard]] double end_x_m(int leg) const;
  /// Returns the way left on a leg.
  [[nodiscard]] double left_m(int leg, double x_m) const;
  [[nodiscard]] LanePoint at(int leg, double x_m) const;
  /// Middle of a lane.
  [[nodiscard]] double lane_y_m(int leg) const;
  [[nodiscard]] const LaneSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] double crab_rad(int leg) const;

  LaneSettings settings_;
};

}  // namespace rigwire::roll_lane
