// The light of sun and sky on a scene, in photometric units.
//
// Three bands, red, green and blue, of linear sRGB (IEC 61966-2-1 primaries): a luminance or an
// illuminance has the same unit in each, and white light has the same number in all three.
//
//   total   on level ground under a clear sky, by the sun's elevation: P. M. Janiczek, J. A.
//           DeYoung, "Computer programs for sun and moon illuminance", US Naval Observatory
//           Circular 171, 1987, down to 18 degrees below the horizon, where starlight stays
//   sun     133.3 klx outside the air, weakened by air molecules and haze in each band (A. J.
//           Preetham, P. Shirley, B. Smits, "A practical analytic model for daylight", SIGGRAPH
//           1999, appendix, without ozone and vapour) over the air mass of F. Kasten and A. T.
//           Young, 1989
//   sky     what is left of the total, at least 15 % of the sun's part, spread as Preetham et al.
//           spread it by their five Perez numbers and chromaticities; these no more purple than the
//           CIE's daylight locus, which real skies keep to (J. Hernandez-Andres, J. Romero, J. L.
//           Nieves, R. L. Lee, "Color and spectral analysis of daylight in southern Europe", JOSA A
//           18(6), 2001), while the fit leaves it near the horizon; below 2 degrees of elevation
//           the sun is taken as being at 2 degrees
//   clouds  total times 1 - 0.75 c^3.4 (F. Kasten, G. Czeplak, 1980), sun times 1 - c, sky blended
//           into the standard overcast one, (1 + 2 sin e) / 3 (P. Moon, D. E. Spencer, 1942)
// Ground below the horizon sends back its albedo of the total, evenly.
//
// Irradiance on an inclined surface is taken from nine spherical harmonics (R. Ramamoorthi, P.
// Hanrahan, "An efficient representation for irradiance environment maps", SIGGRAPH 2001): within 5
// % of the total of the integral over the same sky (tested). Real clear skies differ from the
// total by some 20 % with humidity and height; Preetham's sky is uneven within a few degrees of the
// sun. There are no single clouds, no moon.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/lidar/lane_array.h"

namespace rigwire::sim {

struct DaylightParameters {
  double turbidity = 3.0;      ///< 2 very clear, 3 clear, 6 hazy, 10 thick haze.
  double cloud_cover = 0.0;    ///< 0 clear .. 1 overcast.
  double ground_albedo = 0.2;  ///< Albedo of the ground around the scene.

  friend bool operator==(const DaylightParameters&, const DaylightParameters&) = default;
};
void visit(fields::Visitor& v, DaylightParameters& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const DaylightParameters& parameters);

/// Illuminance of level ground under a clear sky, lx (Circular 171).
[[nodiscard]] double clear_sky_illuminance_lx(double sun_elevation_rad);

class Daylight {
 public:
  /// `to_sun_W`: unit vector, east-north-up. Throws std::invalid_argument as validate() does, or
  /// when it is not a unit vector. Costs about 1 ms.
  Daylight(const DaylightParameters& parameters, const Eigen::Vector3d& to_sun_W);

  [[nodiscard]] const DaylightParameters& parameters() const { return parameters_; }
  [[nodiscard]] const Eigen::Vector3f& to_sun_W() const { return to_sun_; }
  /// False when the sun is below the horizon or fully hidden by clouds.
  [[nodiscard]] bool sun_shines() const { return sun_lx_.y() > 0.0F; }
  /// Illuminance of a surface that faces the sun, by the sun alone, lx.
  [[nodiscard]] const Eigen::Vector3f& sun_lx() const { return sun_lx_; }
  /// Illuminance of level ground by sun and sky, lx.
  [[nodiscard]] const Eigen::Vector3f& total_lx() const { return total_lx_; }
  /// Illuminance of level ground by the sky alone, lx.
  [[nodiscard]] const Eigen::Vector3f& sky_lx() const { return sky_lx_; }

  /// Luminance in a direction (unit), cd/m2: the sky above the horizon, from a table (within 1 %
  /// of the formulas from 3 degrees above the horizon on); below it ground that pales with
  /// distance. The sun's disc is not in it.
  [[nodiscard]] Eigen::Vector3f luminance(const Eigen::Vector3f& direction_W) const;
  /// Writes the luminance in eight directions, by band.
  using EightNumbers = std::span<const float, kLanes>;
  void luminance(EightNumbers x, EightNumbers y, EightNumbers z,
                 std::array<LaneArray, 3>& bands) const;
  /// Mean luminance of the sky's lowest 5 degrees all round: what air far away looks like.
  [[nodiscard]] const Eigen::Vector3f& horizon() const { return horizon_; }
  /// Returns the luminance of the sun's disc, 0.267 degrees in radius, seen through the air, cd/m2.
  [[nodiscard]] Eigen::Vector3f sun_luminance() const;
  static constexpr float kSunRadius_rad = 0.00465F;

  /// Sky and ground on a surface with that normal (unit), nothing in the way, lx.
  [[nodiscard]] Eigen::Vector3f diffuse_lx(const Eigen::Vector3f& normal_W) const;
  /// Nine coefficients of diffuse_lx() by band, to evaluate many normals at a time: of 1, y, z, x,
  /// xy, yz, 3 z^2 - 1, xz, x^2 - y^2.
  [[nodiscard]] const std::array<Eigen::Vector3f, 9>& diffuse_terms() const { return terms_; }

 private:
  static constexpr int kTable = 96;  ///< Nodes along each side of the sky's table.

  [[nodiscard]] Eigen::Vector3f clear_luminance(const Eigen::Vector3f& direction_W) const;
  [[nodiscard]] Eigen::Vector3f sky_luminance(const Eigen::Vector3f& direction_W) const;
  void tabulate();
  void project();

  DaylightParameters parameters_;
  Eigen::Vector3f to_sun_;
  /// Direction of the sun in the Perez functions.
  Eigen::Vector3f shape_sun_;
  std::array<std::array<float, 5>, 3> perez_{};       ///< Perez coefficients of Y, x and y.
  Eigen::Vector3f zenith_ = Eigen::Vector3f::Zero();  ///< Y, x, y over the shape at the zenith.
  float clear_scale_ = 0.0F;
  float overcast_zenith_ = 0.0F;
  Eigen::Vector3f sun_lx_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f sky_lx_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f total_lx_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f horizon_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f ground_ = Eigen::Vector3f::Zero();
  std::array<Eigen::Vector3f, 9> terms_{};
  /// The sky over the plane of (x, y) / (1 + z), which the upper half of the sphere fills up to 1.
  /// Four numbers each, the last one empty.
  std::vector<std::array<float, 4>> table_;
};

}  // namespace rigwire::sim
