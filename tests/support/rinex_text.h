// GPS observations and broadcast sets as RINEX 3.03 text, as little of it as RTKLIB needs to
// compute a position. Written from the format's tables A2, A3, A5 and A6, on its own, so that it
// shares no mistake with a product's writer.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

#include "sim/samples/gnss_sample.h"
#include "sim/samples/gps_navigation.h"

namespace rigwire::test {

/// A GPS instant as calendar numbers (no leap seconds), seconds with seven decimals.
inline std::string rinex_time(const char* format, std::int64_t gps_ns) {
  using namespace std::chrono;
  const sys_time<nanoseconds> instant{sys_days{1980y / January / 6}.time_since_epoch() +
                                      nanoseconds{gps_ns}};
  const auto day = floor<days>(instant);
  const year_month_day date{day};
  const hh_mm_ss clock{instant - day};
  const double seconds =
      static_cast<double>((clock.seconds() + nanoseconds{clock.subseconds()}).count()) * 1e-9;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                seconds);
  return text.data();
}

inline std::string rinex_header(const std::string& content, const char* label) {
  std::string line = content;
  line.resize(60, ' ');
  return line + label + "\n";
}

inline std::string rinex_observation_header() {
  return rinex_header("     3.03           OBSERVATION DATA    G", "RINEX VERSION / TYPE") +
         rinex_header("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES") +
         rinex_header("", "END OF HEADER");
}

/// `label_ns`: what the receiver's clock showed, ns since 1980-01-06.
inline std::string rinex_epoch(std::int64_t label_ns,
                               std::span<const GnssMeasurement> measurements) {
  std::array<char, 128> text{};
  std::string lines = rinex_time("> %04d %02u %02u %02d %02d%11.7f", label_ns);
  std::snprintf(text.data(), text.size(), "  0%3zu\n", measurements.size());
  lines += text.data();
  for (const GnssMeasurement& m : measurements) {
    std::snprintf(text.data(), text.size(), "G%02d%14.3f  %14.3f%c %14.3f  %14.3f  \n", m.number,
                  m.pseudorange_m, m.carrier_phase_cycles, m.slipped ? '1' : ' ', m.doppler_hz,
                  m.cn0_dbhz);
    lines += text.data();
  }
  return lines;
}

inline std::string rinex_navigation_header(const KlobucharParameters& ionosphere) {
  const auto correction = [](const char* name, const std::array<double, 4>& c) {
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "%s %12.4E%12.4E%12.4E%12.4E", name, c[0], c[1], c[2],
                  c[3]);
    return rinex_header(text.data(), "IONOSPHERIC CORR");
  };
  return rinex_header("     3.03           N: GNSS NAV DATA    G: GPS", "RINEX VERSION / TYPE") +
         correction("GPSA", ionosphere.alpha) + correction("GPSB", ionosphere.beta) +
         rinex_header("", "END OF HEADER");
}

inline std::string rinex_ephemeris(const GpsEphemeris& e) {
  const std::int64_t toc_ns =
      (std::int64_t{e.week} * 604'800 + std::llround(e.clock_time_s)) * 1'000'000'000;
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "G%02d ", e.prn);
  std::string lines = text.data() + rinex_time("%04d %02u %02u %02d %02d %02.0f", toc_ns);
  std::snprintf(text.data(), text.size(), "%19.12E%19.12E%19.12E\n", e.clock_bias_s, e.clock_drift,
                e.clock_drift_rate);
  lines += text.data();
  const std::array<std::array<double, 4>, 7> rows{{
      {static_cast<double>(e.issue_of_ephemeris), e.radius_sine_m, e.mean_motion_difference,
       e.mean_anomaly_rad},
      {e.latitude_cosine_rad, e.eccentricity, e.latitude_sine_rad, e.sqrt_semi_major_axis},
      {e.ephemeris_time_s, e.inclination_cosine_rad, e.ascending_node_rad, e.inclination_sine_rad},
      {e.inclination_rad, e.radius_cosine_m, e.argument_of_perigee_rad, e.ascending_node_rate},
      {e.inclination_rate, 0.0, static_cast<double>(e.week), 0.0},
      {2.0, static_cast<double>(e.health), e.group_delay_s, static_cast<double>(e.issue_of_clock)},
      {e.ephemeris_time_s - 3'600.0, 4.0, 0.0, 0.0},
  }};
  for (const auto& row : rows) {
    std::snprintf(text.data(), text.size(), "    %19.12E%19.12E%19.12E%19.12E\n", row[0], row[1],
                  row[2], row[3]);
    lines += text.data();
  }
  return lines;
}

}  // namespace rigwire::test
