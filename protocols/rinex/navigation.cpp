#include "protocols/rinex/navigation.h"

#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "protocols/gps/broadcast.h"
#include "protocols/rinex/text.h"

namespace rigwire::protocols::rinex {
namespace {

using gps::Ephemeris;

constexpr std::size_t kLabelColumn = 60;
constexpr std::size_t kNumber = 19;  // Columns of a number in a record.
constexpr std::size_t kOrbitLines = 7;
constexpr std::size_t kPerLine = 4;
constexpr std::size_t kOrbitNumbers = kOrbitLines * kPerLine;

constexpr std::array<std::string_view, kOrbitNumbers> kOrbitNames{"IODE",
                                                                  "Crs",
                                                                  "Delta n",
                                                                  "M0",
                                                                  "Cuc",
                                                                  "e",
                                                                  "Cus",
                                                                  "sqrt A",
                                                                  "toe",
                                                                  "Cic",
                                                                  "OMEGA0",
                                                                  "Cis",
                                                                  "i0",
                                                                  "Crc",
                                                                  "omega",
                                                                  "OMEGADOT",
                                                                  "IDOT",
                                                                  "codes on L2",
                                                                  "week",
                                                                  "L2 P flag",
                                                                  "accuracy",
                                                                  "health",
                                                                  "TGD",
                                                                  "IODC",
                                                                  "transmission time",
                                                                  "fit interval",
                                                                  "spare",
                                                                  "spare"};

// What some programs leave out: codes and data flag of L2, and the last line.
bool may_be_blank(std::size_t index) {
  return index == 17 || index == 19 || index >= kOrbitNumbers - kPerLine;
}

bool is_label(std::string_view line, std::string_view label) {
  return trimmed(columns(line, kLabelColumn, 20)) == label;
}

class Reader {
 public:
  Reader(std::string_view text, std::string_view name) : lines_(text, name) {}

  NavigationFile read() {
    read_version();
    read_header();
    std::string_view line;
    while (lines_.next(line)) {
      if (!trimmed(line).empty()) {
        read_record(line);
      }
    }
    return file_;
  }

 private:
  void read_version() {
    const std::string_view line = lines_.require("RINEX VERSION / TYPE");
    if (!is_label(line, "RINEX VERSION / TYPE")) {
      lines_.fail("expected RINEX VERSION / TYPE in columns 61 to 80");
    }
    file_.version = lines_.number(columns(line, 0, 9), "version");
    if (!(file_.version >= 2.0 && file_.version < 4.0)) {
      lines_.fail("version is " + std::string(trimmed(columns(line, 0, 9))) +
                  ", allowed are 2.x and 3.x");
    }
    const std::string_view type = columns(line, 20, 1);
    if (type != "N") {
      lines_.fail("file type is '" + std::string(type) + "', allowed is N (navigation)");
    }
  }

  bool old() const { return file_.version < 3.0; }

  void read_header() {
    while (true) {
      const std::string_view line = lines_.require("END OF HEADER");
      const std::string_view label = trimmed(columns(line, kLabelColumn, 20));
      if (label == "END OF HEADER") {
        return;
      }
      if (label == "ION ALPHA") {
        coefficients(line, 2, file_.ionosphere_utc.alpha);
      } else if (label == "ION BETA") {
        coefficients(line, 2, file_.ionosphere_utc.beta);
        file_.has_ionosphere = true;
      } else if (label == "IONOSPHERIC CORR") {
        ionosphere(line);
      } else if (label == "DELTA-UTC: A0,A1,T,W") {
        utc(columns(line, 3, 19), columns(line, 22, 19), columns(line, 41, 9),
            columns(line, 50, 9));
      } else if (label == "TIME SYSTEM CORR") {
        if (columns(line, 0, 4) == "GPUT") {
          utc(columns(line, 5, 17), columns(line, 22, 16), columns(line, 38, 7),
              columns(line, 45, 5));
        }
      } else if (label == "LEAP SECONDS") {
        leap_seconds(line);
      } else if (label != "COMMENT" && label != "PGM / RUN BY / DATE") {
        ++file_.skipped_header_lines;
      }
    }
  }

  void coefficients(std::string_view line, std::size_t first, std::array<double, 4>& values) {
    constexpr std::size_t kWidth = 12;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] =
          lines_.number(columns(line, first + i * kWidth, kWidth), "coefficient of the ionosphere");
    }
  }

  void ionosphere(std::string_view line) {
    const std::string_view kind = trimmed(columns(line, 0, 4));
    if (kind == "GPSA") {
      coefficients(line, 5, file_.ionosphere_utc.alpha);
    } else if (kind == "GPSB") {
      coefficients(line, 5, file_.ionosphere_utc.beta);
      file_.has_ionosphere = true;
    }
  }

  void utc(std::string_view a0, std::string_view a1, std::string_view time, std::string_view week) {
    file_.ionosphere_utc.utc_a0_s = lines_.number(a0, "A0 of UTC");
    file_.ionosphere_utc.utc_a1 = lines_.number(a1, "A1 of UTC");
    file_.ionosphere_utc.utc_reference_time_s = lines_.number(time, "reference time of UTC");
    file_.ionosphere_utc.utc_reference_week = lines_.integer(week, "week of UTC", 0, 99'999);
    file_.has_utc = true;
  }

  void leap_seconds(std::string_view line) {
    gps::IonosphereUtc& utc = file_.ionosphere_utc;
    const auto field = [&](std::size_t index, std::string_view what, std::int32_t blank) {
      const std::string_view text = columns(line, 6 * index, 6);
      return trimmed(text).empty() ? blank : lines_.integer(text, what, -128, 99'999);
    };
    utc.leap_seconds = field(0, "leap seconds", 0);
    utc.leap_seconds_future = field(1, "future leap seconds", utc.leap_seconds);
    utc.leap_week = field(2, "week of the leap second", 0);
    utc.leap_day = field(3, "day of the leap second", 1);
    file_.has_leap_seconds = true;
  }

  void read_record(std::string_view line) {
    if (!old() && line.front() != 'G') {
      skip_record(line);
      return;
    }
    NavigationRecord record;
    const Epoch clock = clock_line(line, record.ephemeris);
    std::array<double, kOrbitNumbers> numbers{};
    for (std::size_t i = 0; i < kOrbitLines; ++i) {
      const std::string_view orbit = lines_.require("an orbit line of the last record");
      for (std::size_t k = 0; k < kPerLine; ++k) {
        const std::size_t index = i * kPerLine + k;
        const std::string_view text = columns(orbit, (old() ? 3U : 4U) + k * kNumber, kNumber);
        numbers[index] = may_be_blank(index) ? lines_.number_or(text, kOrbitNames[index], 0.0)
                                             : lines_.number(text, kOrbitNames[index]);
      }
    }
    fill(numbers, clock, record);
    file_.records.push_back(record);
  }

  void skip_record(std::string_view line) {
    constexpr std::string_view kSystems = "RESCJI";
    if (kSystems.find(line.front()) == std::string_view::npos) {
      lines_.fail("record begins with '" + std::string(trimmed(columns(line, 0, 3))) +
                  "', allowed are G and the systems " + std::string(kSystems));
    }
    std::size_t more = 0;
    for (; lines_.peek() == ' '; ++more) {
      static_cast<void>(lines_.require("an orbit line"));
    }
    if (more < 3) {
      static_cast<void>(lines_.require("an orbit line of the last record"));
      lines_.fail("expected an orbit line of the last record");
    }
    ++file_.skipped_records;
  }

  Epoch clock_line(std::string_view line, Ephemeris& ephemeris) {
    const std::size_t prn_at = old() ? 0 : 1;
    ephemeris.prn =
        static_cast<std::uint8_t>(lines_.integer(columns(line, prn_at, 2), "PRN", 1, 32));
    CalendarDate date;
    std::size_t at = prn_at + 2;
    const auto next = [&](std::size_t width) {
      at += width;
      return columns(line, at - width, width);
    };
    if (old()) {
      const std::int32_t year = lines_.integer(next(3), "year", 0, 99);
      date.year = year + (year < 80 ? 2000 : 1900);
    } else {
      date.year = lines_.integer(next(5), "year", 1980, 9999);
    }
    date.month = lines_.integer(next(3), "month", 1, 12);
    date.day = lines_.integer(next(3), "day", 1, 31);
    date.hour = lines_.integer(next(3), "hour", 0, 23);
    date.minute = lines_.integer(next(3), "minute", 0, 59);
    date.second = lines_.number(next(old() ? 5 : 3), "second");
    ephemeris.clock_bias_s = lines_.number(next(kNumber), "af0");
    ephemeris.clock_drift = lines_.number(next(kNumber), "af1");
    ephemeris.clock_drift_rate = lines_.number(next(kNumber), "af2");
    const Epoch clock = to_epoch(date, lines_);
    ephemeris.clock_time_s = clock.time_of_week_s;
    return clock;
  }

  std::int32_t whole(double value, std::size_t index, std::int32_t least, std::int32_t greatest) {
    if (!(value >= least && value <= greatest) || value != std::floor(value)) {
      lines_.fail(std::string(kOrbitNames[index]) + " is " + std::to_string(value) +
                  ", allowed are whole numbers from " + std::to_string(least) + " to " +
                  std::to_string(greatest));
    }
    return static_cast<std::int32_t>(value);
  }

  // `n` in the file's order: table A6.
  void fill(const std::array<double, kOrbitNumbers>& n, const Epoch& clock,
            NavigationRecord& record) {
    Ephemeris& e = record.ephemeris;
    e.issue_of_ephemeris = static_cast<std::uint8_t>(whole(n[0], 0, 0, 255));
    e.radius_sine_m = n[1];
    e.mean_motion_difference = n[2];
    e.mean_anomaly_rad = n[3];
    e.latitude_cosine_rad = n[4];
    e.eccentricity = n[5];
    e.latitude_sine_rad = n[6];
    e.sqrt_semi_major_axis = n[7];
    e.ephemeris_time_s = n[8];
    e.inclination_cosine_rad = n[9];
    e.ascending_node_rad = n[10];
    e.inclination_sine_rad = n[11];
    e.inclination_rad = n[12];
    e.radius_cosine_m = n[13];
    e.argument_of_perigee_rad = n[14];
    e.ascending_node_rate = n[15];
    e.inclination_rate = n[16];
    e.l2_code = static_cast<std::uint8_t>(whole(n[17], 17, 0, 3));
    e.l2_p_data_off = whole(n[19], 19, 0, 1) != 0;
    if (!(n[20] >= 0.0)) {
      lines_.fail("accuracy is " + std::to_string(n[20]) + " m, allowed is 0 or more");
    }
    e.accuracy_index = gps::accuracy_index(n[20]);
    e.health = static_cast<std::uint8_t>(whole(n[21], 21, 0, 63));
    e.group_delay_s = n[22];
    e.issue_of_clock = static_cast<std::uint16_t>(whole(n[23], 23, 0, 1023));
    record.transmission_time_s = n[24];
    // Hours since 2.10, the flag itself in older files; 0 = not known.
    e.long_fit = n[25] > 4.0 || n[25] == 1.0;
    if (!(e.ephemeris_time_s >= 0.0 && e.ephemeris_time_s < gps::kWeekSeconds)) {
      lines_.fail("toe is " + std::to_string(e.ephemeris_time_s) +
                  " s, allowed is 0 to less than 604800");
    }
    if (!(e.eccentricity >= 0.0 && e.eccentricity < 1.0)) {
      lines_.fail("e is " + std::to_string(e.eccentricity) + ", allowed is 0 to less than 1");
    }
    if (!(e.sqrt_semi_major_axis > 0.0)) {
      lines_.fail("sqrt A is " + std::to_string(e.sqrt_semi_major_axis) +
                  " sqrt(m), allowed is more than 0");
    }
    resolve_week(n[18], clock, e);
  }

  // The week belongs to toe. Files are about with weeks modulo 1024, but the epoch has its year.
  void resolve_week(double written, const Epoch& clock, Ephemeris& e) {
    const double ahead_s = e.ephemeris_time_s - clock.time_of_week_s;
    e.week = clock.week + (ahead_s > gps::kWeekSeconds / 2.0    ? -1
                           : ahead_s < -gps::kWeekSeconds / 2.0 ? 1
                                                                : 0);
    const std::int32_t week = whole(written, 18, 0, 99'999);
    if ((e.week - week) % 1024 != 0) {
      lines_.fail("week is " + std::to_string(week) + ", but toe lies in week " +
                  std::to_string(e.week) + " by the record's date");
    }
  }

  LineReader lines_;
  NavigationFile file_;
};

}  // namespace

NavigationFile read_navigation(std::string_view text, std::string_view name) {
  return Reader(text, name).read();
}

// Writing.

namespace {

/// Appends as std::printf would print; at most 255 characters.
[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
  char buffer[256];
  std::va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  if (length > 0) {
    out.append(buffer, static_cast<std::size_t>(length) < sizeof buffer
                           ? static_cast<std::size_t>(length)
                           : sizeof buffer - 1);
  }
}

/// Appends a header line: 60 columns of content, then its label.
void append_header(std::string& out, std::string_view content, std::string_view label) {
  content = content.substr(0, kLabelColumn);
  out.append(content).append(kLabelColumn - content.size(), ' ').append(label).append("\n");
}

/// `text` in exactly `width` columns, from the left.
std::string padded(std::string_view text, std::size_t width) {
  std::string result(text.substr(0, width));
  result.resize(width, ' ');
  return result;
}

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
