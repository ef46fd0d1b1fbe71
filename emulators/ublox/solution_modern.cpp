#include "emulators/ublox/solution_modern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/wire_units.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/navigation_precise.h"
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

}  // namespace

std::size_t encode_modern_solution(const UbloxSolution& s, const UbloxProfile& profile,
                                   MessageId id, std::span<std::uint8_t> out) {
  if (id == NavPvt92::kId) return put(pvt(s, profile, out), out);
  if (id == NavStatus::kId) return put(status(s, profile, out), out);
  if (id == NavSatHead::kId) return put_satellites(s, out);
  if (id == NavOrbHead::kId) return put_orbits(s, out);
  if (id == NavTimels::kId) return put(leap_seconds(s), out);
  if (id == NavEoe::kId) return put(NavEoe{s.time_of_week_ms}, out);
  if (id == NavCov::kId) return put(covariance(s), out);
  if (id == NavHpposllh::kId) return put(precise_geodetic(s), out);
  if (id == NavHpposecef::kId) return put(precise_earth_centred(s), out);
  return 0;
}

}  // namespace rigwire::emulators
