#include "emulators/starfire/receiver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "fields/constants.h"
#include "protocols/nmea/satellite_numbers.h"
#include "protocols/nmea/writers.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace nmea = protocols::nmea;

constexpr Duration kHundredth = 10ms;
// Below this speed the course says nothing and is left empty.
constexpr double kSlowest_mps = 0.1;
constexpr std::size_t kTransmitBytes = 4096;

constexpr std::array kStarfireQuantities{
    Quantity{"latitude", "deg", -90.0, 90.0, 1e-7 / 60.0},
    Quantity{"longitude", "deg", -180.0, 180.0, 1e-7 / 60.0},
    Quantity{"height above mean sea level", "m", -99'999.999, 99'999.999, 1e-3},
    Quantity{"dilution", "1", 0.0, 99.99, 0.01},
};

/// Nothing when version 4.0 has no number for it.
std::optional<nmea::SatelliteInView> in_view(const SatelliteView& view) {
  nmea::SatelliteInView satellite;
  satellite.system = static_cast<nmea::System>(view.system);
  const auto number = nmea::satellite_number(satellite.system, view.number, nmea::Version::v40,
                                             nmea::Numbering::strict);
  if (!number) {
    return std::nullopt;
  }
  satellite.number = *number;
  satellite.elevation_deg = static_cast<int>(std::lround(view.elevation_rad / kDegree));
  satellite.azimuth_deg = static_cast<int>(std::lround(view.azimuth_rad / kDegree)) % 360;
  if (view.tracked) {
    satellite.cn0_dbhz = static_cast<int>(std::lround(std::clamp(view.cn0_dbhz, 0.0, 99.0)));
  }
  satellite.used = view.used;
  return satellite;
}

std::optional<double> known(double dilution) {
  return std::isnan(dilution) ? std::nullopt : std::optional(dilution);
}

}  // namespace

StarFireReceiver::StarFireReceiver(const StarFireSettings& settings, const Calendar& calendar,
                                   ByteOutput& output)
    : settings_(checked(settings)),
      calendar_(calendar),
      transmitter_(output, kTransmitBytes, settings_.baud),
      supply_(settings_.supply),
      plan_{calendar.align_to_gps(kStart + settings_.supply.power_on + settings_.start_up,
                                  settings_.sentence_period),
            settings_.sentence_period} {}

double StarFireReceiver::nominal_rate_hz() const {
  return static_cast<double>(settings_.sentences.size()) / to_seconds(settings_.sentence_period);
}

std::span<const Quantity> StarFireReceiver::quantities() const {
  return kStarfireQuantities;
}

SimTime StarFireReceiver::next_event() const {
  return std::min(supply_.next_change(), next_work());
}

void StarFireReceiver::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    live_until(instant);
    supply_.change();
    ready_at_ = supply_.on() ? instant + settings_.start_up : kNever;
    publish_at_ = kNever;
    transmitter_.clear();
  }
  live_until(now);
}

void StarFireReceiver::live_until(SimTime now) {
  for (SimTime event = next_work(); event <= now; event = next_work()) {
    transmitter_.advance(event);
    if (publish_at_ <= event) {
      publish_at_ = kNever;
      publish(event);
    }
  }
}

void StarFireReceiver::receive(SimTime now, std::span<const std::uint8_t> bytes) {
  advance(now);
  received_.bytes += bytes.size();
}

void StarFireReceiver::update(const GnssSample& sample) {
  // What is measured at the very instant at which the supply goes is lost after it was taken.
  advance(sample.time - Duration{1});
  supply_.on() ? live_until(sample.time) : advance(sample.time);
  if (sample.time >= ready_at_) {
    sample_ = sample;
    publish_at_ = sample.time + settings_.latency;
  }
  advance(sample.time);
}

// Converts the sample: UTC rounded to hundredths of a second, altitude = ellipsoid height - geoid
// separation, course from the horizontal velocity unless it is below kSlowest_mps.
nmea::Epoch StarFireReceiver::epoch() {
  const GnssSample& s = sample_;
  nmea::Epoch e;
  e.talker = settings_.talker;
  e.version = nmea::Version::v40;
  e.precision = nmea::Precision::high;
  const UtcTime utc = calendar_.utc(s.time + kHundredth / 2);
  e.time = nmea::TimeOfDay{utc.hour, utc.minute, utc.second,
                           static_cast<int>(utc.nanosecond / kHundredth.count())};
  e.date = nmea::Date{utc.year, utc.month, utc.day};
  e.fix_dimensions = s.fix == GnssFix::three_d ? 3 : s.fix == GnssFix::two_d ? 2 : 0;
  e.differential = s.differential;
  e.differential_age_s = s.differential_age_s;
  e.carrier = static_cast<nmea::CarrierFix>(s.carrier);
  e.latitude_deg = s.latitude_deg;
  e.longitude_deg = s.longitude_deg;
  e.altitude_m = s.ellipsoid_height_m - s.geoid_separation_m;
  e.separation_m = s.geoid_separation_m;
  const Vector3& v = s.velocity_ned_mps;
  e.ground_speed_mps = std::hypot(v.x, v.y);
  if (e.ground_speed_mps >= kSlowest_mps) {
    const double course_deg = std::atan2(v.y, v.x) / kDegree;
    e.course_deg = course_deg < 0.0 ? course_deg + 360.0 : course_deg;
  }
  e.position_dilution = known(s.position_dilution);
  e.horizontal_dilution = known(s.horizontal_dilution);
  e.vertical_dilution = known(s.vertical_dilution);
  in_view_.clear();
  for (const SatelliteView& view : s.satellites) {
    if (const auto satellite = in_view(view)) {
      in_view_.push_back(*satellite);
      e.systems |= settings_.talker == "GN" ? nmea::system_bit(satellite->system) : 0U;
    }
    e.satellites_used += view.used && e.fix_dimensions > 0 ? 1 : 0;
  }
  e.satellites = in_view_;
  return e;
}

void StarFireReceiver::publish(SimTime now) {
  const nmea::Epoch present = epoch();
  const auto send = [&](nmea::Sentence sentence) { transmitter_.enqueue(now, sentence.bytes()); };
  for (const std::string& name : settings_.sentences) {
    if (name == "GGA") {
      send(nmea::write_gga(present));
    } else if (name == "RMC") {
      send(nmea::write_rmc(present));
    } else if (name == "VTG") {
      send(nmea::write_vtg(present));
    } else if (name == "ZDA") {
      send(nmea::write_zda(present));
    } else {
      for (int part = 1; part <= nmea::gsa_sentences(present); ++part) {
        send(nmea::write_gsa(present, part));
      }
    }
  }
}

}  // namespace rigwire::emulators
