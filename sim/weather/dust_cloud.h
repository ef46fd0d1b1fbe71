// The dust over a scene: at most 200 Gaussian puffs that are stirred up, drift, grow, settle and
// thin out.
//
// A puff of mass m has the density m / ((2 pi)^(3/2) s^3) exp(-d^2 / 2 s^2) at distance d from its
// centre, divided by the share of the Gaussian that is above the ground, since nothing is below it.
//   growth    s^2 grows by 2 K t (diffusion with a constant K)
//   drift     with the wind
//   settling  the centre sinks with the particles' speed v down to the ground, and what touches the
//             ground stays there: dm/dt = -v times the integral of the density over the ground (the
//             tilted plume with source depletion: A. C. Chamberlain 1953, T. J. Overcamp, "A
//             general Gaussian diffusion-deposition model", J. Appl. Meteorology 15, 1976)
// Masses are exact: emitted = airborne + settled + dispersed, where dispersed is the mass dropped
// when a puff's maximum optical depth had fallen below 5e-4.
//
// An emitter fills its present puff until it has moved on by the puff's size. Puffs of similar size
// that have grown into each other (centres nearer than 0.8 s) are merged, keeping mass, centre and
// second moments, so that a trail is a row of puffs about one s apart: the row's ripple is below
// 1e-3, and s too large by 3 %. When the cloud is full nevertheless, the two puffs are merged whose
// union changes it least. The ground is a level plane for each puff, at the height below its
// emitter.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/weather/dust_emitter.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

inline constexpr std::size_t kMostPuffs = 200;

struct DustPuff {
  Eigen::Vector3d centre_W = Eigen::Vector3d::Zero();
  double ground_z_m = 0.0;
  double mass_kg = 0.0;
  double variance_m2 = 0.0;  ///< s^2 along each axis.

  /// Returns the share of the Gaussian that is above the ground: 0.5 .. 1.
  [[nodiscard]] double share_above_ground() const;
};

/// Returns the puff with the mass, centre and second moment of both.
[[nodiscard]] DustPuff merged(const DustPuff& a, const DustPuff& b);

struct DustBalance {
  double emitted_kg = 0.0;
  double settled_kg = 0.0;
  double dispersed_kg = 0.0;
};

class DustCloud {
 public:
  explicit DustCloud(const DustParameters& parameters);

  /// Advances by `step_s`: the puffs move with the wind, then the emitters add what they made
  /// during the step, times `dustiness`, where they are at its end. Does not allocate.
  void advance(double step_s, const Eigen::Vector2d& wind_mps, double dustiness,
               std::span<const DustEmitter> emitters);

  [[nodiscard]] std::span<const DustPuff> puffs() const { return puffs_; }
  [[nodiscard]] const DustBalance& balance() const { return balance_; }
  [[nodiscard]] double airborne_kg() const;

 private:
  static constexpr std::size_t kNoPuff = ~std::size_t{0};

  void move(double step_s, const Eigen::Vector2d& wind_mps);
  void emit(std::size_t emitter, const DustPuff& fresh);
  void unite_overlapping();
  void make_room();
  void unite(std::size_t kept, std::size_t gone);
  void remove(std::size_t puff);

  DustParameters parameters_;
  std::vector<DustPuff> puffs_;
  std::vector<std::size_t> open_;  ///< By emitter: the puff that it fills.
  DustBalance balance_;
  double since_union_s_ = 0.0;
};

}  // namespace rigwire::sim
