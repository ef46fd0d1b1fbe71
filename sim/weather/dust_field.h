// Gaussian puffs of dust as a laser beam sees them, prepared once for many beams.
//
// Extinction k = mass extinction x density (Beer and Lambert), back-scatter k / lidar ratio. The
// optical depth of a puff along a stretch of the beam is that of its middle times half a difference
// of two error functions, so that the transmission to a surface is exact. What a beam passes at a
// distance where the whole puff is thinner than 1e-4 is left out; the optical depth is too small by
// at most 1e-4 per puff. Beams away from the cloud cost one test against its sphere; within, one
// against each group of eight puffs.
//
// Echo, model `backscatter`: along the beam, in steps of a quarter of the pulse,
//   E(s) = pi / lidar ratio x integral of cos^2(pi u / 2 L) k exp(-2 tau) xi / s^2 du
// as in droplets.h; each stretch where it stays at or above the limit of detection is one echo, as
// strong as its strongest point, at the range where the limit is first reached: the leading edge,
// where a receiver's comparator trips. Real returns from dust gather there, too (T. G. Phillips, N.
// Guenther, P. R. McAree, "When the dust settles: the four behaviors of LiDAR in the presence of
// fine airborne particulates", J. Field Robotics 34(5), 2017). Error against fine steps below 2 %
// of the energy (5 % within 2 m of the sensor, where the overlap is coarser than the steps) and 5
// cm of the range for puffs from 0.25 m on. Scattering more than once is left out: dust so dense
// that a metre of it is dark answers no brighter than a surface of reflectance pi / (2 x lidar
// ratio).
//
// Echo, model `optical_depth`: after C. Goodin et al., as in their MAVS: with probability min(1,
// tau / 0.7) the beam returns from the dust and its target is lost, else the target is seen as if
// there were none. Here tau is that of the Gaussian puffs, and the return comes from where it
// reaches the drawn share of 0.7. For comparison: it has no detection limit and takes nothing from
// the target.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/weather/dust_cloud.h"
#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

/// One way through the middle of a puff, as if there were no ground.
[[nodiscard]] double middle_depth(const DustPuff& puff, const DustParameters& parameters);

class DustField {
 public:
  DustField() = default;  ///< No dust.

  /// Replaces what it held; does not allocate when it has held as many.
  void fill(std::span<const DustPuff> puffs, const WeatherParameters& parameters);

  [[nodiscard]] bool empty() const { return puffs_.empty(); }

  /// One way.
  [[nodiscard]] double optical_depth(const Eigen::Vector3d& start_W,
                                     const Eigen::Vector3d& direction_W, double length_m) const;
  /// At a point, per metre.
  [[nodiscard]] double extinction_pm(const Eigen::Vector3d& point_W) const;

  /// Multiplies the path's transmission and adds the dust's echoes. `air_pm` is the extinction of
  /// what is there beside the dust. A number is drawn from the beam's key at `counter`.
  void along(const WeatherBeam& beam, double air_pm, std::uint64_t counter, AirPath& path) const;

 private:
  struct Puff {
    Eigen::Vector3d centre_W;
    double cut_m2;  ///< Beyond that distance (squared) from the beam it is left out.
    double sigma_m;
    double exponent_pm2;  ///< 1 / 2 s^2.
    double peak_pm;       ///< Extinction in its middle.
  };
  /// Puffs [first, last) lie in the sphere.
  struct Group {
    Eigen::Vector3d centre_W;
    double radius_m2;
    std::size_t first;
    std::size_t last;
  };
  /// A puff as this beam passes it.
  struct Passage {
    double nearest_m;  ///< Along the beam.
    double half_m;     ///< Half the length of the stretch where it counts.
    double peak_pm;    ///< At the nearest point.
    double sigma_m;
  };
  struct Passages;
  struct Echogram;

  void split(std::size_t first, std::size_t last);
  [[nodiscard]] Group group_of(std::size_t first, std::size_t last) const;
  void find(const Eigen::Vector3d& start_W, const Eigen::Vector3d& direction_W, double length_m,
            Passages& found) const;
  [[nodiscard]] static double depth(const Passages& found, double length_m);
  void backscatter(const WeatherBeam& beam, double air_pm, const Passages& found,
                   AirPath& path) const;
  void by_optical_depth(const WeatherBeam& beam, std::uint64_t counter, const Passages& found,
                        AirPath& path) const;

  DustParameters parameters_;
  double overlap_start_m_ = 0.9;
  double overlap_end_m_ = 1.0;
  std::vector<Puff> puffs_;
  std::vector<Group> groups_;
  Group all_{};
};

}  // namespace rigwire::sim
