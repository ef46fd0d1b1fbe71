#include "emulators/ublox/solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/ubx/configuration.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kHundredth_ns = 10 * kMillisecond_ns;
constexpr double kSemiMajorAxis_m = 6'378'137.0;  // WGS-84
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kFrequencyAccuracy = 1e-9;

/// Rounded and clamped to the field; not-a-number becomes zero.
template <class Integer>
Integer to_field(double value, double unit) {
  const double scaled = std::round(value / unit);
  if (std::isnan(scaled)) {
    return 0;
  }
  constexpr double kLeast = static_cast<double>(std::numeric_limits<Integer>::min());
  constexpr double kGreatest = static_cast<double>(std::numeric_limits<Integer>::max());
  return static_cast<Integer>(static_cast<std::int64_t>(std::clamp(scaled, kLeast, kGreatest)));
}

std::uint32_t unsigned_field(double value, double unit) {
  return to_field<std::uint32_t>(value, unit);
}
std::int32_t signed_field(double value, double unit) {
  return to_field<std::int32_t>(value, unit);
}

std::uint16_t dilution_field(double dilution) {
  return std::isnan(dilution) ? kNoDilution
                              : std::min(to_field<std::uint16_t>(dilution, 0.01), kNoDilution);
}

std::array<double, 3> ecef_position(const UbloxSolution& s) {
  const double sin_lat = std::sin(s.latitude_deg * kDegree);
  const double cos_lat = std::cos(s.latitude_deg * kDegree);
  const double sin_lon = std::sin(s.longitude_deg * kDegree);
  const double cos_lon = std::cos(s.longitude_deg * kDegree);
  const double e2 = kFlattening * (2.0 - kFlattening);
  const double normal_m = kSemiMajorAxis_m / std::sqrt(1.0 - e2 * sin_lat * sin_lat);
  const double h = s.ellipsoid_height_m;
  return {(normal_m + h) * cos_lat * cos_lon, (normal_m + h) * cos_lat * sin_lon,
          (normal_m * (1.0 - e2) + h) * sin_lat};
}

std::array<double, 3> ecef_velocity(const UbloxSolution& s) {
  const double sin_lat = std::sin(s.latitude_deg * kDegree);
  const double cos_lat = std::cos(s.latitude_deg * kDegree);
  const double sin_lon = std::sin(s.longitude_deg * kDegree);
  const double cos_lon = std::cos(s.longitude_deg * kDegree);
  const Vector3& v = s.velocity_ned_mps;
  return {-sin_lat * cos_lon * v.x - sin_lon * v.y - cos_lat * cos_lon * v.z,
          -sin_lat * sin_lon * v.x + cos_lon * v.y - cos_lat * sin_lon * v.z,
          cos_lat * v.x - sin_lat * v.z};
}

std::array<std::int32_t, 3> in_centimetres(const std::array<double, 3>& metres) {
  return {signed_field(metres[0], 0.01), signed_field(metres[1], 0.01),
          signed_field(metres[2], 0.01)};
}

double position_accuracy_m(const UbloxSolution& s) {
  return std::hypot(s.horizontal_accuracy_m, s.vertical_accuracy_m);
}
double ground_speed_mps(const UbloxSolution& s) {
  return std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y);
}
std::uint8_t fix_type(const UbloxSolution& s) {
  return s.dimensions == 3 ? kFix3d : s.dimensions == 2 ? kFix2d : kFixNone;
}
std::uint8_t fix_flags(const UbloxSolution& s) {
  return static_cast<std::uint8_t>((s.dimensions > 0 ? kFlagFixOk : 0) |
                                   (s.date_known ? kFlagWeekSet : 0) |
                                   (s.time_known ? kFlagTimeOfWeekSet : 0));
}
std::uint8_t time_valid(const UbloxSolution& s) {
  return static_cast<std::uint8_t>((s.time_known ? 1 : 0) | (s.date_known ? 2 : 0) |
                                   (s.date_known && s.orbits_known ? 4 : 0));
}
template <class Integer>
Integer narrow(int value) {
  return static_cast<Integer>(value);
}

NavPvt pvt(const UbloxSolution& s) {
  NavPvt m;
  m.year = narrow<std::uint16_t>(s.utc.year);
  m.month = narrow<std::uint8_t>(s.utc.month);
  m.day = narrow<std::uint8_t>(s.utc.day);
  m.hour = narrow<std::uint8_t>(s.utc.hour);
  m.minute = narrow<std::uint8_t>(s.utc.minute);
  m.second = narrow<std::uint8_t>(s.utc.second);
  const bool resolved = s.date_known && s.time_known && s.orbits_known;
  m.valid = static_cast<std::uint8_t>((s.date_known ? 1 : 0) | (s.time_known ? 2 : 0) |
                                      (resolved ? 4 : 0));
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  m.nanosecond = s.utc_rest_ns;
  m.fix_type = fix_type(s);
  m.flags = s.dimensions > 0 ? kFlagFixOk : 0;
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
  return {0,
          fix_type(s),
          static_cast<std::uint8_t>(profile.status_flags | fix_flags(s)),
          0,
          0,
          s.first_fix_ms,
          s.since_start_ms};
}

NavVelecef velecef(const UbloxSolution& s) {
  return {0, in_centimetres(ecef_velocity(s)), unsigned_field(s.speed_accuracy_mps, 0.01)};
}

NavVelned velned(const UbloxSolution& s) {
  const Vector3& v = s.velocity_ned_mps;
  return {0,
          in_centimetres({v.x, v.y, v.z}),
          unsigned_field(std::hypot(v.x, v.y, v.z), 0.01),
          unsigned_field(ground_speed_mps(s), 0.01),
          signed_field(s.heading_deg, 1e-5),
          unsigned_field(s.speed_accuracy_mps, 0.01),
          unsigned_field(s.heading_accuracy_deg, 1e-5)};
}

NavDop dop(const UbloxSolution& s) {
  const std::uint16_t axis = dilution_field(s.horizontal_dilution / std::numbers::sqrt2);
  return {0,
          dilution_field(std::hypot(s.position_dilution, s.time_dilution)),
          dilution_field(s.position_dilution),
          dilution_field(s.time_dilution),
          dilution_field(s.vertical_dilution),
          dilution_field(s.horizontal_dilution),
          axis,
          axis};
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

MonHw hardware() {
  MonHw m;
  m.noise_per_ms = 90;
  m.gain_control = 4000;
  m.antenna_status = 2;
  m.antenna_power = 1;
  m.flags = 0x01;
  return m;
}

template <class Message>
std::size_t put(Message message, std::uint32_t time_of_week_ms, std::span<std::uint8_t> out) {
  if constexpr (requires { message.time_of_week_ms; }) {
    message.time_of_week_ms = time_of_week_ms;
  }
  const auto frame = encode(message);
  std::ranges::copy(frame, out.begin());
  return frame.size();
}

std::size_t put_svinfo(const UbloxSolution& s, const UbloxProfile& profile,
                       std::span<std::uint8_t> out) {
  constexpr std::size_t kMaximumChannels = 32;
  const std::size_t channels = std::min(s.satellites.size(), kMaximumChannels);
  const std::span<std::uint8_t> payload = out.subspan(kHeaderBytes);
  write_payload(NavSvinfoHead{s.time_of_week_ms, static_cast<std::uint8_t>(channels),
                              profile.chip_generation},
                payload.first(NavSvinfoHead::kLength));
  std::size_t at = NavSvinfoHead::kLength;
  for (std::size_t i = 0; i < channels; ++i) {
    const SatelliteView& view = s.satellites[i];
    NavSvinfoChannel channel;
    channel.channel = static_cast<std::uint8_t>(i);
    channel.satellite = view.number;
    const bool used = view.used && s.dimensions > 0;
    channel.flags = static_cast<std::uint8_t>((used ? 0x01 : 0) | (s.orbits_known ? 0x0C : 0));
    channel.quality = used ? 7 : view.tracked ? 4 : 1;
    channel.cn0_dbhz = view.tracked ? to_field<std::uint8_t>(view.cn0_dbhz, 1.0) : std::uint8_t{0};
    if (s.orbits_known) {
      channel.elevation_deg = to_field<std::int8_t>(view.elevation_rad, kDegree);
      channel.azimuth_deg =
          static_cast<std::int16_t>(to_field<std::int16_t>(view.azimuth_rad, kDegree) % 360);
    }
    write_payload(channel, payload.subspan(at, NavSvinfoChannel::kLength));
    at += NavSvinfoChannel::kLength;
  }
  const std::size_t size = kOverheadBytes + at;
  seal_frame(NavSvinfoHead::kId, out.first(size));
  return size;
}

}  // namespace

void set_time(UbloxSolution& solution, const Calendar& calendar, SimTime epoch) {
  // Nearest millisecond and nearest hundredth, ties upward; both in GPS time, so that a leap second
  // is rounded like any other.
  const std::int64_t of_week = calendar.gps(epoch).time_of_week_ns;
  const auto above = [&](std::int64_t unit) {
    const std::int64_t over = of_week % unit;
    return over * 2 < unit ? over : over - unit;
  };
  const std::int64_t rest_ms = above(kMillisecond_ns);
  const GpsTime gps = calendar.gps(epoch - Duration{rest_ms});
  solution.leap_seconds = calendar.leap_seconds(epoch);
  if (solution.time_known) {
    solution.time_of_week_ms = static_cast<std::uint32_t>(gps.time_of_week_ns / kMillisecond_ns);
    solution.time_of_week_rest_ns = static_cast<std::int32_t>(rest_ms);
  } else {
    solution.time_of_week_ms = solution.since_start_ms;
    solution.time_of_week_rest_ns = 0;
  }
  solution.week = solution.date_known ? gps.week : 0;
  const std::int64_t rest_hundredth = above(kHundredth_ns);
  solution.utc = calendar.utc(epoch - Duration{rest_hundredth});
  solution.utc_rest_ns = static_cast<std::int32_t>(solution.utc.nanosecond + rest_hundredth);
}

std::size_t encode_solution(const UbloxSolution& s, const UbloxProfile& profile, MessageId id,
                            std::span<std::uint8_t> out) {
  const std::uint32_t tow = s.time_of_week_ms;
  if (id == NavPvt::kId) return put(pvt(s), tow, out);
  if (id == NavPosecef::kId) return put(posecef(s), tow, out);
  if (id == NavPosllh::kId) return put(posllh(s), tow, out);
  if (id == NavStatus::kId) return put(status(s, profile), tow, out);
  if (id == NavVelecef::kId) return put(velecef(s), tow, out);
  if (id == NavVelned::kId) return put(velned(s), tow, out);
  if (id == NavSol::kId) return put(sol(s, profile), tow, out);
  if (id == NavSvinfoHead::kId) return put_svinfo(s, profile, out);
  if (id == NavDop::kId) return put(dop(s), tow, out);
  if (id == NavTimegps::kId) return put(timegps(s), tow, out);
  if (id == NavTimeutc::kId) return put(timeutc(s), tow, out);
  if (id == NavClock::kId) return put(clock(s), tow, out);
  if (id == MonHw::kId) return put(hardware(), tow, out);
  return 0;
}

protocols::nmea::Epoch nmea_epoch(const UbloxSolution& s, std::string_view talker, bool with_mode,
                                  std::vector<protocols::nmea::SatelliteInView>& list) {
  protocols::nmea::Epoch epoch;
  epoch.talker = talker;
  epoch.with_mode = with_mode;
  if (s.time_known) {
    epoch.time = protocols::nmea::TimeOfDay{s.utc.hour, s.utc.minute, s.utc.second,
                                            static_cast<int>(s.utc.nanosecond / kHundredth_ns)};
  }
  if (s.date_known) {
    epoch.date = protocols::nmea::Date{s.utc.year, s.utc.month, s.utc.day};
  }
  epoch.fix_dimensions = s.dimensions;
  epoch.latitude_deg = s.latitude_deg;
  epoch.longitude_deg = s.longitude_deg;
  epoch.altitude_m = s.ellipsoid_height_m - s.geoid_separation_m;
  epoch.separation_m = s.geoid_separation_m;
  epoch.ground_speed_mps = ground_speed_mps(s);
  if (!s.heading_frozen) {
    epoch.course_deg = s.heading_deg;
  }
  epoch.satellites_used = s.satellites_used;
  const auto known = [](double dilution) {
    return std::isnan(dilution) ? std::nullopt : std::optional(dilution);
  };
  epoch.position_dilution = known(s.position_dilution);
  epoch.horizontal_dilution = known(s.horizontal_dilution);
  epoch.vertical_dilution = known(s.vertical_dilution);
  list.clear();
  for (const auto& view : s.satellites) {
    protocols::nmea::SatelliteInView satellite;
    satellite.number = view.number;
    if (s.orbits_known) {
      satellite.elevation_deg = to_field<int>(view.elevation_rad, kDegree);
      satellite.azimuth_deg = to_field<int>(view.azimuth_rad, kDegree) % 360;
    }
    if (view.tracked) {
      satellite.cn0_dbhz = to_field<int>(std::clamp(view.cn0_dbhz, 0.0, 99.0), 1.0);
    }
    if (satellite.elevation_deg || satellite.cn0_dbhz) {
      satellite.used = view.used && s.dimensions > 0;
      list.push_back(satellite);
    }
  }
  epoch.satellites = list;
  return epoch;
}

}  // namespace rigwire::emulators
