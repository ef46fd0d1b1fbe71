#include "sim/gnss/nominal_slots.h"

#include <array>
#include <cmath>
#include <numbers>

#include "fields/constants.h"
#include "sim/gnss/ephemeris.h"

namespace rigwire::sim {
namespace {

constexpr std::int32_t kEpochWeek = kNominalEpochWeek;
constexpr auto kEpochOfWeek_s = static_cast<double>(kNominalEpochOfWeek_s);
// Right ascension of Greenwich at the epoch: 18 h 36 m 14.4 s.
constexpr double kGreenwichAtEpoch_rad = (18.0 + 36.0 / 60.0 + 14.4 / 3600.0) * 15.0 * kDegree;

constexpr std::array kGpsNode_deg{272.847, 332.847, 32.847, 92.847, 152.847, 212.847};
constexpr std::array<double, kGpsSlots> kGpsArgumentOfLatitude_deg{
    268.126, 161.786, 11.676,  41.806,   // A
    80.956,  173.336, 309.976, 204.376,  // B
    111.876, 11.796,  339.666, 241.556,  // C
    135.226, 265.446, 35.156,  167.356,  // D
    197.046, 302.596, 66.066,  333.686,  // E
    238.886, 345.226, 105.206, 135.346,  // F
};

constexpr std::int64_t kInterval_s = 7'200;
constexpr std::int64_t kIntervalsPerWeek = 84;

// Steps of the message: angles 2^-31, rates 2^-43 semicircles, bias 2^-31 s, drift 2^-43 s/s. Two
// hours of one step of a rate are 7200 / 4096 = 225 / 128 steps of what it drives.
const double kAngleStep_rad = std::ldexp(kSemicircle_rad, -31);
const double kRateStep_radps = std::ldexp(kSemicircle_rad, -43);
constexpr std::int64_t kWholeRate = 128;
constexpr std::int64_t kWholeChange = 225;

constexpr std::int64_t kNodeRateTurns = -175;  // of kWholeRate steps: -8.0003e-9 rad/s
constexpr std::int64_t kClockTurnIntervals = 13 * kIntervalsPerWeek;

/// How a satellite's mean motion is stated: axis in steps of 2^-19 sqrt(m), delta n in steps of a
/// rate. Among all pairs whose motion is one ground track a day within 5e-5 deg/day, those whose
/// two hours are a whole number of angle steps within 3e-5 of a step (1.2e-6 m).
struct StatedMotion {
  std::int64_t root_axis_steps;
  std::int64_t difference_steps;
};
constexpr std::array<StatedMotion, kGpsSlots> kGpsMotion{{
    {2'702'005'870, 10'717}, {2'702'008'552, 11'945},
    {2'702'011'181, 13'141}, {2'702'005'209, 10'419},  // A
    {2'702'006'813, 11'144}, {2'702'010'317, 12'710},
    {2'702'012'577, 13'733}, {2'702'006'202, 10'859},  // B
    {2'702'008'665, 11'953}, {2'702'012'168, 13'576},
    {2'702'005'319, 10'441}, {2'702'007'092, 11'287},  // C
    {2'702'010'432, 12'794}, {2'702'012'870, 13'896},
    {2'702'006'313, 10'919}, {2'702'009'005, 12'143},  // D
    {2'702'012'343, 13'669}, {2'702'005'484, 10'538},
    {2'702'008'270, 11'816}, {2'702'010'777, 12'918},  // E
    {2'702'013'105, 13'998}, {2'702'006'424, 10'979},
    {2'702'010'260, 12'687}, {2'702'012'460, 13'701},  // F
}};

double from_angle_steps(std::int64_t steps) {
  // The conversions to 32 bits wrap, as the angle does.
  return kAngleStep_rad *
         static_cast<double>(static_cast<std::int32_t>(static_cast<std::uint32_t>(steps)));
}

std::int64_t angle_steps(double angle_rad) {
  return std::llround(std::fmod(angle_rad, kTurn) / kAngleStep_rad);
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

std::int64_t middle_s(std::int64_t interval) {
  return interval * kInterval_s + kInterval_s / 2;
}

/// What does not change from set to set, and where the angles begin and how they go on.
struct GpsSlot {
  GpsEphemeris fixed;
  std::int64_t mean_anomaly_steps = 0;   ///< At the first interval.
  std::int64_t mean_anomaly_change = 0;  ///< Steps per interval.
  std::int64_t node_steps = 0;
  std::int64_t bias_steps = 0;  ///< Mean over the saw tooth.
};

struct GpsPlan {
  std::int64_t first_interval = 0;
  std::int64_t node_week_change = 0;  ///< Steps per week, besides those per interval.
  std::array<GpsSlot, kGpsSlots> slots;
};

/// Second harmonics of an orbit. The oblate earth gives all of them the same mean; sun and moon
/// pull each plane, and each place in it, another way. Along the track and across the radius they
/// go together, as in real sets: 5.2e-8 rad per metre (Cuc with Crs, Cus against Crc).
void put_harmonics(double node_rad, double argument_rad, GpsEphemeris& eph) {
  constexpr double kAlongPerRadius_radpm = 5.2e-8;
  const double mean_radius_m = 231.0;
  eph.radius_cosine_m = mean_radius_m + 62.0 * std::cos(node_rad) + 38.0 * std::cos(argument_rad);
  eph.radius_sine_m = 74.0 * std::sin(node_rad + 0.4) + 41.0 * std::sin(argument_rad);
  eph.latitude_sine_rad = 7.6e-6 - kAlongPerRadius_radpm * (eph.radius_cosine_m - mean_radius_m);
  eph.latitude_cosine_rad = kAlongPerRadius_radpm * eph.radius_sine_m;
  eph.inclination_cosine_rad =
      1.1e-7 * std::cos(node_rad - 0.7) + 5.0e-8 * std::cos(2.0 * argument_rad);
  eph.inclination_sine_rad = 8.0e-8 * std::sin(node_rad) - 6.0e-8 * std::sin(2.0 * argument_rad);
}

GpsPlan make_gps_plan() {
  GpsPlan plan;
  const double epoch_s = kEpochWeek * kWeek_s + kEpochOfWeek_s;
  plan.first_interval = static_cast<std::int64_t>(epoch_s) / kInterval_s;
  const auto first_s = static_cast<double>(middle_s(plan.first_interval));
  const double later_s = first_s - epoch_s;

  GpsEphemeris common;
  common.ascending_node_rate = kRateStep_radps * static_cast<double>(kNodeRateTurns * kWholeRate);
  common.inclination_rad = 55.0 * kDegree;
  plan.node_week_change = angle_steps(-kEarthRate_radps * kWeek_s);

  for (std::size_t slot = 0; slot < kGpsSlots; ++slot) {
    GpsEphemeris eph = common;
    const auto prn = static_cast<int>(slot) + 1;
    eph.prn = static_cast<std::uint8_t>(prn);
    // Spread over the satellites by steps that share no factor with the number of values.
    eph.eccentricity = 0.002 + 0.001 * (prn * 7 % 9);
    eph.argument_of_perigee_rad = (prn * 53 % 360 - 180) * kDegree;
    eph.group_delay_s = std::ldexp(prn * 11 % 24 - 20.0, -31);
    eph.sqrt_semi_major_axis =
        std::ldexp(static_cast<double>(kGpsMotion[slot].root_axis_steps), -19);
    eph.mean_motion_difference =
        kRateStep_radps * static_cast<double>(kGpsMotion[slot].difference_steps);
    put_harmonics(kGpsNode_deg[slot / 4] * kDegree, kGpsArgumentOfLatitude_deg[slot] * kDegree,
                  eph);
    eph = quantised(eph);
    const double motion = std::sqrt(kEarthGravity_m3ps2) / std::pow(eph.sqrt_semi_major_axis, 3.0) +
                          eph.mean_motion_difference;

    GpsSlot& made = plan.slots[slot];
    made.fixed = eph;
    made.mean_anomaly_change = angle_steps(motion * double{kInterval_s});
    made.mean_anomaly_steps = angle_steps(kGpsArgumentOfLatitude_deg[slot] * kDegree +
                                          motion * later_s - eph.argument_of_perigee_rad);
    const double node_longitude = kGpsNode_deg[slot / 4] * kDegree - kGreenwichAtEpoch_rad +
                                  (eph.ascending_node_rate - kEarthRate_radps) * later_s;
    made.node_steps =
        angle_steps(node_longitude + kEarthRate_radps * (first_s - kEpochWeek * kWeek_s));
    made.bias_steps = (prn * 37 % 24 - 12) * 21'475;  // 1e-5 s
  }
  return plan;
}

std::vector<NominalOrbit> walker(GnssSystem system, double semi_major_axis_m,
                                 double inclination_rad,
                                 const std::array<std::uint8_t, 24>& numbers) {
  constexpr std::size_t kPerPlane = 8;
  std::vector<NominalOrbit> orbits;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t plane_number = i / kPerPlane;
    const auto plane = static_cast<double>(plane_number);
    const auto place = static_cast<double>(i % kPerPlane);
    NominalOrbit orbit;
    orbit.satellite = {system, numbers[i]};
    orbit.semi_major_axis_m = semi_major_axis_m;
    orbit.inclination_rad = inclination_rad;
    // Walker 24/3/1: planes 120 deg apart, 45 deg in the plane, 15 deg from plane to plane.
    orbit.ascending_node_rad = plane * kTurn / 3.0 - kGreenwichAtEpoch_rad;
    orbit.mean_anomaly_rad = place * kTurn / 8.0 + plane * kTurn / 24.0;
    orbit.mean_motion_radps =
        std::sqrt(kEarthGravity_m3ps2 / semi_major_axis_m) / semi_major_axis_m;
    orbits.push_back(orbit);
  }
  return orbits;
}

constexpr std::array<std::uint8_t, 24> kOneTo24{1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12,
                                                13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24};
/// The medium orbits' ranging codes.
constexpr std::array<std::uint8_t, 24> kBeidouMedium{
    19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 32, 33, 34, 35, 36, 37, 41, 42, 43, 44, 45, 46};

/// Radius of an orbit that goes round with the earth.
const double kSynchronousAxis_m =
    std::cbrt(kEarthGravity_m3ps2 / (kEarthRate_radps * kEarthRate_radps));

NominalOrbit standing(GnssSystem system, std::uint8_t number, double longitude_deg) {
  NominalOrbit orbit;
  orbit.satellite = {system, number};
  orbit.semi_major_axis_m = kSynchronousAxis_m;
  orbit.mean_anomaly_rad = longitude_deg * kDegree;
  orbit.mean_motion_radps = kEarthRate_radps;
  return orbit;
}

std::vector<NominalOrbit> quasi_zenith() {
  constexpr double kCentre_deg = 135.0;
  std::vector<NominalOrbit> orbits;
  for (const std::uint8_t number : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
    NominalOrbit orbit;
    orbit.satellite = {GnssSystem::qzss, number};
    orbit.semi_major_axis_m = kSynchronousAxis_m;
    orbit.eccentricity = 0.075;
    orbit.inclination_rad = 41.0 * kDegree;
    orbit.argument_of_perigee_rad = 270.0 * kDegree;  // slow, and so long, in the north
    orbit.mean_anomaly_rad = static_cast<double>(orbits.size()) * kTurn / 3.0;
    // At the northernmost point, M = 180 deg, a quarter past the node, the satellite is at the
    // centre.
    orbit.ascending_node_rad =
        (kCentre_deg - 90.0) * kDegree - (orbit.mean_anomaly_rad - std::numbers::pi);
    orbit.mean_motion_radps = kEarthRate_radps;
    orbits.push_back(orbit);
  }
  orbits.insert(orbits.begin() + 2, standing(GnssSystem::qzss, 3, 127.0));
  return orbits;
}

}  // namespace

std::vector<NominalOrbit> nominal_orbits(GnssSystem system) {
  switch (system) {
    case GnssSystem::glonass:
      return walker(system, 25'508e3, 64.8 * kDegree, kOneTo24);
    case GnssSystem::galileo:
      return walker(system, 29'600.318e3, 56.0 * kDegree, kOneTo24);
    case GnssSystem::beidou:
      return walker(system, 27'906e3, 55.0 * kDegree, kBeidouMedium);
    case GnssSystem::sbas:
      return {standing(system, 123, 31.5),     // EGNOS, Astra 5B
              standing(system, 127, 55.0),     // GAGAN, GSAT-8
              standing(system, 128, 83.0),     // GAGAN, GSAT-10
              standing(system, 131, -117.0),   // WAAS, Eutelsat 117 West B
              standing(system, 133, -129.0),   // WAAS, SES-15
              standing(system, 136, 5.0),      // EGNOS, SES-5
              standing(system, 137, 145.0),    // MSAS, MTSAT-2
              standing(system, 138, -107.3)};  // WAAS, Anik F1R
    case GnssSystem::qzss:
      return quasi_zenith();
    case GnssSystem::gps:
    case GnssSystem::imes:
      break;
  }
  return {};
}

SatelliteState nominal_state(const NominalOrbit& orbit, const GpsTime& time, double offset_s) {
  // The orbit restated for the last whole second, and then as any other.
  const std::int64_t second = time.time_of_week_ns / 1'000'000'000;
  const auto whole_s = static_cast<double>(second);
  const double since_epoch_s = (time.week - kEpochWeek) * kWeek_s + whole_s - kEpochOfWeek_s;
  GpsEphemeris eph;
  eph.week = time.week;
  eph.ephemeris_time_s = whole_s;
  eph.clock_time_s = whole_s;
  eph.sqrt_semi_major_axis = std::sqrt(orbit.semi_major_axis_m);
  eph.eccentricity = orbit.eccentricity;
  eph.inclination_rad = orbit.inclination_rad;
  eph.argument_of_perigee_rad = orbit.argument_of_perigee_rad;
  eph.mean_anomaly_rad =
      std::fmod(orbit.mean_anomaly_rad + orbit.mean_motion_radps * since_epoch_s, kTurn);
  eph.mean_motion_difference =
      orbit.mean_motion_radps -
      std::sqrt(kEarthGravity_m3ps2 / orbit.semi_major_axis_m) / orbit.semi_major_axis_m;
  eph.ascending_node_rad = orbit.ascending_node_rad -
                           std::fmod(kEarthRate_radps * since_epoch_s, kTurn) +
                           kEarthRate_radps * whole_s;
  SatelliteState state = satellite_state(eph, time, offset_s);
  state.clock_s = 0.0;
  state.clock_drift = 0.0;
  return state;
}

std::int64_t broadcast_interval(const GpsTime& time, double offset_s) {
  const std::int64_t ns =
      std::int64_t{time.week} * kWeek_ns + time.time_of_week_ns + std::llround(offset_s * 1e9);
  return floor_divide(ns, kInterval_s * 1'000'000'000);
}

GpsEphemeris nominal_gps_set(int prn, std::int64_t interval) {
  static const GpsPlan kPlan = make_gps_plan();
  const GpsSlot& slot = kPlan.slots[static_cast<std::size_t>(prn - 1)];
  const std::int64_t count = interval - kPlan.first_interval;
  const std::int64_t week = floor_divide(interval, kIntervalsPerWeek);

  GpsEphemeris eph = slot.fixed;
  eph.week = static_cast<std::int32_t>(week);
  eph.ephemeris_time_s = static_cast<double>(middle_s(interval - week * kIntervalsPerWeek));
  eph.mean_anomaly_rad =
      from_angle_steps(slot.mean_anomaly_steps + slot.mean_anomaly_change * count);
  eph.ascending_node_rad =
      from_angle_steps(slot.node_steps + kNodeRateTurns * kWholeChange * count +
                       kPlan.node_week_change * (week - kEpochWeek));

  // A triangle with its corners where the sets change over.
  eph.clock_time_s = eph.ephemeris_time_s;
  const std::int64_t cycle = 2 * kClockTurnIntervals;
  const std::int64_t shifted = interval + std::int64_t{97} * prn;
  const std::int64_t phase = shifted - floor_divide(shifted, cycle) * cycle;
  const bool rising = phase < kClockTurnIntervals;
  const std::int64_t height = (rising ? phase : cycle - 1 - phase) - kClockTurnIntervals / 2;
  eph.clock_bias_s = std::ldexp(static_cast<double>(slot.bias_steps + kWholeChange * height), -31);
  eph.clock_drift = std::ldexp(static_cast<double>(rising ? kWholeRate : -kWholeRate), -43);

  constexpr std::int64_t kIssues = 239;
  const std::int64_t rounds = floor_divide(interval, kIssues);
  eph.issue_of_ephemeris = static_cast<std::uint8_t>(1 + interval - rounds * kIssues);
  eph.issue_of_clock =
      static_cast<std::uint16_t>((rounds & 3) * 256 + std::int64_t{eph.issue_of_ephemeris});
  return eph;
}

KlobucharParameters nominal_ionosphere() {
  // Steps of IS-GPS-200 table 20-X: 2^-30, 2^-27, 2^-24, 2^-24; 2^11, 2^14, 2^16, 2^16.
  KlobucharParameters k;
  k.alpha = {std::ldexp(11.0, -30), std::ldexp(2.0, -27), std::ldexp(-1.0, -24),
             std::ldexp(-1.0, -24)};
  k.beta = {std::ldexp(44.0, 11), std::ldexp(4.0, 14), std::ldexp(-2.0, 16), std::ldexp(-4.0, 16)};
  return k;
}

GpsUtcParameters nominal_utc(std::int64_t interval) {
  constexpr std::int64_t kAnnounced_s = 182 * kDay_s;
  const Calendar calendar(UtcTime{});  // begins with GPS time
  const auto leap = [&](std::int64_t gps_s) {
    return calendar.leap_seconds(SimTime{Duration{gps_s * kSecond_ns}});
  };
  const std::int64_t now_s = interval * kInterval_s;

  GpsUtcParameters utc;
  utc.reference_week = static_cast<std::int32_t>(floor_divide(interval, kIntervalsPerWeek));
  utc.reference_time_s = 405'504.0;  // of steps of 4096 s
  utc.leap_seconds = leap(now_s);
  utc.leap_seconds_future = leap(now_s + kAnnounced_s);
  // The first second with the stated number: bisection, for the table only grows.
  std::int64_t before_s = 0;
  std::int64_t after_s = now_s + kAnnounced_s;
  while (after_s - before_s > 1) {
    const std::int64_t middle = before_s + (after_s - before_s) / 2;
    (leap(middle) < utc.leap_seconds_future ? before_s : after_s) = middle;
  }
  const std::int64_t day = (after_s - 60) / kDay_s;  // GPS is less than a minute ahead
  utc.leap_week = static_cast<std::int32_t>(day / 7);
  utc.leap_day = static_cast<std::int32_t>(day % 7 + 1);
  return utc;
}

}  // namespace rigwire::sim
