// Height of the geoid above the WGS-84 ellipsoid, looked up in a grid of heights.
//
// The grid's rows run from south to north, its columns from west to east. Points between are
// interpolated: bilinear, as most programs that read such grids do, or bicubic (cubic convolution,
// R. Keys, "Cubic convolution interpolation for digital image processing", IEEE Trans. ASSP 29,
// 1981, with a = -1/2). On the grid's own points both are exact. A grid of full turns has no seam,
// at the date line or elsewhere; one that reaches a pole is continued across it along the opposite
// meridian. Outside a grid that does not span the earth its edge counts.
//
// Bound: between the points of EGM96's 15' grid bilinear interpolation departs from the model by up
// to 1 m in the steepest places, 0.1 m is usual; bicubic by a tenth of that.
#pragma once

#include <cstddef>
#include <vector>

namespace rigwire::sim {

struct GeoidGridLayout {
  double south_deg = -90.0;  ///< Latitude of the first row.
  double west_deg = -180.0;  ///< Longitude of the first column, [-180, 360].
  double latitude_step_deg = 0.25;
  double longitude_step_deg = 0.25;
  std::size_t rows = 721;
  std::size_t columns = 1440;
};

/// Throws std::invalid_argument naming the quantity, its value and what is allowed: 2 .. 65536 rows
/// and columns, steps of more than 0 and at most 90 deg, rows within -90 .. 90 deg, columns within
/// one turn.
void validate(const GeoidGridLayout& layout);

enum class GeoidInterpolation : unsigned char { bilinear, bicubic };

class GeoidGrid {
 public:
  /// `heights_m`: row after row. Throws as validate(), and when there are not rows times columns
  /// heights or one is beyond +-200 m, which no geoid is.
  GeoidGrid(const GeoidGridLayout& layout, std::vector<float> heights_m,
            GeoidInterpolation interpolation = GeoidInterpolation::bilinear);

  /// Any longitude is taken, in turns of 360 deg; latitude [-90, 90]. Not a number for one.
  [[nodiscard]] double separation_m(double latitude_deg, double longitude_deg) const;
  /// Whether the point lies within the grid, its edges included.
  [[nodiscard]] bool covers(double latitude_deg, double longitude_deg) const;

 private:
  /// The point in rows from the south and columns from the west, each within the grid.
  struct Place {
    double row = 0.0;
    double column = 0.0;
  };
  [[nodiscard]] Place place(double latitude_deg, double longitude_deg) const;
  /// Heights of the grid's points, and of points up to two rows or columns beyond.
  [[nodiscard]] double height_m(std::ptrdiff_t row, std::ptrdiff_t column) const;
  /// Along one row.
  [[nodiscard]] double linear(std::ptrdiff_t row, double column) const;
  [[nodiscard]] double cubic(std::ptrdiff_t row, double column) const;

  GeoidGridLayout layout_;
  std::vector<float> heights_m_;
  GeoidInterpolation interpolation_;
  bool full_turn_ = false;
  bool south_pole_ = false;
  bool north_pole_ = false;
};

}  // namespace rigwire::sim
