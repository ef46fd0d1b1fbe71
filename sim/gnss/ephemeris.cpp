#include "sim/gnss/ephemeris.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

/// By what L2 is delayed more than L1: section 20.3.3.3.3.2.
constexpr double kDelayOfSecond = (77.0 / 60.0) * (77.0 / 60.0);

double within_half_week(double seconds) {
  return seconds - kWeek_s * std::round(seconds / kWeek_s);
}

/// One field of the message: `bits` wide, in steps of 2^exponent.
struct Field {
  const char* name;
  int bits;
  int exponent;
  bool is_signed;
};

double rounded(const Field& field, double value) {
  const double steps = std::nearbyint(std::ldexp(value, -field.exponent));
  const double span = std::ldexp(1.0, field.is_signed ? field.bits - 1 : field.bits);
  const double least = field.is_signed ? -span : 0.0;
  if (!(steps >= least && steps <= span - 1.0)) {
    throw std::invalid_argument(std::string("gps ephemeris: ") + field.name + " is " +
                                std::to_string(value) + ", allowed are " +
                                std::to_string(std::ldexp(least, field.exponent)) + " .. " +
                                std::to_string(std::ldexp(span - 1.0, field.exponent)));
  }
  return std::ldexp(steps, field.exponent);
}

/// A full circle of angle in 32 bits; wraps.
double rounded_angle(double angle_rad) {
  const double semicircles = angle_rad / kSemicircle_rad;
  double steps = std::nearbyint(std::ldexp(semicircles - 2.0 * std::round(semicircles / 2.0), 31));
  if (steps >= std::ldexp(1.0, 31)) {
    steps -= std::ldexp(1.0, 32);
  }
  return std::ldexp(steps, -31) * kSemicircle_rad;
}

double rounded_rate(const Field& field, double rate_radps) {
  return rounded(field, rate_radps / kSemicircle_rad) * kSemicircle_rad;
}

}  // namespace

double seconds_between(std::int32_t week, double time_of_week_s, const GpsTime& time,
                       double offset_s) {
  const std::int64_t reference_ns = std::llround(time_of_week_s * 1e9);
  const std::int64_t span_ns =
      (std::int64_t{time.week} - week) * kWeek_ns + (time.time_of_week_ns - reference_ns);
  return static_cast<double>(span_ns) * 1e-9 + offset_s;
}

double eccentric_anomaly(double mean_anomaly_rad, double eccentricity) {
  // Newton squares the error times e / 2: a step below 1e-8 leaves nothing to see. At most four.
  constexpr double kLastStep = 1e-8;
  double anomaly = mean_anomaly_rad + eccentricity * std::sin(mean_anomaly_rad);
  for (int round = 0; round < 4; ++round) {
    const double step = (mean_anomaly_rad - anomaly + eccentricity * std::sin(anomaly)) /
                        (1.0 - eccentricity * std::cos(anomaly));
    anomaly += step;
    if (std::abs(step) < kLastStep) {
      break;
    }
  }
  return anomaly;
}

SatelliteState satellite_state(const GpsEphemeris& eph, const GpsTime& time, double offset_s,
                               const OrbitConstants& earth) {
  // Table 20-IV: t_k, A, n = n_0 + delta n, M_k, and Kepler's equation for E_k.
  const double since_toe_s =
      within_half_week(seconds_between(eph.week, eph.ephemeris_time_s, time, offset_s));
  const double a_m = eph.sqrt_semi_major_axis * eph.sqrt_semi_major_axis;
  const double e = eph.eccentricity;
  const double rate =
      std::sqrt(earth.gravity_m3ps2 / (a_m * a_m * a_m)) + eph.mean_motion_difference;
  const double anomaly =
      eccentric_anomaly(std::fmod(eph.mean_anomaly_rad + rate * since_toe_s, kTurn), e);
  const double sin_e = std::sin(anomaly);
  const double cos_e = std::cos(anomaly);
  const double shape = 1.0 - e * cos_e;
  const double anomaly_rate = rate / shape;

  // True anomaly, argument of latitude Phi_k; rates by differentiation of each line.
  const double flatness = std::sqrt(1.0 - e * e);
  const double phi = std::atan2(flatness * sin_e, cos_e - e) + eph.argument_of_perigee_rad;
  const double phi_rate = flatness * anomaly_rate / shape;
  const double sin_2phi = std::sin(2.0 * phi);
  const double cos_2phi = std::cos(2.0 * phi);
  const auto harmonic = [&](double sine, double cosine) {
    return sine * sin_2phi + cosine * cos_2phi;
  };
  const auto harmonic_rate = [&](double sine, double cosine) {
    return 2.0 * phi_rate * (sine * cos_2phi - cosine * sin_2phi);
  };

  // Second harmonics: u_k, r_k, i_k; node Omega_k in the turning earth.
  const double u = phi + harmonic(eph.latitude_sine_rad, eph.latitude_cosine_rad);
  const double u_rate = phi_rate + harmonic_rate(eph.latitude_sine_rad, eph.latitude_cosine_rad);
  const double r = a_m * shape + harmonic(eph.radius_sine_m, eph.radius_cosine_m);
  const double r_rate =
      a_m * e * sin_e * anomaly_rate + harmonic_rate(eph.radius_sine_m, eph.radius_cosine_m);
  const double i = eph.inclination_rad + eph.inclination_rate * since_toe_s +
                   harmonic(eph.inclination_sine_rad, eph.inclination_cosine_rad);
  const double i_rate =
      eph.inclination_rate + harmonic_rate(eph.inclination_sine_rad, eph.inclination_cosine_rad);
  const double node_rate = eph.ascending_node_rate - earth.rotation_radps;
  const double node = std::fmod(eph.ascending_node_rad + node_rate * since_toe_s -
                                    earth.rotation_radps * eph.ephemeris_time_s,
                                kTurn);

  const double sin_u = std::sin(u);
  const double cos_u = std::cos(u);
  const double sin_i = std::sin(i);
  const double cos_i = std::cos(i);
  // In the orbit's plane, x towards the node.
  const double x = r * cos_u;
  const double y = r * sin_u;
  const double x_rate = r_rate * cos_u - y * u_rate;
  const double y_rate = r_rate * sin_u + x * u_rate;
  // In the equator's plane, x still towards the node.
  const double equator = y * cos_i;
  const double equator_rate = y_rate * cos_i - y * sin_i * i_rate;
  const Eigen::Vector2d towards_node(std::cos(node), std::sin(node));
  const Eigen::Vector2d across(-towards_node.y(), towards_node.x());

  SatelliteState state;
  state.position_E_m << x * towards_node + equator * across, y * sin_i;
  state.velocity_E_mps << (x_rate - equator * node_rate) * towards_node +
                              (equator_rate + x * node_rate) * across,
      y_rate * sin_i + y * cos_i * i_rate;

  // 20.3.3.3.3.1: a_f0 + a_f1 t + a_f2 t^2 + F e sqrt(A) sin E_k, and its rate.
  const double since_toc_s =
      within_half_week(seconds_between(eph.week, eph.clock_time_s, time, offset_s));
  // F = -2 sqrt(mu) / c^2.
  const double relativity = -2.0 * std::sqrt(earth.gravity_m3ps2) /
                            (kLightSpeed_mps * kLightSpeed_mps) * e * eph.sqrt_semi_major_axis;
  state.clock_s = eph.clock_bias_s +
                  since_toc_s * (eph.clock_drift + since_toc_s * eph.clock_drift_rate) +
                  relativity * sin_e;
  state.clock_drift = eph.clock_drift + 2.0 * eph.clock_drift_rate * since_toc_s +
                      relativity * cos_e * anomaly_rate;
  state.group_delay_s = eph.group_delay_s;
  state.second_delay_s = kDelayOfSecond * eph.group_delay_s;
  state.healthy = eph.health == 0;
  return state;
}

GpsEphemeris quantised(const GpsEphemeris& eph) {
  GpsEphemeris q = eph;
  q.group_delay_s = rounded({"group delay (s)", 8, -31, true}, eph.group_delay_s);
  q.clock_time_s = rounded({"clock time (s)", 16, 4, false}, eph.clock_time_s);
  q.clock_bias_s = rounded({"clock bias (s)", 22, -31, true}, eph.clock_bias_s);
  q.clock_drift = rounded({"clock drift (s/s)", 16, -43, true}, eph.clock_drift);
  q.clock_drift_rate = rounded({"clock drift rate (s/s2)", 8, -55, true}, eph.clock_drift_rate);
  q.ephemeris_time_s = rounded({"ephemeris time (s)", 16, 4, false}, eph.ephemeris_time_s);
  q.sqrt_semi_major_axis =
      rounded({"root of semi-major axis (sqrt m)", 32, -19, false}, eph.sqrt_semi_major_axis);
  q.eccentricity = rounded({"eccentricity", 32, -33, false}, eph.eccentricity);
  q.mean_anomaly_rad = rounded_angle(eph.mean_anomaly_rad);
  q.ascending_node_rad = rounded_angle(eph.ascending_node_rad);
  q.inclination_rad = rounded_angle(eph.inclination_rad);
  q.argument_of_perigee_rad = rounded_angle(eph.argument_of_perigee_rad);
  q.mean_motion_difference = rounded_rate({"mean motion difference (semicircles/s)", 16, -43, true},
                                          eph.mean_motion_difference);
  q.ascending_node_rate =
      rounded_rate({"ascending node rate (semicircles/s)", 24, -43, true}, eph.ascending_node_rate);
  q.inclination_rate =
      rounded_rate({"inclination rate (semicircles/s)", 14, -43, true}, eph.inclination_rate);
  q.latitude_cosine_rad = rounded({"Cuc (rad)", 16, -29, true}, eph.latitude_cosine_rad);
  q.latitude_sine_rad = rounded({"Cus (rad)", 16, -29, true}, eph.latitude_sine_rad);
  q.radius_cosine_m = rounded({"Crc (m)", 16, -5, true}, eph.radius_cosine_m);
  q.radius_sine_m = rounded({"Crs (m)", 16, -5, true}, eph.radius_sine_m);
  q.inclination_cosine_rad = rounded({"Cic (rad)", 16, -29, true}, eph.inclination_cosine_rad);
  q.inclination_sine_rad = rounded({"Cis (rad)", 16, -29, true}, eph.inclination_sine_rad);
  return q;
}

GpsEphemeris reissued(const GpsEphemeris& eph, std::int64_t later_s, std::int64_t issues) {
  const auto later = static_cast<double>(later_s);
  const double a_m = eph.sqrt_semi_major_axis * eph.sqrt_semi_major_axis;
  const double rate =
      std::sqrt(kEarthGravity_m3ps2 / (a_m * a_m * a_m)) + eph.mean_motion_difference;
  const std::int64_t reference_s = std::llround(eph.ephemeris_time_s) + later_s;
  const std::int64_t weeks = (reference_s - (reference_s < 0 ? 604'799 : 0)) / 604'800;

  GpsEphemeris next = eph;
  next.week = eph.week + static_cast<std::int32_t>(weeks);
  next.ephemeris_time_s = static_cast<double>(reference_s - weeks * 604'800);
  // Angles go on by their rates to the new reference time.
  next.mean_anomaly_rad += std::fmod(rate * later, kTurn);
  // The node is stated for the start of the week, in which the earth turns on.
  next.ascending_node_rad +=
      std::fmod(eph.ascending_node_rate * later, kTurn) -
      std::fmod(kEarthRate_radps * kWeek_s * static_cast<double>(weeks), kTurn);
  next.inclination_rad += eph.inclination_rate * later;

  const double toc_less_toe_s = within_half_week(eph.clock_time_s - eph.ephemeris_time_s);
  next.clock_time_s = next.ephemeris_time_s;
  // The clock's polynomial restated for the new time of clock.
  const double drifting_s = std::clamp(later, -kWeek_s, kWeek_s) - toc_less_toe_s;
  constexpr double kLargestBias_s = 9.7e-4;
  next.clock_bias_s = std::clamp(
      eph.clock_bias_s + drifting_s * (eph.clock_drift + drifting_s * eph.clock_drift_rate),
      -kLargestBias_s, kLargestBias_s);
  next.clock_drift =
      std::abs(later) > kWeek_s ? 0.0 : eph.clock_drift + 2.0 * drifting_s * eph.clock_drift_rate;
  if (std::abs(later) > kWeek_s) {
    next.clock_drift_rate = 0.0;
  }

  const std::int64_t issue = (eph.issue_of_ephemeris + issues - 1) % 255;
  next.issue_of_ephemeris = static_cast<std::uint8_t>(1 + (issue < 0 ? issue + 255 : issue));
  next.issue_of_clock =
      static_cast<std::uint16_t>((eph.issue_of_clock & 0x300) | next.issue_of_ephemeris);
  return quantised(next);
}

}  // namespace rigwire::sim
