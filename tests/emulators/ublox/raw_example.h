// Navigation data and measurements for the tests of raw messages: made up, but of the size of real
// ones and consistent from epoch to epoch.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <memory>

#include "emulators/gps_broadcast.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// One frame of the message before the one with page 18, ionosphere and UTC: 10:00:30 by GPS time.
inline constexpr UtcTime kExampleStart{2024, 6, 5, 10, 0, 12, 0};
inline constexpr std::int32_t kExampleWeek = 2317;
inline constexpr double kExampleToe_s = 295'200.0;
inline constexpr std::array<std::uint8_t, 5> kExamplePrns{1, 8, 17, 23, 32};

inline GpsEphemeris example_ephemeris(std::uint8_t prn) {
  protocols::gps::Ephemeris e;
  const double k = prn;
  e.prn = prn;
  e.week = kExampleWeek;
  e.issue_of_clock = static_cast<std::uint16_t>(512 + prn);
  e.issue_of_ephemeris = prn;
  e.accuracy_index = 1;
  e.group_delay_s = -1e-8 + 5e-10 * k;
  e.clock_time_s = kExampleToe_s;
  e.clock_bias_s = -3e-4 + 2e-5 * k;
  e.clock_drift = 1e-12 * (k - 16.0);
  e.ephemeris_time_s = kExampleToe_s;
  e.sqrt_semi_major_axis = 5153.6 + 0.01 * k;
  e.eccentricity = 0.001 * k;
  e.mean_anomaly_rad = -3.1 + 0.19 * k;
  e.mean_motion_difference = 4.2e-9 + 1e-11 * k;
  e.ascending_node_rad = 3.1 - 0.19 * k;
  e.inclination_rad = 0.96 + 1e-4 * k;
  e.argument_of_perigee_rad = -1.5 + 0.09 * k;
  e.ascending_node_rate = -8e-9 - 1e-11 * k;
  e.inclination_rate = 1e-10 * (k - 16.0);
  e.latitude_cosine_rad = 2e-6 - 1e-7 * k;
  e.latitude_sine_rad = 9e-6 - 1e-7 * k;
  e.radius_cosine_m = 200.0 + k;
  e.radius_sine_m = -40.0 + k;
  e.inclination_cosine_rad = 1e-7 - 1e-8 * k;
  e.inclination_sine_rad = -5e-8 + 5e-9 * k;
  return to_sample(protocols::gps::quantised(e));
}

inline std::shared_ptr<GpsNavigation> example_navigation() {
  auto navigation = std::make_shared<GpsNavigation>();
  for (const std::uint8_t prn : kExamplePrns) {
    navigation->ephemerides[prn - 1U] = example_ephemeris(prn);
  }
  navigation->ionosphere.alpha = {12 * std::ldexp(1.0, -30), 2 * std::ldexp(1.0, -27),
                                  -std::ldexp(1.0, -24), -2 * std::ldexp(1.0, -24)};
  navigation->ionosphere.beta = {44 * 2048.0, 3 * 16384.0, -2 * 65536.0, -7 * 65536.0};
  navigation->utc = {.a0_s = 3 * std::ldexp(1.0, -30),
                     .a1 = -5 * std::ldexp(1.0, -50),
                     .reference_time_s = 81 * 4096.0,
                     .reference_week = kExampleWeek,
                     .leap_seconds = 18,
                     .leap_week = 2185,
                     .leap_day = 7,
                     .leap_seconds_future = 18};
  return navigation;
}

/// Epoch `second` of the run. Ranges of 20 to 25 thousand kilometres that grow or shrink by up to
/// 800 m/s; the carrier keeps a whole number of cycles to them.
inline GnssSample example_sample(int second, std::shared_ptr<const GpsNavigation> navigation) {
  constexpr double kWavelength_m = 299'792'458.0 / 1'575.42e6;
  GnssSample sample;
  sample.time = kStart + std::chrono::seconds{second};
  sample.navigation = std::move(navigation);
  for (const std::uint8_t prn : kExamplePrns) {
    const double rate_mps = 50.0 * (prn - 16.0);
    GnssMeasurement m;
    m.number = prn;
    m.pseudorange_m = 20e6 + 150'000.125 * prn + rate_mps * second;
    m.carrier_phase_cycles = m.pseudorange_m / kWavelength_m - std::fmod(100.0 * prn, 7.0);
    m.doppler_hz = -rate_mps / kWavelength_m;
    m.cn0_dbhz = 30.0 + 0.5 * prn;
    m.locked = std::chrono::seconds{second};
    m.slipped = second == 0;
    m.pseudorange_sigma_m = 0.4;
    m.carrier_sigma_cycles = 0.01;
    m.doppler_sigma_hz = 0.1;
    sample.measurements.push_back(m);
    sample.satellites.push_back({.number = prn,
                                 .azimuth_rad = 0.1 * prn,
                                 .elevation_rad = 0.03 * prn,
                                 .cn0_dbhz = m.cn0_dbhz,
                                 .tracked = true,
                                 .used = true});
  }
  return sample;
}

}  // namespace rigwire::emulators
