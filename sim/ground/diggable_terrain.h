// Diggable terrain: a cutting edge takes soil away, pouring puts it back, and it slides to its
// angle of repose. No soil is lost.
//
// Each node of the ground's height field carries a column of soil, one cell wide; the volume under
// the triangles between the nodes is the sum of the columns. A column is firm soil (in its original
// place) with loose soil on top. Heights and volumes are whole numbers of a unit, 2^-36 m of height
// on one column; every transfer adds to one account exactly what it takes from another, so the
// balance is exact after any amount of digging. Undug nodes keep their heights bit for bit.
//
// Slides: loose soil steeper than its angle of repose towards any of eight neighbours moves down;
// nodes are visited in the order in which they were disturbed, a bounded number for each call.
// Where digging came near, firm soil is stable up to bank_rad, and breaks to loose soil beyond.
//
// The outermost ring of nodes is never changed. Soil of a hard kind (SoilParameters::soft false) is
// not dug; loose soil on it is. Digging does not swell or compact soil.
//
// Deterministic; only the constructor allocates.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fields/rules.h"
#include "sim/ground/ground.h"
#include "sim/scene/node_rectangle.h"

namespace rigwire::sim {

struct DiggableTerrainParameters {
  double depth_max_m = 5.0;        ///< Below the ground as it was: rock from there on.
  double loose_initial_m = 0.0;    ///< Loose soil on top at the start, of what can be dug.
  double bank_rad = 1.2;           ///< Steepest bank of firm soil; an estimate for stiff soil.
  std::size_t slide_visits = 128;  ///< Nodes visited by one settle().

  friend bool operator==(const DiggableTerrainParameters&,
                         const DiggableTerrainParameters&) = default;
};

void visit(fields::Visitor& v, DiggableTerrainParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const DiggableTerrainParameters& parameters);

/// A straight cutting edge.
struct CuttingEdge {
  Eigen::Vector3d left_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_W = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d middle_W() const { return 0.5 * (left_W + right_W); }
};

/// Soil taken out by a cut.
struct CutSoil {
  std::int64_t units = 0;
  double mass_kg = 0.0;  ///< Volume times density of the soils that it came from.
};

class DiggableTerrain {
 public:
  /// Changes `ground`, which must outlive it. Throws std::invalid_argument as validate does and
  /// when the ground has fewer than 4 nodes along a side.
  DiggableTerrain(Ground& ground, const DiggableTerrainParameters& parameters);

  [[nodiscard]] const Ground& ground() const { return ground_; }
  [[nodiscard]] double cell_m() const { return ground_.field().cell_m; }

  /// Cubic metres in one unit.
  [[nodiscard]] double unit_m3() const { return unit_m3_; }
  /// Whole units in a volume, rounded down; 0 for a volume that is negative or no number.
  [[nodiscard]] std::int64_t units(double volume_m3) const;

  /// The edge moves straight from one pose to the other and takes all soil above its way, as far as
  /// it moves in the horizontal direction `forward_W`; none when it moves back or along itself.
  /// Columns only partly swept give their share; after the edge has crossed a column wholly, the
  /// column ends at the edge's height.
  CutSoil cut(const CuttingEdge& from, const CuttingEdge& to, const Eigen::Vector3d& forward_W);

  /// Deposits soil about (x, y) as a cone of that radius, at least on the nearest column; beyond
  /// the terrain's edge on the nearest column inside.
  void pour(double x_m, double y_m, double radius_m, std::int64_t units);

  /// Runs a limited number of slides.
  void settle();
  [[nodiscard]] bool settled() const { return queue_length_ == 0; }

  /// Returns the height of the surface.
  [[nodiscard]] double height_m(double x_m, double y_m) const { return ground_.height_m(x_m, y_m); }
  /// Returns the height of what cannot be dug: rock under the soil, or hard ground.
  [[nodiscard]] double floor_height_m(double x_m, double y_m) const {
    return floor_.height_m(x_m, y_m);
  }
  /// Returns the soil at the nearest node.
  [[nodiscard]] const SoilParameters& soil_at(double x_m, double y_m) const;
  /// Returns the maximum density among all soils of the terrain.
  [[nodiscard]] double density_greatest_kgpm3() const { return density_greatest_kgpm3_; }

  /// Returns the soil gained since the start, in units: all that was poured minus all that was
  /// taken. Sums all columns.
  [[nodiscard]] std::int64_t gained_units() const;

  /// The nodes changed since the last call.
  std::optional<NodeRectangle> take_changes();

 private:
  struct SlopeLimits {
    std::int64_t straight = 0;  ///< Maximum rise to a neighbour along an axis, in units.
    std::int64_t diagonal = 0;
  };

  [[nodiscard]] std::size_t node(std::size_t column, std::size_t row) const {
    return row * columns_ + column;
  }
  [[nodiscard]] std::size_t nearest_inner(double coordinate, double origin,
                                          std::size_t nodes) const;
  [[nodiscard]] SlopeLimits limits_for(double slope_rad) const;
  void cut_straight(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                    const Eigen::Vector2d& left, double half_width_m, double rise, CutSoil& soil);
  void change(std::size_t at, std::int64_t surface_units);
  void disturb(std::size_t at);
  void push(std::size_t at);
  void slide_from(std::size_t at);
  [[nodiscard]] bool inner(std::size_t column, std::size_t row) const {
    return column > 0 && row > 0 && column + 1 < columns_ && row + 1 < rows_;
  }

  Ground& ground_;
  DiggableTerrainParameters parameters_;
  std::size_t columns_;
  std::size_t rows_;
  double unit_m3_;
  std::vector<std::int64_t> surface_;  ///< Height of each column, in units.
  std::vector<std::int64_t> initial_;
  std::vector<std::int64_t> loose_;
  std::vector<std::int64_t> rock_;   ///< Lower limit of digging, in units.
  HeightField floor_;                ///< rock_ in metres.
  std::vector<std::uint8_t> soil_;   ///< Index of each column's soil.
  std::vector<SlopeLimits> repose_;  ///< By soil.
  SlopeLimits bank_;
  double density_greatest_kgpm3_ = 0.0;

  // Columns waiting for a visit: a ring that holds each at most once.
  std::vector<std::uint32_t> queue_;
  std::vector<std::uint8_t> queued_;
  std::size_t queue_head_ = 0;
  std::size_t queue_length_ = 0;

  std::optional<NodeRectangle> changes_;
};

}  // namespace rigwire::sim
