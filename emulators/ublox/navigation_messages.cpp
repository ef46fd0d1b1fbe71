#include "emulators/ublox/navigation_messages.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/signals.h"
#include "emulators/ublox/wire_units.h"
#include "fields/constants.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/precise_position.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr double kFrequencyAccuracy = 1e-9;
constexpr std::size_t kMostSatellites = 64;
static_assert(frame_size<NavSatHead, NavSatBlock>(kMostSatellites) <= kLongestNavigationFrame);
constexpr std::size_t kMostSignals = 120;  // section 3.15.21
static_assert(frame_size<NavSigHead, NavSigBlock>(kMostSignals) <= kLongestNavigationFrame);

/// u-blox 8 and later say more than u-blox 7.
bool is_modern(const UbloxProfile& profile) {
  return profile.generation >= 8;
}

double position_accuracy_m(const UbloxSolution& s) {
  return std::hypot(s.horizontal_accuracy_m, s.vertical_accuracy_m);
}
double ground_speed_mps(const UbloxSolution& s) {
  return std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y);
}
std::uint8_t fix_type(const UbloxSolution& s) {
  constexpr std::uint8_t kTimeOnly = 5;
  return s.time_only         ? kTimeOnly
         : s.dimensions == 3 ? kFix3d
         : s.dimensions == 2 ? kFix2d
                             : kFixNone;
}
std::uint8_t fix_flags(const UbloxSolution& s) {
  return static_cast<std::uint8_t>(
      (s.fix_ok ? kFlagFixOk : 0) | (s.differential ? kFlagDifferential : 0) |
      (s.date_known ? kFlagWeekSet : 0) | (s.time_known ? kFlagTimeOfWeekSet : 0));
}
std::uint8_t time_valid(const UbloxSolution& s) {
  return static_cast<std::uint8_t>((s.time_known ? 1 : 0) | (s.date_known ? 2 : 0) |
                                   (s.date_known && s.leap_known ? 4 : 0));
}
template <class Integer>
Integer narrow(int value) {
  return static_cast<Integer>(value);
}

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

/// Converts a solution to the integer units of NAV-PVT; fields saturate at their limits.
NavPvt pvt(const UbloxSolution& s) {
  NavPvt m;
  m.year = narrow<std::uint16_t>(s.utc.year);
  m.month = narrow<std::uint8_t>(s.utc.month);
  m.day = narrow<std::uint8_t>(s.utc.day);
  m.hour = narrow<std::uint8_t>(s.utc.hour);
  m.minute = narrow<std::uint8_t>(s.utc.minute);
  m.second = narrow<std::uint8_t>(s.utc.second);
  const bool resolved = s.date_known && s.time_known && s.leap_known;
  m.valid = static_cast<std::uint8_t>((s.date_known ? kPvtValidDate : 0) |
                                      (s.time_known ? kPvtValidTime : 0) |
                                      (resolved ? kPvtFullyResolved : 0));
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  m.nanosecond = s.utc_rest_ns;
  m.fix_type = fix_type(s);
  m.flags = static_cast<std::uint8_t>((s.fix_ok ? kPvtFixOk : 0) |
                                      (s.differential ? kPvtDifferential : 0));
  m.satellites_used = narrow<std::uint8_t>(s.satellites_used);
  m.longitude_e7deg = signed_field(s.longitude_deg, 1e-7);
  m.latitude_e7deg = signed_field(s.latitude_deg, 1e-7);
  m.ellipsoid_height_mm = signed_field(s.ellipsoid_height_m, 1e-3);
  m.mean_sea_level_height_mm = signed_field(s.ellipsoid_height_m - s.geoid_separation_m, 1e-3);
  m.horizontal_accuracy_mm = unsigned_field(s.horizontal_accuracy_m, 1e-3);
  m.vertical_accuracy_mm = unsigned_field(s.vertical_accuracy_m, 1e-3);
  m.velocity_ned_mmps = {signed_field(s.velocity_ned_mps.x, 1e-3),
                         signed_field(s.velocity_ned_mps.y, 1e-3),
                         signed_field(s.velocity_ned_mps.z, 1e-3)};
  m.ground_speed_mmps = signed_field(ground_speed_mps(s), 1e-3);
  m.heading_e5deg = signed_field(s.heading_deg, 1e-5);
  m.speed_accuracy_mmps = unsigned_field(s.speed_accuracy_mps, 1e-3);
  m.heading_accuracy_e5deg = unsigned_field(s.heading_accuracy_deg, 1e-5);
  m.position_dilution_e2 = dilution_field(s.position_dilution);
  return m;
}

NavPvt92 longer_pvt(const UbloxSolution& s, const UbloxProfile& profile) {
  NavPvt92 m;
  static_cast<NavPvt&>(m) = pvt(s);
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

NavSol sol(const UbloxSolution& s, const UbloxProfile& profile) {
  NavSol m;
  m.time_of_week_rest_ns = s.time_of_week_rest_ns;
  m.week = narrow<std::int16_t>(s.week);
  m.fix_type = fix_type(s);
  m.flags = static_cast<std::uint8_t>(profile.status_flags | fix_flags(s));
  m.position_cm = in_centimetres(ecef_position(s));
  m.position_accuracy_cm = unsigned_field(position_accuracy_m(s), 0.01);
  m.velocity_cmps = in_centimetres(ecef_velocity(s));
  m.speed_accuracy_cmps = unsigned_field(s.speed_accuracy_mps, 0.01);
  m.position_dilution_e2 = dilution_field(s.position_dilution);
  m.satellites_used = narrow<std::uint8_t>(s.satellites_used);
  return m;
}

NavPosecef posecef(const UbloxSolution& s) {
  return {0, in_centimetres(ecef_position(s)), unsigned_field(position_accuracy_m(s), 0.01)};
}

NavPosllh posllh(const UbloxSolution& s) {
  const NavPvt m = pvt(s);
  return {0,
          m.longitude_e7deg,
          m.latitude_e7deg,
          m.ellipsoid_height_mm,
          m.mean_sea_level_height_mm,
          m.horizontal_accuracy_mm,
          m.vertical_accuracy_mm};
}

NavStatus status(const UbloxSolution& s, const UbloxProfile& profile) {
  constexpr std::uint8_t kCorrectionsAvailable = 0x01;
  constexpr std::uint8_t kCarrierValid = 0x02;
  constexpr unsigned kSpoofingBit = 3;
  const CarrierSolution carrier = carrier_of(s, profile);
  NavStatus m;
  m.fix_type = fix_type(s);
  m.flags = static_cast<std::uint8_t>(profile.status_flags | fix_flags(s));
  m.fix_status = static_cast<std::uint8_t>((s.differential ? kCorrectionsAvailable : 0) |
                                           (carrier != CarrierSolution::none ? kCarrierValid : 0));
  m.flags2 = static_cast<std::uint8_t>((is_modern(profile) ? s.spoofing << kSpoofingBit : 0) |
                                       carrier_flags(carrier));
  m.time_to_first_fix_ms = s.first_fix_ms;
  m.since_start_ms = s.since_start_ms;
  return m;
}

NavVelecef velecef(const UbloxSolution& s) {
  return {0, in_centimetres(ecef_velocity(s)), unsigned_field(s.speed_accuracy_mps, 0.01)};
}

NavVelned velned(const UbloxSolution& s) {
  const Vector3& v = s.velocity_ned_mps;
  return {0,
          in_centimetres({v.x, v.y, v.z}),
          unsigned_field(s.speed_mps, 0.01),
          unsigned_field(ground_speed_mps(s), 0.01),
          signed_field(s.heading_deg, 1e-5),
          unsigned_field(s.speed_accuracy_mps, 0.01),
          unsigned_field(s.heading_accuracy_deg, 1e-5)};
}

NavDop dop(const UbloxSolution& s) {
  // Without axes of its own the model's horizontal dilution is shared evenly.
  const double axis = s.horizontal_dilution / std::numbers::sqrt2;
  const bool own = !std::isnan(s.north_dilution) && !std::isnan(s.east_dilution);
  return {0,
          dilution_field(std::hypot(s.position_dilution, s.time_dilution)),
          dilution_field(s.position_dilution),
          dilution_field(s.time_dilution),
          dilution_field(s.vertical_dilution),
          dilution_field(s.horizontal_dilution),
          dilution_field(own ? s.north_dilution : axis),
          dilution_field(own ? s.east_dilution : axis)};
}

NavTimegps timegps(const UbloxSolution& s) {
  return {0,
          s.time_of_week_rest_ns,
          narrow<std::int16_t>(s.week),
          narrow<std::int8_t>(s.leap_seconds),
          time_valid(s),
          unsigned_field(s.time_accuracy_s, 1e-9)};
}

NavTimeutc timeutc(const UbloxSolution& s) {
  const NavPvt m = pvt(s);
  return {0,      m.time_accuracy_ns, m.nanosecond, m.year,       m.month, m.day,
          m.hour, m.minute,           m.second,     time_valid(s)};
}

NavClock clock(const UbloxSolution& s) {
  return {0, signed_field(s.clock_bias_s, 1e-9), signed_field(s.clock_drift, 1e-9),
          unsigned_field(s.time_accuracy_s, 1e-9), unsigned_field(kFrequencyAccuracy, 1e-12)};
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
  Message m;
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
  m.valid = time_valid(s);
  if (s.date_known) {
    m.week = static_cast<std::int16_t>(s.week - first_week + weeks);
  }
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  return m;
}

/// GLONASS time is UTC and three hours; its days are counted in four years from 1996 on.
NavTimeglo glonass_time(const UbloxSolution& s) {
  constexpr std::int64_t kAhead_s = 3 * 3'600;
  constexpr std::int64_t kFourYears_days = 4 * 365 + 1;
  NavTimeglo m;
  m.time_accuracy_ns = kNoAccuracy_ns;
  if (!hears(s, GnssSystem::glonass)) {
    return m;
  }
  const bool up = s.utc_rest_ns >= kSecond_ns / 2;
  const std::int64_t of_day_s =
      s.utc.hour * 3'600 + s.utc.minute * 60 + s.utc.second + (up ? 1 : 0) + kAhead_s;
  m.time_of_day_s = static_cast<std::uint32_t>(of_day_s % kDay_s);
  m.time_of_day_rest_ns = static_cast<std::int32_t>(s.utc_rest_ns - (up ? kSecond_ns : 0));
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

NavTimels leap_seconds(const UbloxSolution& s) {
  constexpr std::uint8_t kFromGps = 2;
  NavTimels m;
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
  m.longitude_e7deg = longitude.e7deg;
  m.latitude_e7deg = latitude.e7deg;
  m.ellipsoid_height_mm = height.mm;
  m.mean_sea_level_height_mm = above_sea.mm;
  m.longitude_rest_e9deg = longitude.rest_e9deg;
  m.latitude_rest_e9deg = latitude.rest_e9deg;
  m.ellipsoid_height_rest_e4m = height.rest_e4m;
  m.mean_sea_level_height_rest_e4m = above_sea.rest_e4m;
  m.horizontal_accuracy_e4m = unsigned_field(s.horizontal_accuracy_m, 1e-4);
  m.vertical_accuracy_e4m = unsigned_field(s.vertical_accuracy_m, 1e-4);
  return m;
}

NavHpposecef precise_earth_centred(const UbloxSolution& s) {
  const std::array<double, 3> position_m = ecef_position(s);
  NavHpposecef m;
  for (std::size_t axis = 0; axis < position_m.size(); ++axis) {
    const SplitCoordinate part = split_coordinate(position_m[axis]);
    m.position_cm[axis] = part.cm;
    m.position_rest_e4m[axis] = part.rest_e4m;
  }
  m.flags = s.dimensions == 0 ? 1 : 0;
  m.position_accuracy_e4m = unsigned_field(position_accuracy_m(s), 1e-4);
  return m;
}

NavOdo odometer(const UbloxSolution& s) {
  return {0, s.time_of_week_ms, unsigned_field(s.distance_m, 1.0),
          unsigned_field(s.total_distance_m, 1.0), unsigned_field(s.distance_accuracy_m, 1.0)};
}

/// Parts of 0.1 mm beyond whole centimetres.
struct Centimetres {
  std::int32_t whole = 0;
  std::int8_t rest_e4m = 0;
};
Centimetres in_centimetres_and_rest(double metres) {
  constexpr int kPerCentimetre = 100;
  const auto count = static_cast<std::int64_t>(std::llround(metres * 1e4));
  return {static_cast<std::int32_t>(count / kPerCentimetre),
          static_cast<std::int8_t>(count % kPerCentimetre)};
}

NavSvin survey(const UbloxSolution& s) {
  // The accuracy of a mean of nothing, as a ZED-F9P of HPG 1.32 has it.
  constexpr std::uint32_t kNoMean_e4m = 948'683'264;
  NavSvin m;
  m.duration_s = s.survey.duration_s;
  m.observations = s.survey.observations;
  m.valid = s.survey.valid ? 1 : 0;
  m.active = s.survey.active ? 1 : 0;
  m.mean_accuracy_e4m =
      s.survey.observations == 0 ? kNoMean_e4m : unsigned_field(s.survey.accuracy_m, 1e-4);
  for (std::size_t axis = 0; axis < m.mean_cm.size(); ++axis) {
    const Centimetres mean = in_centimetres_and_rest(s.survey.mean_E_m[axis]);
    m.mean_cm[axis] = mean.whole;
    m.mean_rest_e4m[axis] = mean.rest_e4m;
  }
  return m;
}

/// From the base station, while there is a carrier solution.
NavRelposned relative_position(const UbloxSolution& s) {
  NavRelposned m;
  m.flags = (s.fix_ok ? kRelativeFixOk : 0U) | (s.differential ? kRelativeDifferential : 0U);
  if (!s.base || !s.fix_ok || s.carrier == CarrierSolution::none || s.sample == nullptr) {
    return m;
  }
  m.station = s.base->station;
  const auto base_E_m = s.base->at(s.sample->time);
  const auto own_E_m = ecef_position(s);
  const auto ned_m = ned_from_ecef(
      s, {own_E_m[0] - base_E_m[0], own_E_m[1] - base_E_m[1], own_E_m[2] - base_E_m[2]});
  const bool fixed = s.carrier == CarrierSolution::fixed;
  m.flags |= kRelativeValid | (fixed ? kRelativeCarrierFixed : kRelativeCarrierFloat) |
             (s.base->moving ? kRelativeMovingBase : 0U);
  for (std::size_t axis = 0; axis < ned_m.size(); ++axis) {
    const Centimetres part = in_centimetres_and_rest(ned_m[axis]);
    m.relative_ned_cm[axis] = part.whole;
    m.relative_ned_rest_e4m[axis] = part.rest_e4m;
  }
  const double length_m = std::hypot(ned_m[0], ned_m[1], ned_m[2]);
  const Centimetres length = in_centimetres_and_rest(length_m);
  m.length_cm = length.whole;
  m.length_rest_e4m = length.rest_e4m;
  const double level_m = s.horizontal_accuracy_m / std::numbers::sqrt2;
  m.accuracy_ned_e4m = {unsigned_field(level_m, 1e-4), unsigned_field(level_m, 1e-4),
                        unsigned_field(s.vertical_accuracy_m, 1e-4)};
  m.length_accuracy_e4m = unsigned_field(level_m, 1e-4);
  // A heading needs integers, and a base line that is long against the error.
  const double across_m = std::hypot(ned_m[0], ned_m[1]);
  if (fixed && across_m > level_m) {
    const double heading_deg = std::atan2(ned_m[1], ned_m[0]) / kDegree;
    m.heading_e5deg = signed_field(heading_deg < 0.0 ? heading_deg + 360.0 : heading_deg, 1e-5);
    m.heading_accuracy_e5deg = unsigned_field(std::atan2(level_m, across_m) / kDegree, 1e-5);
    m.flags |= kRelativeHeadingValid;
  }
  return m;
}

// Messages that list satellites.

std::uint8_t listed(const UbloxSolution& s) {
  return static_cast<std::uint8_t>(std::min(s.satellites.size(), kMostSatellites));
}

/// The head and a block for each of the satellites that it counts.
template <class Head, class Block>
std::size_t put_blocks(const UbloxSolution& s, const Head& head,
                       Block (*block_of)(const UbloxSolution&, const SatelliteView&),
                       std::span<std::uint8_t> out) {
  std::array<Block, kMostSatellites> blocks;
  for (std::size_t i = 0; i < head.block_count(); ++i) {
    blocks[i] = block_of(s, s.satellites[i]);
  }
  return encode_blocks(head, std::span<const Block>(blocks).first(head.block_count()), out);
}

bool is_used(const UbloxSolution& s, const SatelliteView& view) {
  return view.used && s.dimensions > 0;
}
std::uint8_t cn0_field(const SatelliteView& view) {
  return view.tracked ? to_field<std::uint8_t>(view.cn0_dbhz, 1.0) : std::uint8_t{0};
}
std::int8_t elevation_field(const SatelliteView& view) {
  return to_field<std::int8_t>(view.elevation_rad, kDegree);
}
std::int16_t azimuth_field(const SatelliteView& view) {
  return static_cast<std::int16_t>(to_field<std::int16_t>(view.azimuth_rad, kDegree) % 360);
}
/// 1 searching, 4 code locked, 7 all locked and used.
std::uint8_t quality_of(const UbloxSolution& s, const SatelliteView& view) {
  return is_used(s, view) ? 7 : view.tracked ? 4 : 1;
}

NavSatBlock satellite(const UbloxSolution& s, const SatelliteView& view) {
  constexpr std::int8_t kUnknownElevation = -91;
  NavSatBlock block;
  block.system = static_cast<std::uint8_t>(view.system);
  block.satellite = view.number;
  block.cn0_dbhz = cn0_field(view);
  block.elevation_deg = s.orbits_known ? elevation_field(view) : kUnknownElevation;
  block.azimuth_deg = s.orbits_known ? azimuth_field(view) : std::int16_t{0};
  const bool used = is_used(s, view);
  block.residual_dm = used ? to_field<std::int16_t>(view.residual_m, 0.1) : std::int16_t{0};
  block.flags = std::uint32_t{quality_of(s, view)} | (used ? kSatUsed : 0U);
  block.flags |= view.tracked ? kSatHealthy | kSatSmoothed : 0U;
  block.flags |=
      s.orbits_known ? kSatOrbitEphemeris | kSatEphemerisAvailable | kSatAlmanacAvailable : 0U;
  if (view.corrected && used) {
    block.flags |= kSatCorrected | kSatRangeCorrected;
    block.flags |= s.carrier == CarrierSolution::none
                       ? kSatSbasCorrections
                       : kSatRtcmCorrections | kSatCarrierCorrected | kSatDopplerCorrected;
  }
  return block;
}

NavOrbBlock orbit(const UbloxSolution& s, const SatelliteView& view) {
  constexpr std::uint8_t kHealthy = 1;
  constexpr std::uint8_t kVisible = 3 << 2;    // above the elevation mask
  constexpr std::uint8_t kBroadcast = 1 << 5;  // where the orbit comes from
  constexpr std::uint8_t kTwoHours = 8;        // quarters of an hour
  constexpr std::uint8_t kFourWeeks = 28;      // days
  NavOrbBlock block{static_cast<std::uint8_t>(view.system), view.number, kVisible, 0, 0, 0};
  if (s.orbits_known) {
    block.flags |= kHealthy;
    block.ephemeris = kBroadcast | kTwoHours;
    block.almanac = kBroadcast | kFourWeeks;
  }
  return block;
}

/// One signal for each satellite: the first band alone is simulated.
NavSigBlock signal_of(const UbloxSolution& s, const SatelliteView& view) {
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
  NavSigBlock block;
  block.system = static_cast<std::uint8_t>(view.system);
  block.satellite = view.number;
  block.frequency_slot = ublox_frequency(view.system, view.number);
  const bool carrier = s.carrier != CarrierSolution::none;
  block.quality = quality_of(s, view);
  block.cn0_dbhz = cn0_field(view);
  if (view.tracked) {
    block.flags = kHealthy | kSmoothed;
  }
  if (!view.tracked || !is_used(s, view)) {
    return block;
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
  return block;
}

/// The second signal of a satellite whose first one is `block`: the fix goes by the first alone,
/// a carrier solution by both.
NavSigBlock second_signal_of(const UbloxSolution& s, NavSigBlock block, const GnssMeasurement& m) {
  constexpr std::uint16_t kFirstAlone = 0x008 | 0x020 | 0x040;  // range, Doppler used; corrected
  constexpr std::uint16_t kCarrier = 0x010 | 0x180;
  const bool carrier = s.carrier != CarrierSolution::none;
  block.signal = ublox_signal(m.system, true);
  block.cn0_dbhz = to_field<std::uint8_t>(m.cn0_dbhz, 1.0);
  block.residual_dm = 0;
  block.flags &= static_cast<std::uint16_t>(~(carrier ? kFirstAlone : kFirstAlone | kCarrier));
  return block;
}

std::size_t put_signals(const UbloxSolution& s, std::uint32_t time_of_week_ms,
                        std::span<std::uint8_t> out) {
  std::array<NavSigBlock, kMostSignals> blocks;
  std::size_t count = 0;
  for (std::size_t i = 0; i < listed(s) && count < blocks.size(); ++i) {
    const SatelliteView& view = s.satellites[i];
    blocks[count++] = signal_of(s, view);
    if (s.sample == nullptr || !view.tracked || count == blocks.size()) {
      continue;
    }
    const auto second = std::ranges::find_if(s.sample->measurements, [&](const GnssMeasurement& m) {
      return m.second && m.system == view.system && m.number == view.number;
    });
    if (second != s.sample->measurements.end()) {
      blocks[count] = second_signal_of(s, blocks[count - 1], *second);
      ++count;
    }
  }
  return encode_blocks(NavSigHead{time_of_week_ms, 0, static_cast<std::uint8_t>(count)},
                       std::span<const NavSigBlock>(blocks).first(count), out);
}

/// Numbers of the older messages: SBAS 120..158 as they are, GLONASS from 65, QZSS from 193.
std::uint8_t single_number(const SatelliteView& view) {
  switch (view.system) {
    case GnssSystem::glonass:
      return static_cast<std::uint8_t>(64 + view.number);
    case GnssSystem::qzss:
      return static_cast<std::uint8_t>(192 + view.number);
    case GnssSystem::galileo:
      return static_cast<std::uint8_t>(210 + view.number);
    case GnssSystem::beidou:
      return static_cast<std::uint8_t>(view.number <= 5 ? 158 + view.number : 27 + view.number);
    case GnssSystem::imes:
      return static_cast<std::uint8_t>(172 + view.number);
    default:
      return view.number;
  }
}

NavSvinfoChannel channel_of(const UbloxSolution& s, const SatelliteView& view) {
  constexpr std::uint8_t kNoChannel = 255;
  NavSvinfoChannel channel;
  channel.channel =
      view.tracked ? static_cast<std::uint8_t>(&view - s.satellites.data()) : kNoChannel;
  channel.satellite = single_number(view);
  const bool used = is_used(s, view);
  channel.flags =
      static_cast<std::uint8_t>((used ? 0x01 : 0) | (view.corrected && s.differential ? 0x02 : 0) |
                                (s.orbits_known ? 0x0C : 0));
  channel.quality = quality_of(s, view);
  channel.cn0_dbhz = cn0_field(view);
  if (s.orbits_known) {
    channel.elevation_deg = elevation_field(view);
    channel.azimuth_deg = azimuth_field(view);
  }
  channel.residual_cm = used ? signed_field(view.residual_m, 0.01) : 0;
  return channel;
}

/// Corrections from RTCM; SBAS has its own message. Without them the head alone.
std::size_t put_dgps(const UbloxSolution& s, std::span<std::uint8_t> out) {
  NavDgpsHead head;
  head.time_of_week_ms = s.time_of_week_ms;
  return encode_blocks<NavDgpsHead, NavDgpsBlock>(head, {}, out);
}

/// 0 WAAS, 1 EGNOS, 2 MSAS, 3 GAGAN, -1 unknown, by PRN: R28 section 32.17.16 and appendix A.
std::int8_t sbas_system(std::uint8_t prn) {
  switch (prn) {
    case 122:
    case 131:
    case 133:
    case 134:
    case 135:
    case 138:
      return 0;
    case 120:
    case 121:
    case 123:
    case 124:
    case 126:
    case 136:
      return 1;
    case 129:
    case 137:
      return 2;
    case 127:
    case 128:
    case 132:
      return 3;
    default:
      return -1;
  }
}

std::size_t put_sbas(const UbloxSolution& s, std::span<std::uint8_t> out) {
  constexpr std::uint8_t kRangingAndCorrections = 0x03;
  std::array<NavSbasBlock, kMostSatellites> blocks{};
  NavSbasHead head;
  head.time_of_week_ms = s.time_of_week_ms;
  std::size_t count = 0;
  for (const auto& view : s.satellites) {
    const bool sbas = view.system == GnssSystem::sbas;
    if (sbas && view.tracked && head.geostationary == 0 && s.differential) {
      head.geostationary = view.number;
      head.system = sbas_system(view.number);
      head.services = kRangingAndCorrections;
      head.mode = 1;
    }
    if (count < blocks.size() && (sbas ? view.tracked : view.corrected && s.differential)) {
      NavSbasBlock& block = blocks[count++];
      block.satellite = single_number(view);
      constexpr std::int8_t kGps = 16;
      block.system = sbas ? sbas_system(view.number) : kGps;
      block.services = sbas ? kRangingAndCorrections : std::uint8_t{0};
    }
  }
  head.satellites = static_cast<std::uint8_t>(count);
  return encode_blocks<NavSbasHead, NavSbasBlock>(head, std::span(blocks).first(count), out);
}

template <class Message>
std::size_t put(Message message, const UbloxSolution& s, std::span<std::uint8_t> out) {
  message.time_of_week_ms = s.time_of_week_ms;
  return encode(message, out);
}

}  // namespace

std::size_t encode_navigation(const UbloxSolution& s, const UbloxProfile& profile, MessageId id,
                              std::span<std::uint8_t> out) {
  const std::uint32_t tow = s.time_of_week_ms;
  if (id == NavPvt::kId) {
    return is_modern(profile) ? put(longer_pvt(s, profile), s, out) : put(pvt(s), s, out);
  }
  if (id == NavPosecef::kId) return put(posecef(s), s, out);
  if (id == NavPosllh::kId) return put(posllh(s), s, out);
  if (id == NavHpposllh::kId) return put(precise_geodetic(s), s, out);
  if (id == NavHpposecef::kId) return put(precise_earth_centred(s), s, out);
  if (id == NavStatus::kId) return put(status(s, profile), s, out);
  if (id == NavVelecef::kId) return put(velecef(s), s, out);
  if (id == NavVelned::kId) return put(velned(s), s, out);
  if (id == NavSol::kId) return put(sol(s, profile), s, out);
  if (id == NavDop::kId) return put(dop(s), s, out);
  if (id == NavCov::kId) return put(covariance(s), s, out);
  if (id == NavOdo::kId) return put(odometer(s), s, out);
  if (id == NavSvin::kId) return put(survey(s), s, out);
  if (id == NavRelposned::kId) return put(relative_position(s), s, out);
  if (id == NavAopstatus::kId) return put(NavAopstatus{}, s, out);
  if (id == NavEoe::kId) return put(NavEoe{}, s, out);
  if (id == NavTimegps::kId) return put(timegps(s), s, out);
  if (id == NavTimeutc::kId) return put(timeutc(s), s, out);
  if (id == NavTimeglo::kId) return put(glonass_time(s), s, out);
  if (id == NavTimebds::kId) {
    constexpr std::int64_t kBehind_s = 14;
    constexpr std::int32_t kFirstWeek = 1356;
    return put(time_of_system<NavTimebds>(s, GnssSystem::beidou, kBehind_s, kFirstWeek), s, out);
  }
  if (id == NavTimegal::kId) {
    constexpr std::int32_t kFirstWeek = 1024;
    return put(time_of_system<NavTimegal>(s, GnssSystem::galileo, 0, kFirstWeek), s, out);
  }
  if (id == NavTimels::kId) return put(leap_seconds(s), s, out);
  if (id == NavClock::kId) return put(clock(s), s, out);
  if (id == NavSatHead::kId) return put_blocks(s, NavSatHead{tow, 1, listed(s)}, satellite, out);
  if (id == NavOrbHead::kId) return put_blocks(s, NavOrbHead{tow, 1, listed(s)}, orbit, out);
  if (id == NavSigHead::kId) return put_signals(s, tow, out);
  if (id == NavSvinfoHead::kId) {
    const NavSvinfoHead head{tow, listed(s), profile.chip_generation};
    return put_blocks(s, head, channel_of, out);
  }
  if (id == NavDgpsHead::kId) return put_dgps(s, out);
  if (id == NavSbasHead::kId) return put_sbas(s, out);
  return 0;
}

}  // namespace rigwire::emulators
