// The ground that machines stand on: terrain heights, soil by cell, and solid obstacles.
//
// World frame W: x east, y north, z up, metres. The heights are those of the scene's terrain
// (sim/scene/height_field.h): what the wheels feel is what the rays see. All queries are const,
// allocate nothing and may run on many threads.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/contact/convex_shape.h"
#include "sim/ground/ruts.h"
#include "sim/ground/soil.h"
#include "sim/scene/height_field.h"

namespace rigwire::sim {

enum class ObstacleShape : std::uint8_t {
  box,       ///< Half lengths along its axes.
  sphere,    ///< half_lengths_m.x() is the radius.
  cylinder,  ///< Upright in its frame: x() the radius, z() half the height.
  hull,      ///< Obstacle::hull.
};

/// A solid thing that wheels roll over and bodies run into.
struct Obstacle {
  ObstacleShape shape = ObstacleShape::box;
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  Eigen::Vector3d half_lengths_m = Eigen::Vector3d::Constant(0.5);
  double friction = 0.7;
  std::shared_ptr<const ConvexShape> hull;  ///< Used by the shape `hull` only.
  /// Moment about its foot at which it breaks or is uprooted; infinite: never.
  double strength_nm = std::numeric_limits<double>::infinity();
  double tree_height_m = 0.0;  ///< Height of a trunk's tree, for its fall; 0: it does not fall.
  double stiffness_npm = 0.0;  ///< Stiffness where a machine hits it; 0: rigid.
  std::string name;            ///< Name in the truth: "trunk 12", "haul_truck".

  /// The lower end of its own z axis.
  [[nodiscard]] Eigen::Vector3d foot_W() const {
    return X_WO.translation() - half_lengths_m.z() * X_WO.linear().col(2);
  }
};

/// Soils of the terrain: a list, and an index into it per cell, one byte each, row by row; empty =
/// soil 0 everywhere.
struct SoilMap {
  std::vector<SoilParameters> soils{SoilParameters{}};
  std::vector<std::uint8_t> cells;
};

class LooseBodies;  // sim/contact/loose_bodies.h
struct LooseBody;

/// The surface under one point.
struct GroundPoint {
  double height_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< Unit, upward.
  std::uint8_t soil = 0;
  bool obstacle = false;  ///< The top of an obstacle: hard, whatever the soil.
  double friction = 0.8;
};

/// How deep a point is inside something solid.
struct Penetration {
  double depth_m = 0.0;  ///< Along the normal.
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
  double friction = 0.7;
};

/// Where a wheel's disc touches the surface.
struct WheelContact {
  double depth_m = 0.0;  ///< Overlap of the undeformed disc and the surface, along the normal.
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
  double terrain_share = 1.0;  ///< What the terrain carries of it, and not obstacles.
  GroundPoint ground;
};

/// Soft soils side by side under a contact, each with its share of it; what their shares miss of 1
/// is hard. The same load presses each as deep as its own curve says; the contact sinks by the sum
/// of share times sinkage.
struct SoftSoils {
  static constexpr std::size_t kMost = 4;

  SoftSoils() = default;
  /// One soil alone; null, or hard: none.
  SoftSoils(const SoilParameters* soft)  // NOLINT(google-explicit-constructor)
      : count(soft != nullptr && soft->soft ? 1 : 0) {
    soil[0] = soft;
    share[0] = 1.0;
  }
  void add(const SoilParameters& soft, double of_contact);
  [[nodiscard]] double whole_share() const;

  std::array<const SoilParameters*, kMost> soil{};
  std::array<double, kMost> share{};
  std::size_t count = 0;
  double pressed_m = 0.0;  ///< How deep they were pressed before.
};

/// The ground under a wheel, and where it rolls to.
struct WheelFooting {
  static constexpr double kNext_m = 0.02;

  WheelFooting() = default;
  /// Endless and virgin.
  WheelFooting(const SoilParameters& all)  // NOLINT(google-explicit-constructor)
      : under(&all), next(&all) {}

  SoftSoils under;
  SoftSoils next;                ///< kNext_m on, pressed as `under` is: what a border changes.
  double pressed_ahead_m = 0.0;  ///< Depth pressed ahead, where the wheel itself has not pressed,
  double reach_m = 0.0;          ///< at this distance; 0: not computed, nor is `next`.
};

class Ground {
 public:
  /// The empty ground: level, hard, at height 0 everywhere.
  Ground();
  /// Throws std::invalid_argument when a soil, the map's size or an obstacle is bad.
  Ground(HeightField field, SoilMap soils, std::vector<Obstacle> obstacles);

  /// An endless plane through the origin with this upward normal and soil, for tests and benches.
  static Ground plane(const Eigen::Vector3d& normal_W, const SoilParameters& soil);

  /// Returns the terrain, or the highest top of an obstacle that lies below `ceiling_m` (a wheel
  /// rests on a rock, not on the tree beside it). Beyond the terrain's edge, that of the nearest
  /// point on it.
  [[nodiscard]] GroundPoint at(double x_m, double y_m, double ceiling_m) const;

  /// The terrain alone.
  [[nodiscard]] double height_m(double x_m, double y_m) const;
  [[nodiscard]] GroundPoint terrain_at(double x_m, double y_m) const;

  /// Whether the point lies inside the terrain.
  [[nodiscard]] std::optional<Penetration> terrain_penetration(const Eigen::Vector3d& p_W) const;

  /// Whether the point lies inside the terrain or an obstacle; the deepest when in several.
  [[nodiscard]] std::optional<Penetration> penetration(const Eigen::Vector3d& p_W) const;

  [[nodiscard]] std::span<const Obstacle> obstacles() const { return obstacles_; }
  /// Places a fallen obstacle at X_WO permanently; it then bears loads. Like ruts, it is state of a
  /// ground that const machines change; only the thread that steps its machine may call it. Returns
  /// false, and changes nothing, beyond the first kMostLying.
  static constexpr std::size_t kMostLying = 64;
  [[nodiscard]] bool lay(std::size_t obstacle, const Eigen::Isometry3d& X_WO) const;
  [[nodiscard]] const ConvexShape& shape(std::size_t obstacle) const { return shapes_[obstacle]; }
  /// Whether it rises above the point: its highest point is above, and so is its top at the point's
  /// x and y if it has one there. A ramp does not for a wheel on its lower end.
  [[nodiscard]] bool rises_above(std::size_t obstacle, const Eigen::Vector3d& p_W) const;
  /// Whether a wheel with its centre there cannot roll over it (wheel_contact()): it rises above
  /// the centre and is no ball.
  [[nodiscard]] bool too_high(std::size_t obstacle, const Eigen::Vector3d& centre_W) const;
  /// Appends the indices of those that may touch the rectangle, some twice.
  void obstacles_near(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m,
                      std::vector<std::uint32_t>& found) const;

  /// Finds where a wheel touches the surface: the disc of that radius about `centre_W`, square to
  /// the unit `axis_W`, so that banks, steps and rocks are felt in front. Returns nullopt without
  /// contact.
  ///
  /// Terrain: its profile fore and aft through seven heights, and its side slope through two,
  /// intersected with the disc. The normal is square to the chord from the disc's entry to its
  /// exit; the depth is that of the plane which cuts off the same area, scaled so that a force
  /// proportional to it is conservative, as a tyre envelops an edge. Obstacles: nearest point in
  /// the disc's plane, exact. Together: the shortest displacement that frees the disc from all of
  /// them. Depth and normal are continuous in the wheel's position, whatever it drives over. On a
  /// plane of any slope and with any tilt of the wheel they are exact to rounding. Boxes, cylinders
  /// and hulls that rise above the disc's centre block the wheel, unless it is on a lower part of
  /// them; sim/contact handles these. The disc has no width. A wheel with a vertical axis (a
  /// machine on its side) has no contact.
  [[nodiscard]] std::optional<WheelContact> wheel_contact(const Eigen::Vector3d& centre_W,
                                                          const Eigen::Vector3d& axis_W,
                                                          double radius_m) const;

  /// Returns the soils under a wheel's contact, and with `reach_m` above 0 also those ahead in the
  /// horizontal direction of `way_W`: the adjacent soils, and the depth pressed at that distance,
  /// at least 0.3 m. Where cells of different soils adjoin, their shares change linearly over a
  /// border of 0.5 m, or of a cell if that is less, so that nothing jumps. Obstacles and hard soils
  /// are not counted.
  [[nodiscard]] WheelFooting footing(const WheelContact& contact, const Eigen::Vector3d& way_W,
                                     double reach_m) const;
  /// A wheel of that width leaves its rut, `depth_m` below the untouched surface of what is soft.
  /// Ruts are what const machines change of a ground: only the thread that steps its machine may
  /// call it.
  void press(const WheelContact& contact, const Eigen::Vector3d& forward_W, double width_m,
             double depth_m) const;
  [[nodiscard]] const Ruts& ruts() const { return ruts_; }

  /// Rocks and crates that lie loose on it; like ruts they are what const machines change of a
  /// ground, and only the thread that steps its machine may move them. Copies of the ground share
  /// them; the ground must stay where it is from now on.
  void set_loose(std::vector<LooseBody> bodies);
  /// Null: there are none.
  [[nodiscard]] LooseBodies* loose() const { return loose_.get(); }

  [[nodiscard]] const SoilParameters& soil(std::uint8_t index) const;
  [[nodiscard]] const std::vector<SoilParameters>& soils() const { return soils_.soils; }
  [[nodiscard]] const HeightField& field() const { return field_; }
  /// The terrain changes when it is dug: new height of one node. Ruts about it are gone.
  void set_node(std::size_t column, std::size_t row, double height_m);

 private:
  struct TerrainPoint {
    double height_m;
    double slope_x;
    double slope_y;
    std::size_t cell;
  };

  [[nodiscard]] TerrainPoint terrain(double x_m, double y_m) const;
  [[nodiscard]] std::uint8_t soil_of(const TerrainPoint& point) const;
  [[nodiscard]] SoftSoils soft_soils(const Eigen::Vector2d& p_W, double terrain_share) const;
  void fill_bins();
  void remember_ruts();
  /// Calls visit(obstacle) for those that may touch the rectangle; some may come twice.
  template <class Visit>
  void near_obstacles(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m,
                      Visit&& visit) const;
  [[nodiscard]] std::optional<Penetration> disc_on_terrain(const Eigen::Vector3d& centre_W,
                                                           const Eigen::Vector3d& up_W,
                                                           const Eigen::Vector3d& forward_W,
                                                           double radius_m) const;

  HeightField field_;
  SoilMap soils_;
  /// Bounds of an obstacle that lies outside its bins.
  struct Lying {
    std::size_t obstacle = 0;
    Eigen::Vector2d lower_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d upper_m = Eigen::Vector2d::Zero();
  };

  mutable std::vector<Obstacle> obstacles_;  ///< Changed by lay(), like the two members below.
  mutable std::vector<double> tops_m_;       ///< Their highest points.
  mutable std::array<Lying, kMostLying> lying_;
  mutable std::size_t lying_count_ = 0;
  std::vector<ConvexShape> shapes_;  ///< Shapes of the obstacles.
  // A grid over the obstacles, so that a look-up costs the same with one and with thousands.
  double bin_m_ = 4.0;
  Eigen::Vector2d bin_origin_m_ = Eigen::Vector2d::Zero();
  std::size_t bin_columns_ = 0;
  std::size_t bin_rows_ = 0;
  std::vector<std::uint32_t> bin_starts_;
  std::vector<std::uint32_t> bin_obstacles_;
  bool soft_ = false;  ///< Some soil is.
  mutable Ruts ruts_;  ///< press()
  std::shared_ptr<LooseBodies> loose_;
  bool plane_ = false;  ///< Made by plane().
  Eigen::Vector3d plane_normal_ = Eigen::Vector3d::UnitZ();
};

}  // namespace rigwire::sim
