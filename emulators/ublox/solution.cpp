#include "emulators/ublox/solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/wire_units.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr double kFrequencyAccuracy = 1e-9;
constexpr std::uint8_t kFlagDifferential = 0x02;

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

NavPvt pvt(const UbloxSolution& s) {
  NavPvt m;
  m.year = narrow<std::uint16_t>(s.utc.year);
  m.month = narrow<std::uint8_t>(s.utc.month);
  m.day = narrow<std::uint8_t>(s.utc.day);
  m.hour = narrow<std::uint8_t>(s.utc.hour);
  m.minute = narrow<std::uint8_t>(s.utc.minute);
  m.second = narrow<std::uint8_t>(s.utc.second);
  const bool resolved = s.date_known && s.time_known && s.leap_known;
  m.valid = static_cast<std::uint8_t>((s.date_known ? 1 : 0) | (s.time_known ? 2 : 0) |
                                      (resolved ? 4 : 0));
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  m.nanosecond = s.utc_rest_ns;
  m.fix_type = fix_type(s);
  m.flags = static_cast<std::uint8_t>((s.fix_ok ? kFlagFixOk : 0) |
                                      (s.differential ? kFlagDifferential : 0));
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
          static_cast<std::uint8_t>(s.differential ? 1 : 0),
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

template <class Message>
std::size_t put(Message message, std::uint32_t time_of_week_ms, std::span<std::uint8_t> out) {
  if constexpr (requires { message.time_of_week_ms; }) {
    message.time_of_week_ms = time_of_week_ms;
  }
  const auto frame = encode(message);
  std::ranges::copy(frame, out.begin());
  return frame.size();
}

}  // namespace

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
  if (const std::size_t size = encode_satellites(s, profile, id, out); size > 0) return size;
  if (id == NavAopstatus::kId) return put(NavAopstatus{}, tow, out);
  if (id == NavDop::kId) return put(dop(s), tow, out);
  if (id == NavTimegps::kId) return put(timegps(s), tow, out);
  if (id == NavTimeutc::kId) return put(timeutc(s), tow, out);
  if (id == NavClock::kId) return put(clock(s), tow, out);
  return 0;
}

}  // namespace rigwire::emulators
