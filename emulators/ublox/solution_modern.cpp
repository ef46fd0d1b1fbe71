#include "emulators/ublox/solution_modern.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/wire_units.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/precise_position.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr double kDegree = std::numbers::pi / 180.0;
static_assert(frame_size<NavSatHead, NavSatBlock>(kMostSatellites) <= kLongestSolutionFrame);
constexpr std::int8_t kUnknownElevation = -91;

CarrierSolution carrier_of(const UbloxSolution& s, const UbloxProfile& profile) {
  return profile.carrier_solution && s.fix_ok ? s.carrier : CarrierSolution::none;
}

/// The carrier solution in the two upper bits of a flags byte.
std::uint8_t carrier_flags(CarrierSolution carrier) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(carrier) << 6U);
}

/// Classes of the age of the last correction in NAV-PVT: 0 none, 1 up to 1 s ... 12 over 120 s.
std::uint16_t correction_age_class(const UbloxSolution& s) {
  if (!s.differential_age_s) {
    return 0;
  }
  constexpr std::array<double, 11> kUpTo_s{1, 2, 5, 10, 15, 20, 30, 45, 60, 90, 120};
  const auto found = std::ranges::upper_bound(kUpTo_s, *s.differential_age_s);
  return static_cast<std::uint16_t>(1 + (found - kUpTo_s.begin()));
}

template <class Message>
std::size_t put(const Message& message, std::span<std::uint8_t> out) {
  const auto frame = encode(message);
  std::ranges::copy(frame, out.begin());
  return frame.size();
}

/// The message in the form of u-blox 7, to be extended.
template <class Message>
Message basic(const UbloxSolution& s, const UbloxProfile& profile, std::span<std::uint8_t> out) {
  static_cast<void>(encode_solution(s, profile, Message::kId, out));
  return read_payload<Message>(out.subspan(kHeaderBytes, Message::kLength));
}

NavPvt92 pvt(const UbloxSolution& s, const UbloxProfile& profile, std::span<std::uint8_t> out) {
  NavPvt92 m;
  static_cast<NavPvt&>(m) = basic<NavPvt>(s, profile, out);
  m.flags = static_cast<std::uint8_t>(m.flags | carrier_flags(carrier_of(s, profile)));
  m.flags2 = static_cast<std::uint8_t>(kPvtConfirmationAvailable |
                                       (s.date_known && s.leap_known ? kPvtConfirmedDate : 0) |
                                       (s.time_known && s.leap_known ? kPvtConfirmedTime : 0));
  if (profile.carrier_solution) {
    m.flags3 = static_cast<std::uint16_t>(correction_age_class(s) << kPvtCorrectionAgeShift);
  }
  if (s.dimensions == 0) {
    m.flags3 |= kPvtInvalidPosition;
  }
  return m;
}

NavStatus status(const UbloxSolution& s, const UbloxProfile& profile, std::span<std::uint8_t> out) {
  constexpr std::uint8_t kCorrectionsAvailable = 0x01;
  constexpr std::uint8_t kCarrierValid = 0x02;
  constexpr std::uint8_t kNoSpoofing = 0x08;
  NavStatus m = basic<NavStatus>(s, profile, out);
  const CarrierSolution carrier = carrier_of(s, profile);
  m.fix_status = static_cast<std::uint8_t>((s.differential ? kCorrectionsAvailable : 0) |
                                           (carrier != CarrierSolution::none ? kCarrierValid : 0));
  m.flags2 = static_cast<std::uint8_t>((s.fix_ok ? kNoSpoofing : 0) | carrier_flags(carrier));
  return m;
}

std::size_t put_satellites(const UbloxSolution& s, std::span<std::uint8_t> out) {
  std::array<NavSatBlock, kMostSatellites> blocks;
  const std::size_t count = std::min(s.satellites.size(), blocks.size());
  for (std::size_t i = 0; i < count; ++i) {
    const SatelliteView& view = s.satellites[i];
    NavSatBlock& block = blocks[i];
    block.system = static_cast<std::uint8_t>(view.system);
    block.satellite = view.number;
    block.cn0_dbhz = view.tracked ? to_field<std::uint8_t>(view.cn0_dbhz, 1.0) : std::uint8_t{0};
    block.elevation_deg = kUnknownElevation;
    if (s.orbits_known) {
      block.elevation_deg = to_field<std::int8_t>(view.elevation_rad, kDegree);
      block.azimuth_deg =
          static_cast<std::int16_t>(to_field<std::int16_t>(view.azimuth_rad, kDegree) % 360);
    }
    const bool used = view.used && s.dimensions > 0;
    block.residual_dm = used ? to_field<std::int16_t>(view.residual_m, 0.1) : std::int16_t{0};
    constexpr std::uint32_t kSearching = 1;
    constexpr std::uint32_t kCodeLocked = 4;
    constexpr std::uint32_t kCarrierLocked = 7;
    block.flags = used ? kCarrierLocked | kSatUsed : view.tracked ? kCodeLocked : kSearching;
    block.flags |= view.tracked ? kSatHealthy | kSatSmoothed : 0U;
    block.flags |=
        s.orbits_known ? kSatOrbitEphemeris | kSatEphemerisAvailable | kSatAlmanacAvailable : 0U;
    if (view.corrected && used) {
      block.flags |= kSatCorrected | kSatRangeCorrected;
      block.flags |= s.carrier == CarrierSolution::none
                         ? kSatSbasCorrections
                         : kSatRtcmCorrections | kSatCarrierCorrected | kSatDopplerCorrected;
    }
  }
  const NavSatHead head{s.time_of_week_ms, 1, static_cast<std::uint8_t>(count)};
  return encode_blocks(head, std::span<const NavSatBlock>(blocks).first(count), out);
}

std::size_t put_orbits(const UbloxSolution& s, std::span<std::uint8_t> out) {
  constexpr std::uint8_t kHealthy = 1;
  constexpr std::uint8_t kVisible = 3 << 2;    // above the elevation mask
  constexpr std::uint8_t kBroadcast = 1 << 5;  // where the orbit comes from
  constexpr std::uint8_t kTwoHours = 8;        // quarters of an hour
  constexpr std::uint8_t kFourWeeks = 28;      // days
  std::array<NavOrbBlock, kMostSatellites> blocks;
  const std::size_t count = std::min(s.satellites.size(), blocks.size());
  for (std::size_t i = 0; i < count; ++i) {
    const SatelliteView& view = s.satellites[i];
    blocks[i] = {static_cast<std::uint8_t>(view.system), view.number, kVisible, 0, 0, 0};
    if (s.orbits_known) {
      blocks[i].flags |= kHealthy;
      blocks[i].ephemeris = kBroadcast | kTwoHours;
      blocks[i].almanac = kBroadcast | kFourWeeks;
    }
  }
  const NavOrbHead head{s.time_of_week_ms, 1, static_cast<std::uint8_t>(count)};
  return encode_blocks(head, std::span<const NavOrbBlock>(blocks).first(count), out);
}

NavTimels leap_seconds(const UbloxSolution& s) {
  constexpr std::uint8_t kFromGps = 2;
  constexpr std::int64_t kDay_s = 86'400;
  constexpr std::int64_t kWeek_s = 7 * kDay_s;
  NavTimels m;
  m.time_of_week_ms = s.time_of_week_ms;
  m.source = s.leap_known ? kFromGps : std::uint8_t{0};
  m.leap_seconds = static_cast<std::int8_t>(s.leap_seconds);
  m.valid = s.leap_known ? 1 : 0;
  if (s.leap_known && s.date_known && s.sample != nullptr && s.sample->navigation) {
    const GpsUtcParameters& utc = s.sample->navigation->utc;
    const std::int64_t event_s = utc.leap_week * kWeek_s + utc.leap_day * kDay_s;
    const std::int64_t now_s = s.week * kWeek_s + s.time_of_week_ms / 1000;
    m.change_source = kFromGps;
    m.change = static_cast<std::int8_t>(utc.leap_seconds_future - utc.leap_seconds);
    // The second is put in by UTC, leap seconds behind GPS.
    m.time_to_change_s = static_cast<std::int32_t>(event_s + utc.leap_seconds - now_s);
    m.change_week = static_cast<std::uint16_t>(utc.leap_week);
    m.change_day = static_cast<std::uint16_t>(utc.leap_day);
    m.valid |= 2;
  }
  return m;
}

NavCov covariance(const UbloxSolution& s) {
  NavCov m;
  m.time_of_week_ms = s.time_of_week_ms;
  if (s.dimensions == 0) {
    return m;
  }
  m.position_valid = 1;
  m.velocity_valid = 1;
  std::ranges::transform(s.position_covariance_ned_m2, m.position_covariance_ned_m2.begin(),
                         [](double value) { return static_cast<float>(value); });
  // Velocity's covariance: the speed's variance evenly on three axes.
  const auto axis_m2ps2 = static_cast<float>(s.speed_accuracy_mps * s.speed_accuracy_mps / 3.0);
  m.velocity_covariance_ned_m2ps2 = {axis_m2ps2, 0, 0, axis_m2ps2, 0, axis_m2ps2};
  return m;
}

NavHpposllh precise_geodetic(const UbloxSolution& s) {
  const SplitAngle longitude = split_angle(s.longitude_deg);
  const SplitAngle latitude = split_angle(s.latitude_deg);
  const SplitHeight height = split_height(s.ellipsoid_height_m);
  const SplitHeight above_sea = split_height(s.ellipsoid_height_m - s.geoid_separation_m);
  NavHpposllh m;
  m.flags = s.dimensions == 0 ? 1 : 0;
  m.time_of_week_ms = s.time_of_week_ms;
  m.longitude_e7deg = longitude.e7deg;
  m.latitude_e7deg = latitude.e7deg;
  m.ellipsoid_height_mm = height.mm;
  m.mean_sea_level_height_mm = above_sea.mm;
  m.longitude_rest_e9deg = longitude.rest_e9deg;
  m.latitude_rest_e9deg = latitude.rest_e9deg;
  m.ellipsoid_height_rest_e4m = height.rest_e4m;
  m.mean_sea_level_height_rest_e4m = above_sea.rest_e4m;
  m.horizontal_accuracy_e4m = to_field<std::uint32_t>(s.horizontal_accuracy_m, 1e-4);
  m.vertical_accuracy_e4m = to_field<std::uint32_t>(s.vertical_accuracy_m, 1e-4);
  return m;
}

NavHpposecef precise_earth_centred(const UbloxSolution& s) {
  const std::array<double, 3> position_m = ecef_position(s);
  NavHpposecef m;
  m.time_of_week_ms = s.time_of_week_ms;
  for (std::size_t axis = 0; axis < position_m.size(); ++axis) {
    const SplitCoordinate part = split_coordinate(position_m[axis]);
    m.position_cm[axis] = part.cm;
    m.position_rest_e4m[axis] = part.rest_e4m;
  }
  m.flags = s.dimensions == 0 ? 1 : 0;
  m.position_accuracy_e4m =
      to_field<std::uint32_t>(std::hypot(s.horizontal_accuracy_m, s.vertical_accuracy_m), 1e-4);
  return m;
}

/// One signal for each satellite: the first band alone is simulated.
std::size_t put_signals(const UbloxSolution& s, std::span<std::uint8_t> out) {
  constexpr std::uint16_t kHealthy = 0x001;
  constexpr std::uint16_t kSmoothed = 0x004;
  constexpr std::uint16_t kRangeUsed = 0x008;
  constexpr std::uint16_t kCarrierUsed = 0x010;
  constexpr std::uint16_t kDopplerUsed = 0x020;
  constexpr std::uint16_t kRangeCorrected = 0x040;
  constexpr std::uint16_t kCarrierAndDopplerCorrected = 0x180;
  constexpr std::uint8_t kBySbas = 1;
  constexpr std::uint8_t kByRtcm3 = 4;
  constexpr std::uint8_t kKlobuchar = 1;
  constexpr std::uint8_t kSbasIonosphere = 2;
  // Channels of the slots, as GLONASS itself lists them; + 7 on the wire.
  constexpr std::array<int, 24> kChannels{1,  -4, 5, 6,  1, -4, 5, 6, -2, -7, 0, -1,
                                          -2, -7, 0, -1, 4, -3, 3, 2, 4,  -3, 3, 2};
  std::array<NavSigBlock, kMostSatellites> blocks;
  std::size_t count = 0;
  for (const SatelliteView& view : s.satellites) {
    if (count == blocks.size()) {
      break;
    }
    NavSigBlock& block = blocks[count++];
    block.system = static_cast<std::uint8_t>(view.system);
    block.satellite = view.number;
    if (view.system == GnssSystem::glonass && view.number >= 1 && view.number <= kChannels.size()) {
      block.frequency_slot = static_cast<std::uint8_t>(kChannels[view.number - 1U] + 7);
    }
    const bool used = view.used && s.dimensions > 0;
    const bool carrier = s.carrier != CarrierSolution::none;
    block.quality = used ? 7 : view.tracked ? 4 : 1;
    if (!view.tracked) {
      continue;
    }
    block.cn0_dbhz = to_field<std::uint8_t>(view.cn0_dbhz, 1.0);
    block.flags = kHealthy | kSmoothed;
    if (!used) {
      continue;
    }
    block.residual_dm = to_field<std::int16_t>(view.residual_m, 0.1);
    block.flags |= kRangeUsed | kDopplerUsed;
    block.ionosphere_model = kKlobuchar;
    if (carrier) {
      block.flags |= kCarrierUsed;
    }
    if (view.corrected) {
      block.flags |= kRangeCorrected;
      block.flags |= carrier ? kCarrierAndDopplerCorrected : std::uint16_t{0};
      block.correction_source = carrier ? kByRtcm3 : kBySbas;
      block.ionosphere_model = carrier ? std::uint8_t{0} : kSbasIonosphere;
    }
  }
  const NavSigHead head{s.time_of_week_ms, 0, static_cast<std::uint8_t>(count)};
  return encode_blocks(head, std::span<const NavSigBlock>(blocks).first(count), out);
}

/// Time of a system is known while one of its satellites is tracked, and the system is on.
bool hears(const UbloxSolution& s, GnssSystem system) {
  return s.time_known && std::ranges::any_of(s.satellites, [system](const SatelliteView& view) {
           return view.system == system && view.tracked;
         });
}

constexpr std::uint32_t kNoAccuracy_ns = 0xFFFF'FFFF;

/// Galileo's and BeiDou's time of week: GPS time less `behind_s`, weeks from `first_week` on.
template <class Message>
Message time_of_system(const UbloxSolution& s, GnssSystem system, std::int64_t behind_s,
                       std::int32_t first_week) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  constexpr std::int64_t kWeek_s = 604'800;
  Message m;
  m.time_of_week_ms = s.time_of_week_ms;
  m.time_accuracy_ns = kNoAccuracy_ns;
  if (!hears(s, system)) {
    return m;
  }
  const std::int64_t of_week_ns =
      std::int64_t{s.time_of_week_ms} * 1'000'000 + s.time_of_week_rest_ns;
  const std::int64_t rounded_s = (of_week_ns + kSecond_ns / 2) / kSecond_ns;
  m.system_time_of_week_rest_ns = static_cast<std::int32_t>(of_week_ns - rounded_s * kSecond_ns);
  const std::int64_t shown_s = rounded_s - behind_s;
  const std::int64_t weeks = shown_s < 0 ? -1 : shown_s / kWeek_s;
  m.system_time_of_week_s = static_cast<std::uint32_t>(shown_s - weeks * kWeek_s);
  m.leap_seconds = static_cast<std::int8_t>(s.leap_seconds - behind_s);
  m.valid = static_cast<std::uint8_t>(1U | (s.date_known ? 2U : 0U) |
                                      (s.date_known && s.leap_known ? 4U : 0U));
  if (s.date_known) {
    m.week = static_cast<std::int16_t>(s.week - first_week + weeks);
  }
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  return m;
}

/// GLONASS time is UTC and three hours; its days are counted in four years from 1996 on.
NavTimeglo glonass_time(const UbloxSolution& s) {
  constexpr std::int32_t kHalfSecond_ns = 500'000'000;
  constexpr std::int32_t kSecond_ns = 1'000'000'000;
  constexpr std::int64_t kDay_s = 86'400;
  constexpr std::int64_t kAhead_s = 3 * 3'600;
  constexpr std::int64_t kFourYears_days = 4 * 365 + 1;
  NavTimeglo m;
  m.time_of_week_ms = s.time_of_week_ms;
  m.time_accuracy_ns = kNoAccuracy_ns;
  if (!hears(s, GnssSystem::glonass)) {
    return m;
  }
  const bool up = s.utc_rest_ns >= kHalfSecond_ns;
  const std::int64_t of_day_s =
      s.utc.hour * 3'600 + s.utc.minute * 60 + s.utc.second + (up ? 1 : 0) + kAhead_s;
  m.time_of_day_s = static_cast<std::uint32_t>(of_day_s % kDay_s);
  m.time_of_day_rest_ns = s.utc_rest_ns - (up ? kSecond_ns : 0);
  m.valid = 1;
  if (s.date_known) {
    using namespace std::chrono;
    const sys_days today = year{s.utc.year} / month{static_cast<unsigned>(s.utc.month)} /
                           day{static_cast<unsigned>(s.utc.day)};
    const std::int64_t days =
        (today - sys_days{year{1996} / January / day{1}}).count() + of_day_s / kDay_s;
    m.four_years = static_cast<std::uint8_t>(days / kFourYears_days + 1);
    m.day = static_cast<std::uint16_t>(days % kFourYears_days + 1);
    m.valid |= 2U;
  }
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  return m;
}

NavOdo odometer(const UbloxSolution& s) {
  return {0, s.time_of_week_ms, unsigned_field(s.distance_m, 1.0),
          unsigned_field(s.total_distance_m, 1.0), unsigned_field(s.distance_accuracy_m, 1.0)};
}

/// Nothing is surveyed; the accuracy of a mean of nothing as the log has it.
NavSvin no_survey(const UbloxSolution& s) {
  constexpr std::uint32_t kNoMean_e4m = 948'683'264;
  NavSvin m;
  m.time_of_week_ms = s.time_of_week_ms;
  m.mean_accuracy_e4m = kNoMean_e4m;
  return m;
}

/// The corrections' own base is not part of the sample: no vector to it is known.
NavRelposned no_base(const UbloxSolution& s) {
  NavRelposned m;
  m.time_of_week_ms = s.time_of_week_ms;
  m.flags = (s.fix_ok ? kRelativeFixOk : 0U) | (s.differential ? kRelativeDifferential : 0U);
  return m;
}

}  // namespace

std::size_t encode_modern_solution(const UbloxSolution& s, const UbloxProfile& profile,
                                   MessageId id, std::span<std::uint8_t> out) {
  if (id == NavPvt92::kId) return put(pvt(s, profile, out), out);
  if (id == NavStatus::kId) return put(status(s, profile, out), out);
  if (id == NavSatHead::kId) return put_satellites(s, out);
  if (id == NavSigHead::kId) return put_signals(s, out);
  if (id == NavOrbHead::kId) return put_orbits(s, out);
  if (id == NavTimeglo::kId) return put(glonass_time(s), out);
  if (id == NavTimebds::kId) {
    constexpr std::int64_t kBehind_s = 14;
    constexpr std::int32_t kFirstWeek = 1356;
    return put(time_of_system<NavTimebds>(s, GnssSystem::beidou, kBehind_s, kFirstWeek), out);
  }
  if (id == NavTimegal::kId) {
    constexpr std::int32_t kFirstWeek = 1024;
    return put(time_of_system<NavTimegal>(s, GnssSystem::galileo, 0, kFirstWeek), out);
  }
  if (id == NavOdo::kId) return put(odometer(s), out);
  if (id == NavSvin::kId) return put(no_survey(s), out);
  if (id == NavRelposned::kId) return put(no_base(s), out);
  if (id == NavTimels::kId) return put(leap_seconds(s), out);
  if (id == NavEoe::kId) return put(NavEoe{s.time_of_week_ms}, out);
  if (id == NavCov::kId) return put(covariance(s), out);
  if (id == NavHpposllh::kId) return put(precise_geodetic(s), out);
  if (id == NavHpposecef::kId) return put(precise_earth_centred(s), out);
  return 0;
}

}  // namespace rigwire::emulators
