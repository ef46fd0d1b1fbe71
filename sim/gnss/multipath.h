// Reflections of satellite signals by the walls around an antenna, searched with few rays.
//
// Fixed directions in a few rings find the surfaces around; each becomes a plane. For a satellite,
// each plane has one specular point; two rays test whether the wall is really there and whether the
// satellite is visible from it. A reflected path is longer by 2 D (s . n), with D the antenna's
// distance from the plane, n its normal and s the direction to the satellite: for a vertical wall 2
// D cos E cos(azimuth from the normal), never negative.
//
// Results of the search are kept, with path lengths that follow the antenna, until the antenna has
// moved or time has passed beyond the parameters' limits. Limits of the model: one reflection, flat
// walls, no diffraction; walls between the directions (30 degrees apart at the horizon) may be
// missed.
//
// Real walls have balconies, windows and neighbours: the strongest path of a signal without line of
// sight is longer than a flat wall's by some metres, and changes at once where another part takes
// over. This excess is exponentially distributed and renewed at random (scatter_m and below), as
// echoes of land mobile satellite channels are (A. Lehner, A. Steingass, "A novel channel model for
// land mobile satellite navigation", ION GNSS 2005, recalled); its sizes are chosen for the errors
// of a NEO-M8T in a street of Hong Kong (UrbanNav, Tsim Sha Tsui 2019).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"
#include "sim/visibility.h"

namespace rigwire::sim {

struct MultipathParameters {
  bool enabled = true;
  double reach_m = 50.0;               ///< Surfaces farther away are not searched; (0, 500].
  double reflection_loss_db = 8.0;     ///< Reflected signal relative to the direct one; [0, 40].
  double correlator_spacing_m = 29.3;  ///< Early to late; 0.1 chip of C/A code; [1, 300].
  double search_distance_m = 1.0;      ///< The search is repeated after so much motion ...
  double search_period_s = 5.0;        ///< ... or after so much time; 0 = every epoch.
  /// By how much a signal that only a wall's reflection brings is longer than a mirror would make
  /// it, mean of an exponential distribution ...
  double scatter_m = 3.5;
  double scatter_length_m = 10.0;  ///< ... that is drawn anew after so much motion ...
  double scatter_period_s = 20.0;  ///< ... or after so much time, on average.
};
void visit(fields::Visitor& v, MultipathParameters& p);

/// Throws std::invalid_argument naming the key, its value and what is allowed.
void validate(const MultipathParameters& parameters);

/// Code error of a direct signal joined by a reflected one, at the worst phase, m: the amplitude
/// ratio times the delay, at most half that ratio times the correlator spacing, 0 from 1.5 chips
/// on. M. S. Braasch, "Multipath effects", in Parkinson and Spilker (eds.), Global Positioning
/// System: Theory and Applications I, 1996, chapter 14.
[[nodiscard]] double multipath_envelope_m(const MultipathParameters& parameters,
                                          double extra_path_m);

class ReflectionSearch {
 public:
  explicit ReflectionSearch(const MultipathParameters& parameters) : parameters_(parameters) {}

  /// Renews what is known when it is due. `directions_W` of all satellites above the horizon, each
  /// with a number of its own below `ids`; those that are new are searched at once.
  struct Satellite {
    std::uint32_t id = 0;
    Eigen::Vector3d direction_W = Eigen::Vector3d::UnitZ();
  };
  void update(SimTime time, const Eigen::Vector3d& p_W, std::span<const Satellite> satellites,
              std::uint32_t ids, const Visibility& visibility, double clearance_m);

  /// Extra length of the shortest reflected path to this satellite; nothing without one.
  [[nodiscard]] std::optional<double> extra_path_m(std::uint32_t id, const Eigen::Vector3d& p_W,
                                                   const Eigen::Vector3d& direction_W) const;

  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  struct Plane {
    Eigen::Vector3d normal_W = Eigen::Vector3d::UnitX();  ///< Towards the antenna.
    double offset_m = 0.0;                                ///< normal . point of it.
  };
  struct Path {
    bool known = false;
    std::vector<std::uint32_t> planes;
  };

  void find_planes(const Eigen::Vector3d& p_W, const Visibility& visibility, double clearance_m);
  void find_paths(const Satellite& satellite, const Eigen::Vector3d& p_W,
                  const Visibility& visibility, double clearance_m);

  MultipathParameters parameters_;
  std::vector<Plane> planes_;
  std::vector<Path> paths_;  ///< By id.
  Eigen::Vector3d searched_at_W_ = Eigen::Vector3d::Zero();
  SimTime searched_ = kNever;
  std::uint64_t rays_ = 0;
};

}  // namespace rigwire::sim
