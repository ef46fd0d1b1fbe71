#include <array>

#include "protocols/gps/subframe.h"
#include "protocols/rinex/columns.h"
#include "protocols/rinex/navigation.h"
#include "protocols/rinex/text.h"

namespace rigwire::protocols::rinex {
namespace {

void append_ionosphere(std::string& out, std::string_view kind,
                       const std::array<double, 4>& values) {
  std::string line = padded(kind, 5);
  for (const double value : values) {
    append(line, "%12.4E", value);
  }
  append_header(out, line, "IONOSPHERIC CORR");
}

void append_head(std::string& out, const NavigationFile& file, const Origin& origin) {
  append_header(out,
                padded("     3.04", 20) + padded("N: GNSS NAV DATA", 20) + padded("G: GPS", 20),
                "RINEX VERSION / TYPE");
  append_header(out, padded(origin.program, 20) + padded(origin.run_by, 20) + origin.date,
                "PGM / RUN BY / DATE");
  const gps::IonosphereUtc& parameters = file.ionosphere_utc;
  if (file.has_ionosphere) {
    append_ionosphere(out, "GPSA", parameters.alpha);
    append_ionosphere(out, "GPSB", parameters.beta);
  }
  if (file.has_utc) {
    std::string line = "GPUT ";
    append(line, "%17.10E%16.9E %6.0f %4d", parameters.utc_a0_s, parameters.utc_a1,
           parameters.utc_reference_time_s, parameters.utc_reference_week);
    append_header(out, line, "TIME SYSTEM CORR");
  }
  if (file.has_leap_seconds) {
    std::string line;
    append(line, "%6d%6d%6d%6d", parameters.leap_seconds, parameters.leap_seconds_future,
           parameters.leap_week, parameters.leap_day);
    append_header(out, line, "LEAP SECONDS");
  }
  append_header(out, "", "END OF HEADER");
}

void append_numbers(std::string& out, const std::array<double, 4>& numbers, std::size_t count = 4) {
  out += "    ";
  for (std::size_t i = 0; i < count; ++i) {
    append(out, "%19.12E", numbers[i]);
  }
  out += '\n';
}

// toc lies within half a week of toe, whose week is known.
Epoch clock_epoch(const gps::Ephemeris& e) {
  const double ahead_s = e.clock_time_s - e.ephemeris_time_s;
  const int weeks = ahead_s > gps::kWeekSeconds / 2.0    ? -1
                    : ahead_s < -gps::kWeekSeconds / 2.0 ? 1
                                                         : 0;
  return {e.week + weeks, e.clock_time_s};
}

void append_record(std::string& out, const NavigationRecord& record) {
  const gps::Ephemeris& e = record.ephemeris;
  const CalendarDate date = to_date(clock_epoch(e));
  append(out, "G%02d %04d %02d %02d %02d %02d %02.0f%19.12E%19.12E%19.12E\n", int{e.prn}, date.year,
         date.month, date.day, date.hour, date.minute, date.second, e.clock_bias_s, e.clock_drift,
         e.clock_drift_rate);
  append_numbers(out, {static_cast<double>(e.issue_of_ephemeris), e.radius_sine_m,
                       e.mean_motion_difference, e.mean_anomaly_rad});
  append_numbers(
      out, {e.latitude_cosine_rad, e.eccentricity, e.latitude_sine_rad, e.sqrt_semi_major_axis});
  append_numbers(out, {e.ephemeris_time_s, e.inclination_cosine_rad, e.ascending_node_rad,
                       e.inclination_sine_rad});
  append_numbers(out, {e.inclination_rad, e.radius_cosine_m, e.argument_of_perigee_rad,
                       e.ascending_node_rate});
  append_numbers(out, {e.inclination_rate, static_cast<double>(e.l2_code),
                       static_cast<double>(e.week), e.l2_p_data_off ? 1.0 : 0.0});
  append_numbers(out, {gps::nominal_accuracy_m(e.accuracy_index), static_cast<double>(e.health),
                       e.group_delay_s, static_cast<double>(e.issue_of_clock)});
  append_numbers(out, {record.transmission_time_s, e.long_fit ? 6.0 : 4.0, 0.0, 0.0}, 2);
}

}  // namespace

std::string write_navigation(const NavigationFile& file, const Origin& origin) {
  std::string out;
  append_head(out, file, origin);
  for (const NavigationRecord& record : file.records) {
    append_record(out, record);
  }
  return out;
}

}  // namespace rigwire::protocols::rinex
