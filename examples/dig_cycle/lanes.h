// Where to dig next. The pit is worked in lanes, pulls towards the machine side by side, the
// highest first, so that it goes down evenly. A lane is done when it is as deep as asked, when its
// buckets come up nearly empty, or when something in it holds the bucket.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace rigwire::dig_cycle {

struct LaneSettings {
  double middle_rad = 0.0;   ///< Swing angle of the first lane.
  double sector_rad = 0.0;   ///< To either side of it.
  double spacing_rad = 0.0;  ///< Between neighbours.
  double depth_m = 0.0;      ///< Depth of one cut.
  double deepest_m = 0.0;    ///< Total depth of all cuts, below the ground under the machine.
};

class Lanes {
 public:
  /// The last bucket of so many that came up poor ends a lane.
  static constexpr int kMostPoor = 2;

  explicit Lanes(const LaneSettings& settings);

  /// Swing angle of the present lane.
  [[nodiscard]] double azimuth_rad() const { return lanes_[present_].azimuth_rad; }
  /// Height of the present lane's ground: what is seen, or what was left when it was cut last,
  /// whichever is lower, and never so low that a cut would pass the deepest.
  [[nodiscard]] double ground_m(double seen_m) const;

  /// The present lane was cut from `ground_m`. `poor`: the bucket brought up nearly nothing.
  void cut(double ground_m, bool poor);
  /// Something in the present lane holds the bucket or keeps it out.
  void block();
  /// Goes to the highest lane that is not done, of equal ones the nearest to the middle. False when
  /// all are done.
  [[nodiscard]] bool next();

  [[nodiscard]] std::size_t count() const { return lanes_.size(); }
  [[nodiscard]] std::size_t blocked() const;

 private:
  struct Lane {
    double azimuth_rad = 0.0;
    std::optional<double> left_m;  ///< Height of its bottom after the last cut.
    int poor = 0;
    bool blocked = false;
  };
  [[nodiscard]] bool done(const Lane& lane) const;

  LaneSettings settings_;
  std::vector<Lane> lanes_;  ///< From the middle outwards.
  std::size_t present_ = 0;
};

}  // namespace rigwire::dig_cycle
