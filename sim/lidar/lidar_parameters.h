// How well a spinning lidar measures, and by which model of its beams and echoes.
#pragma once

#include "fields/rules.h"

namespace rigwire::sim {

/// How the random error of a range is made.
enum class RangeNoise {
  constant,  ///< Equal spread for every echo.
  signal,    ///< Faint echoes are less exact (link_budget.h, range_spread_m).
  jitter     ///< Faint echoes are less exact (link_budget.h, noise_growth).
};

struct SpinningLidarParameters {
  double range_sigma_m = 0.02;     ///< Gaussian range noise, independent per echo.
  double housing_radius_m = 0.10;  ///< Rays begin here. Hits nearer than the pattern's minimum
                                   ///< range block the ray and are reported as none.
  /// Casting threads, the caller's included. Results do not depend on it.
  int threads = 1;

  /// Rays per beam: 1, 5 or 19; 1000 to compare with (beam_sampler.h). 0: 1 if only the strongest
  /// echo is requested, kSubRaysOfSeveralEchoes if echoes are to be separated, which a beam without
  /// width cannot return in clear air.
  int sub_rays = 0;
  RangeNoise range_noise = RangeNoise::constant;
  /// Resolution of the receiver with RangeNoise::signal: an echo that is just seen has 1 / sqrt(2)
  /// of it as spread, besides range_sigma_m. 0.09 m: Kilic et al., "Lidar Light Scattering
  /// Augmentation (LISA)", arXiv 2107.07004, 2021.
  double range_resolution_m = 0.09;
  /// With RangeNoise::jitter: the signal, in multiples of the faintest that is seen, at which the
  /// receiver's own noise is as large as the rest of the error. It makes the reflectivity of faint
  /// echoes less exact by the same factor.
  double noise_onset = 3.0;
  /// Spread of the reflectivity from shot to shot, as a share of it: speckle, and what the receiver
  /// does to a strong signal.
  double reflectivity_sigma = 0.0;
  /// Spread of the lasers' constant errors of reflectivity, as a share of it: what is left after
  /// the unit's calibration. One number per laser for the whole run, cut off at
  /// kGreatestBias_sigma. It changes what is reported, not what is seen.
  double laser_reflectivity_sigma = 0.0;
  /// Spread of the constant errors of the lasers, one number per laser for the whole run, cut off
  /// at kGreatestBias_sigma: a unit beyond its data sheet does not leave the factory.
  double laser_bias_sigma_m = 0.0;
  /// Where a 90 % diffuse target is just seen, head on in clear air; 0: at the pattern's maximum
  /// range.
  double reference_range_m = 0.0;
  /// Reference range for what the air returns: rain, fog, dust. 0: reference_range_m. Receivers
  /// raise their threshold nearby against scattered light; the laws of sim/weather were compared
  /// with recordings at the ranges of the data sheets, and keep their figures by this.
  double air_reference_range_m = 0.0;
  /// Nearest echo of the air: nearer, the fields of transmitter and receiver do not overlap. 0: the
  /// pattern's minimum range.
  double air_minimum_range_m = 0.0;
  /// Nearer, fog and haze are received with the share (range / focus)^2 of their light: the width
  /// of the lens over the detector's angle (WeatherBeam::focus_m). 0: all of it.
  double air_focus_range_m = 0.0;
  /// The weaker of two echoes nearer to each other than this is not reported.
  double echo_separation_m = 1.0;
  /// The reported reflectivity is that of the surface at normal incidence. The real sensors do not
  /// know the angle: false.
  bool compensates_incidence = false;

  // Losses without a cause in the model, as CARLA's ray-cast lidar has them.
  double drop_rate = 0.0;  ///< Share of the shots that come to nothing.
  /// Echoes of a lower reflectivity are lost with a probability that falls from `drop_at_zero` at
  /// reflectivity 0 linearly to nothing here.
  double drop_limit = 0.0;
  double drop_at_zero = 0.0;

  /// Share of a pulse that is scattered to `blooming_angle_rad` from the beam's middle, all round:
  /// neighbours of a retro-reflector see it too, at its range. 0: none.
  double blooming_share = 0.0;
  double blooming_angle_rad = 0.010;
};
inline constexpr int kSubRaysOfSeveralEchoes = 5;
inline constexpr double kGreatestBias_sigma = 2.5;

/// Returns the rays per beam, for a receiver that separates echoes or one that does not.
[[nodiscard]] int rays_per_beam(const SpinningLidarParameters& parameters, bool several_echoes);

void visit(fields::Visitor& v, SpinningLidarParameters& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const SpinningLidarParameters& parameters);

}  // namespace rigwire::sim
