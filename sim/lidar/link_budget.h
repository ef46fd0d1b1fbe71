// How much of a pulse returns, and what the sensor computes from it. The formulas are for float and
// double, without branches, so that loops over lanes are vectorised.
//
// Unit of energy: the return of a white Lambertian surface at 1 m, hit by the whole beam at normal
// incidence in clear air. A surface of diffuse reflectance rho hit at incidence angle theta and
// range r by the share w of the beam returns w rho f(theta) T / r^2 with the two-way transmission
// T: the laser radar equation for extended targets (Wagner, "Radiometric calibration of
// small-footprint full-waveform airborne laser scanner measurements", ISPRS J. 65(6), 2010). An
// echo is detected when its energy is at least that of a 90 % target at the reference range R, 0.9
// / R^2 (Kilic et al., arXiv 2107.07004, 2021), detection_energy() of sim/weather/weather.h.
// Without width of the beam, in clear air, the range at which a surface vanishes is R sqrt(rho
// f(theta) / 0.9).
//
// f(theta) is 1 at normal incidence. Rough surfaces turn facets of their own towards the light, and
// seen from the light source they stay bright when they slant: Oren and Nayar, "Generalization of
// Lambert's reflectance model", SIGGRAPH 1994, there is f = cos(theta) + (B / A) sin^2(theta) in
// their qualitative model. A facet slope of 30 degrees, between their plaster and their sand, has
// B / A = 0.44. In a public capture of a VLS-128 the road's reflectivity byte stays 8 to 13 from 25
// to 104 m, where cos(theta) falls from 0.08 to 0.02; f falls from 0.52 to 0.46. Smooth paint,
// glass and water, which mirror the beam away, are not modelled.
//
// Retro-reflectors return kIdealRetroGain times the light of a white surface for a gain of 1.
// Reflectivity is reported as the Velodyne manuals say (VLP-16 63-9243 Rev D, p. 32): compensated
// for range, not for incidence nor for the air; up to 1 diffuse, above it retro-reflectors, 2 the
// ideal one. The law in between is ours, linear in what comes back.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/weather/weather.h"

namespace rigwire::sim {

/// Retro-reflective sheeting is sold with 70 to 600 cd/(lx m2) near its axis (classes of ASTM
/// D4956), where a white Lambertian surface has 1 / pi: 200 to 1900 times as much.
inline constexpr double kIdealRetroGain = 1000.0;

/// Sheeting keeps its gain up to about 30 degrees of incidence: all of it below 25, none above 35,
/// linear in the cosine in between.
inline constexpr double kRetroFullCosine = 0.90631;
inline constexpr double kRetroNoneCosine = 0.81915;

/// Share of a retro-reflector's gain that is left at this cosine of the incidence angle, 0 .. 1.
template <class Real>
[[nodiscard]] constexpr Real retro_acceptance(Real cosine) {
  constexpr auto kSlope = static_cast<Real>(1.0 / (kRetroFullCosine - kRetroNoneCosine));
  const Real share = (cosine - static_cast<Real>(kRetroNoneCosine)) * kSlope;
  return std::min(std::max(share, Real{0}), Real{1});
}

/// Return of a surface at 90 degrees of incidence, as a share of that at normal incidence: B / A =
/// 0.45 s^2 / (s^2 + 0.09) / (1 - 0.5 s^2 / (s^2 + 0.33)), s = 30 degrees.
inline constexpr double kGrazingShare = 0.4382;

/// f(theta) of a rough surface, by the cosine of the incidence angle, 0 .. 1; 1 at normal
/// incidence.
template <class Real>
[[nodiscard]] constexpr Real incidence_share(Real cosine) {
  return cosine + static_cast<Real>(kGrazingShare) * (Real{1} - cosine * cosine);
}

/// Returns the reflectance seen by the lidar, as a multiple of a white surface's at normal
/// incidence.
template <class Real>
[[nodiscard]] constexpr Real apparent_reflectance(Real reflectance, Real retro_gain, Real cosine) {
  return reflectance * incidence_share(cosine) +
         static_cast<Real>(kIdealRetroGain) * retro_gain * retro_acceptance(cosine);
}

/// What the sensor reports for an echo of this brightness (energy times range squared), 0 .. 2.
template <class Real>
[[nodiscard]] constexpr Real reported_reflectivity(Real brightness) {
  constexpr auto kSlope = static_cast<Real>(1.0 / (kIdealRetroGain - 1.0));
  const Real retro = (brightness - Real{1}) * kSlope;
  return std::min(std::max(brightness, Real{0}), Real{1}) +
         std::min(std::max(retro, Real{0}), Real{1});
}

/// Spread of a range measured from a signal `signal_to_noise` times as strong as the faintest that
/// is seen: `floor_m` and resolution / sqrt(2 SNR), as independent errors (second part: Kilic et
/// al. 2021).
template <class Real>
[[nodiscard]] Real range_spread_m(Real floor_m, Real resolution_m, Real signal_to_noise) {
  return std::sqrt(floor_m * floor_m + Real{0.5} * resolution_m * resolution_m / signal_to_noise);
}

/// Factor by which the errors of an echo are larger than those of a strong one. `faintness` is the
/// minimum detectable energy over the echo's, 0 .. 1; at 1 / `onset` the receiver's noise is as
/// large as all other errors, which are independent of it.
///
/// A pulse is timed where its slope crosses a threshold: the error of that instant is the noise
/// over the slope, and the slope is in proportion to the signal. Walls in a public scan of an
/// HDL-32E (open-mmlab/mmdetection3d demo/data/nuscenes, nuScenes n015-2018-07-24-11-22-45, above
/// 0.6 m): second differences along azimuth over sqrt(6), by their median, for echoes of 1 .. 2, 2
/// .. 4, 4 .. 8, 8 .. 16, 16 .. 64 times the faintest (reference range 150 m): 13.4, 7.3, 6.0, 4.8,
/// 4.8 mm. An onset of 3 on 4.9 mm gives 11.6, 7.2, 5.6, 5.1, 4.9 mm; a law by the root of the
/// signal (range_spread_m) with the first of these figures 13, 9.8, 7.7, 6.5, 5.5 mm.
template <class Real>
[[nodiscard]] Real noise_growth(Real onset, Real faintness) {
  const Real own = onset * faintness;
  return std::sqrt(Real{1} + own * own);
}

}  // namespace rigwire::sim
