#include "protocols/nmea/pubx_sentences.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "protocols/nmea/fields.h"

namespace rigwire::protocols::nmea {
namespace {

constexpr int kLongestLock_s = 64;

std::string_view navigation_state(const Epoch& epoch) {
  if (!has_fix(epoch)) {
    return "NF";
  }
  if (epoch.dead_reckoning) {
    return "DR";
  }
  const bool corrected = epoch.differential || epoch.carrier != CarrierFix::none;
  return epoch.fix_dimensions == 3 ? (corrected ? "D3" : "G3") : (corrected ? "D2" : "G2");
}

}  // namespace

Sentence write_pubx_position(const Epoch& epoch) {
  Sentence sentence("PUBX");
  sentence.field("00");
  put_time(sentence, epoch.time);
  const bool fix = has_fix(epoch);
  Epoch shown;
  shown.precision = epoch.precision;
  if (fix) {
    shown = epoch;
  }
  put_coordinates(sentence, shown);
  sentence.number("%.3f", shown.altitude_m + shown.separation_m);
  sentence.field(navigation_state(epoch));
  put_deviation(sentence, epoch.horizontal_accuracy_m);
  put_deviation(sentence, epoch.vertical_accuracy_m);
  sentence.number("%.3f", shown.ground_speed_mps * kKnotsPerMps * kKilometresPerHourPerKnot);
  put_course(sentence, shown.course_deg.value_or(0.0));
  sentence.number("%.3f", shown.down_velocity_mps);
  fix&& epoch.differential_age_s ? sentence.number("%.1f", *epoch.differential_age_s)
                                 : sentence.empty();
  put_dilution(sentence, epoch.horizontal_dilution);
  put_dilution(sentence, epoch.vertical_dilution);
  put_dilution(sentence, epoch.time_dilution);
  sentence.number("%d", epoch.satellites_used).field("0");
  sentence.field(fix && epoch.dead_reckoning ? "1" : "0");
  return sentence;
}

Sentence write_pubx_satellites(const Epoch& epoch) {
  Sentence sentence("PUBX");
  sentence.field("03");
  const auto listed = epoch.satellites.first(
      std::min(epoch.satellites.size(), static_cast<std::size_t>(kMostPubxSatellites)));
  sentence.number("%02d", static_cast<int>(listed.size()));
  const auto optional = [&](const char* format, const std::optional<int>& value) {
    value ? sentence.number(format, *value) : sentence.empty();
  };
  for (const auto& satellite : listed) {
    sentence.number("%d", satellite.single_number);
    sentence.field(satellite.used ? "U" : satellite.ephemeris ? "e" : "-");
    optional("%03d", satellite.azimuth_deg);
    optional("%02d", satellite.elevation_deg);
    optional("%02d", satellite.cn0_dbhz);
    sentence.number("%03d", std::clamp(satellite.locked_s, 0, kLongestLock_s));
  }
  return sentence;
}

Sentence write_pubx_time(const Epoch& epoch, const PubxTime& time) {
  Sentence sentence("PUBX");
  sentence.field("04");
  put_time(sentence, epoch.time);
  put_date(sentence, epoch.date);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%lld.%02lld",
                static_cast<long long>(time.time_of_week_hundredths / 100),
                static_cast<long long>(time.time_of_week_hundredths % 100));
  sentence.field(text.data()).number("%d", time.week);
  std::snprintf(text.data(), text.size(), "%d%s", time.leap_seconds,
                time.leap_seconds_received ? "" : "D");
  sentence.field(text.data());
  sentence.number("%.0f", time.clock_bias_ns).number("%.3f", time.clock_drift_nsps);
  sentence.number("%02d", time.pulse_granularity_ns);
  return sentence;
}

}  // namespace rigwire::protocols::nmea
