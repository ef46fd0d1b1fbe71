// How much of a pulse comes back, and what the sensor makes of it. One set of formulas for one
// number (float, double) and for eight side by side (Lanes).
//
// Unit of energy: what a white Lambertian surface, met head on by the whole beam in clear air,
// returns at 1 m. A surface of diffuse reflectance rho met at incidence angle theta at range r by
// the share w of the beam returns w rho cos(theta) T / r^2 with the two-way transmission T: the
// laser radar equation for extended targets (Wagner, "Radiometric calibration of small-footprint
// full-waveform airborne laser scanner measurements", ISPRS J. 65(6), 2010). An echo is seen when
// its energy is at least that of a 90 % target at the reference range R, 0.9 / R^2 (Kilic et al.,
// arXiv 2107.07004, 2021). Without width of the beam, in clear air, the range at which a surface
// vanishes is R sqrt(rho cos(theta) / 0.9).
//
// Retro-reflectors return kIdealRetroGain times the light of a white surface for a gain of 1.
// Reflectivity is reported as the Velodyne manuals say (VLP-16 63-9243 Rev D, p. 32): compensated
// for range, not for incidence nor for the air; up to 1 diffuse, above it retro-reflectors, 2 the
// ideal one. The law in between is ours, linear in what comes back.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {

/// Reflectance of the target that the reference range is stated for.
inline constexpr double kReferenceReflectance = 0.9;

/// Retro-reflective sheeting is sold with 70 to 600 cd/(lx m2) near its axis (classes of ASTM
/// D4956), where a white Lambertian surface has 1 / pi: 200 to 1900 times as much.
inline constexpr double kIdealRetroGain = 1000.0;

/// Sheeting keeps its gain up to about 30 degrees of incidence: all of it below 25, none above 35,
/// linear in the cosine in between.
inline constexpr double kRetroFullCosine = 0.90631;
inline constexpr double kRetroNoneCosine = 0.81915;

namespace link_budget_detail {
inline float unit_clamp(float x) {
  return std::clamp(x, 0.0F, 1.0F);
}
inline double unit_clamp(double x) {
  return std::clamp(x, 0.0, 1.0);
}
template <class Derived>
typename Derived::PlainObject unit_clamp(const Eigen::ArrayBase<Derived>& x) {
  using Scalar = typename Derived::Scalar;
  return x.derived().max(Scalar{0}).min(Scalar{1});
}
inline float square_root(float x) {
  return std::sqrt(x);
}
inline double square_root(double x) {
  return std::sqrt(x);
}
template <class Derived>
typename Derived::PlainObject square_root(const Eigen::ArrayBase<Derived>& x) {
  return x.derived().sqrt();
}
}  // namespace link_budget_detail

/// Share of a retro-reflector's gain that is left at this cosine of the incidence angle, 0 .. 1.
template <class Scalar, class Real>
[[nodiscard]] Real retro_acceptance(const Real& cosine) {
  constexpr auto kSlope = static_cast<Scalar>(1.0 / (kRetroFullCosine - kRetroNoneCosine));
  return link_budget_detail::unit_clamp(
      Real((cosine - static_cast<Scalar>(kRetroNoneCosine)) * kSlope));
}

/// What a surface returns, as a multiple of a white surface met head on.
template <class Scalar, class Real>
[[nodiscard]] Real apparent_reflectance(const Real& reflectance, const Real& retro_gain,
                                        const Real& cosine) {
  return reflectance * cosine +
         static_cast<Scalar>(kIdealRetroGain) * retro_gain * retro_acceptance<Scalar>(cosine);
}

/// The least energy that is seen.
[[nodiscard]] inline double detection_energy(double reference_range_m) {
  return kReferenceReflectance / (reference_range_m * reference_range_m);
}

/// What the sensor reports for an echo of this brightness (energy times range squared), 0 .. 2.
template <class Scalar, class Real>
[[nodiscard]] Real reported_reflectivity(const Real& brightness) {
  constexpr auto kSlope = static_cast<Scalar>(1.0 / (kIdealRetroGain - 1.0));
  return link_budget_detail::unit_clamp(brightness) +
         link_budget_detail::unit_clamp(Real((brightness - Scalar{1}) * kSlope));
}

/// Spread of a range measured from a signal `signal_to_noise` times as strong as the faintest that
/// is seen: `floor_m` and resolution / sqrt(2 SNR), as independent errors (second part: Kilic et
/// al. 2021).
template <class Scalar, class Real>
[[nodiscard]] Real range_sigma_m(Scalar floor_m, Scalar resolution_m, const Real& signal_to_noise) {
  return link_budget_detail::square_root(
      Real(floor_m * floor_m + Scalar{0.5} * resolution_m * resolution_m / signal_to_noise));
}

}  // namespace rigwire::sim
