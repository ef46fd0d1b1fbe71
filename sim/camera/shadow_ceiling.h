// Where the sun shines for certain: the height at each place of the ground above which nothing in
// the scene blocks the sun. Shadow rays from there need not be cast; pictures are the same with and
// without them (tested).
//
// The ceiling is a lattice over the scene's terrain whose rows run towards the sun. A shadow caster
// raises the ceiling at its own place, and behind it, away from the sun, by tan(elevation) less for
// each metre. Shadow casters are:
//   - objects, bodies (at both ends of the slice) and displaced pieces, by the boxes around them;
//   - of the terrain only cells that rise towards the sun more steeply than its rays: a ray that
//     starts above the ground comes upon it nowhere else.
// Cells are as wide as kMostAcross of them over the terrain require, and at least kLeastCell_m; a
// point may be given up to a cell and a half more shadow than it has. Outside the terrain, without
// terrain or with several, and with the sun below kLeastElevation_rad, nothing is certain and every
// ray is cast.
//
// Where it differs from the rays: in a crease of the ground sharper than a right angle, within the
// 2 mm and 1e-4 of the range that shadow rays start off the surface; there they start beneath it.
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "sim/lidar/lane_array.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

class ShadowCeiling {
 public:
  static constexpr int kMostAcross = 384;
  static constexpr double kLeastCell_m = 0.5;
  static constexpr float kLeastElevation_rad = 0.05F;

  /// For rays into the scene's present slice, towards the sun or anything within `sun_radius_rad`
  /// of it. What is fixed is kept from call to call for the same sun.
  void prepare(const Scene::Internals& scene, const Eigen::Vector3f& to_sun_W,
               double sun_radius_rad);

  /// Finds those of the `active` rays (-1) that something may block: sets `doubtful` to -1 there
  /// and to 0 elsewhere. The rays start in Embree's coordinates. Returns whether there is one.
  bool doubt(const RTCRay8& rays, const std::array<int, kLanes>& active,
             std::array<int, kLanes>& doubtful) const;

 private:
  /// What casts a shadow, along and across the sun's azimuth, m from the lattice's first corner.
  struct Caster {
    double begin_m = 0.0;
    double end_m = 0.0;
    double left_m = 0.0;
    double right_m = 0.0;
    double top_m = 0.0;
  };
  /// What a ceiling of what is fixed was made for.
  struct Kept {
    std::weak_ptr<const char> scene;
    std::size_t placed = 0;
    Eigen::Vector3f to_sun_W = Eigen::Vector3f::Zero();
    double sun_radius_rad = 0.0;
  };

  [[nodiscard]] bool keeps(const Scene::Internals& scene, const Eigen::Vector3f& to_sun_W,
                           double sun_radius_rad) const;
  void lay_out(const Scene::Internals::Terrain& terrain, const Eigen::Vector3f& to_sun_W,
               double sun_radius_rad);
  void raise(const Caster& caster);
  void raise_box(const Eigen::AlignedBox3f& bounds_M, double scale,
                 std::span<const Eigen::Isometry3d> poses_W);
  void raise_fixed(const Scene::Internals& scene);
  void raise_moving(const Scene::Internals& scene);
  void raise_terrain(const Scene::Internals::Terrain& terrain);
  void fall();

  bool certain_ = false;  ///< Somewhere.
  Kept kept_;
  std::vector<float> fixed_m_;

  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();    ///< Unit vector, level, towards the sun.
  Eigen::Vector2d corner_m_ = Eigen::Vector2d::Zero();  ///< Lattice corner: along, across.
  double cell_m_ = 1.0;
  int length_ = 0;                 ///< Cells along.
  int width_ = 0;                  ///< Cells across.
  std::array<float, 4> facing_{};  ///< Towards the sun: east, north, up; margin of the cosine.
  double fall_ = 0.0;              ///< Drop of a ceiling per metre away from the sun.
  /// Widening of a shadow on each side, per metre below its caster.
  double spread_ = 0.0;
  double lowest_m_ = 0.0;                    ///< Lowest level that the ground may be dug to.
  std::vector<int> first_open_, last_open_;  ///< Cells along over terrain, by place across.
  /// World height, cell by cell across, then along.
  std::vector<float> ceiling_m_;

  // From Embree's coordinates to cells.
  std::array<float, 3> to_along_{};
  std::array<float, 3> to_across_{};
  float to_world_m_ = 0.0F;                   ///< Added to z.
  std::vector<float> south_, north_, above_;  ///< Working memory, a row of terrain each.
};

}  // namespace rigwire::sim
