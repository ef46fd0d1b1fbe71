#include "sim/gnss/broadcast_orbits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/constants.h"
#include "sim/gnss/ephemeris.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::sim {
namespace {

constexpr std::int64_t kWeek = 604'800;

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

std::int64_t nanoseconds(const GpsTime& time, double offset_s) {
  return time.week * kWeek_ns + time.time_of_week_ns + std::llround(offset_s * 1e9);
}

// Galileo and BeiDou.

constexpr std::int64_t kInterval_s = 7'200;
constexpr std::int64_t kBeidouBehind_s = 14;
constexpr std::int64_t kEpoch_s = kNominalEpochWeek * kWeek + kNominalEpochOfWeek_s;

const double kAngleStep_rad = std::ldexp(kSemicircle_rad, -31);
const double kRateStep_radps = std::ldexp(kSemicircle_rad, -43);

bool is_beidou(const Satellite& satellite) {
  return satellite.system == GnssSystem::beidou;
}

/// Seconds by which the system's time is behind that of GPS.
std::int64_t behind_s(const Satellite& satellite) {
  return is_beidou(satellite) ? kBeidouBehind_s : 0;
}

std::int64_t angle_steps(double angle_rad) {
  return std::llround(std::fmod(angle_rad, kTurn) / kAngleStep_rad);
}

double from_angle_steps(std::int64_t steps) {
  // The conversions to 32 bits wrap, as the angle does.
  return kAngleStep_rad *
         static_cast<double>(static_cast<std::int32_t>(static_cast<std::uint32_t>(steps)));
}

struct StatedMotion {
  double root_axis = 0.0;
  double difference_radps = 0.0;
  std::int64_t change_steps = 0;  ///< Change of the mean anomaly in two hours.
};

/// The motion nearest to the nominal one whose two hours are a whole number of steps, and the first
/// pair of axis and difference (from 3e-9 rad/s on, as real ones are) that states it.
StatedMotion stated_motion(const NominalOrbit& orbit) {
  constexpr double kEnough = 3e-5;  // of a step in two hours
  constexpr double kUsual_radps = 3e-9;
  const double per_step_radps = kAngleStep_rad / double{kInterval_s};
  StatedMotion motion;
  motion.change_steps = std::llround(orbit.mean_motion_radps / per_step_radps);
  const double wanted_radps = static_cast<double>(motion.change_steps) * per_step_radps;
  const double root = std::sqrt(kEarthOfGalileo.gravity_m3ps2);
  const double axis_m = std::cbrt(kEarthOfGalileo.gravity_m3ps2 /
                                  ((wanted_radps - kUsual_radps) * (wanted_radps - kUsual_radps)));
  const std::int64_t first = std::llround(std::ldexp(std::sqrt(axis_m), 19));
  for (std::int64_t steps = first;; ++steps) {
    motion.root_axis = std::ldexp(static_cast<double>(steps), -19);
    const double missing_radps =
        wanted_radps - root / (motion.root_axis * motion.root_axis * motion.root_axis);
    motion.difference_radps = kRateStep_radps * std::round(missing_radps / kRateStep_radps);
    if (std::abs(missing_radps - motion.difference_radps) < kEnough * per_step_radps) {
      return motion;
    }
  }
}

/// Whole numbers from -`reach` to `reach` that neighbours do not share.
int spread(int number, int factor, int reach) {
  return number * factor % (2 * reach + 1) - reach;
}

// GLONASS.

constexpr std::int64_t kHalfHour_s = 1'800;
constexpr std::int64_t kMoscow_s = 3 * 3'600;
constexpr std::int64_t kDaysTo1996 = 5'839;  // since 1980-01-06
constexpr std::int64_t kDaysOfFourYears = 1'461;
/// Appendix A.3.1.2 and table 3.2: PZ-90.
constexpr double kGlonassGravity_m3ps2 = 3.986'004'4e14;
constexpr double kGlonassRadius_m = 6'378'136.0;
constexpr double kGlonassOblateness = 1.082'625'7e-3;
constexpr double kGlonassEarthRate_radps = 7.292'115e-5;
/// How long before and after a change of sets a satellite goes over.
constexpr double kOver_s = 30.0;

std::int32_t leap_seconds(std::int64_t gps_ns) {
  static const Calendar kCalendar(UtcTime{});  // begins with GPS time
  return kCalendar.leap_seconds(SimTime{Duration{gps_ns}});
}

using State = Eigen::Matrix<double, 6, 1>;

/// Motion under an oblate earth, in axes that do not turn.
State derivative(const State& s) {
  const Eigen::Vector3d p = s.head<3>();
  const double square = p.squaredNorm();
  const double by_radius3 = kGlonassGravity_m3ps2 / (square * std::sqrt(square));
  const double flat = 1.5 * kGlonassOblateness * kGlonassRadius_m * kGlonassRadius_m / square;
  const double height = 5.0 * p.z() * p.z() / square;
  State rate;
  rate.head<3>() = s.tail<3>();
  rate.tail<3>() = -by_radius3 * (1.0 + flat * (1.0 - height)) * p;
  rate(5) -= 2.0 * by_radius3 * flat * p.z();
  return rate;
}

State moved(const State& s, double step_s) {  // Runge and Kutta
  const State a = derivative(s);
  const State b = derivative(s + 0.5 * step_s * a);
  const State c = derivative(s + 0.5 * step_s * b);
  const State d = derivative(s + step_s * c);
  return s + step_s / 6.0 * (a + 2.0 * b + 2.0 * c + d);
}

/// A periodic orbit in axes that go with its node: x in cosines, y and z in sines of odd multiples
/// of the phase.
struct OblateOrbit {
  static constexpr std::size_t kHarmonics = 5;
  double rate_radps = 0.0;       ///< Rate of the phase.
  double node_rate_radps = 0.0;  ///< In axes that do not rotate.
  std::array<Eigen::Vector3d, kHarmonics> harmonics;
};

struct Apex {
  State state;
  double time_s = 0.0;
};

State at_node(double radius_m, double inclination_rad, double speed_mps) {
  State s;
  s << radius_m, 0.0, 0.0, 0.0, speed_mps * std::cos(inclination_rad),
      speed_mps * std::sin(inclination_rad);
  return s;
}

/// Where the orbit turns back to the equator.
Apex apex_of(State s) {
  constexpr double kStep_s = 10.0;
  Apex apex{s, 0.0};
  while (apex.state(5) > 0.0) {
    s = apex.state;
    apex = {moved(s, kStep_s), apex.time_s + kStep_s};
  }
  for (int round = 0; round < 5; ++round) {  // Newton
    const double missing_s = -apex.state(5) / derivative(apex.state)(5);
    apex = {moved(apex.state, missing_s), apex.time_s + missing_s};
  }
  return apex;
}

OblateOrbit oblate_orbit(double radius_m, double inclination_rad) {
  // Secant method: at the apex, the radius must not change.
  const auto radial = [&](double speed_mps) {
    const Apex apex = apex_of(at_node(radius_m, inclination_rad, speed_mps));
    return apex.state.head<3>().dot(apex.state.tail<3>());
  };
  double before = std::sqrt(kGlonassGravity_m3ps2 / radius_m);
  double speed = before * (1.0 + 1e-4);
  double radial_before = radial(before);
  for (int round = 0; round < 8 && speed != before; ++round) {
    const double now = radial(speed);
    const double slope = (now - radial_before) / (speed - before);
    before = speed;
    radial_before = now;
    speed -= slope != 0.0 ? now / slope : 0.0;
  }
  State s = at_node(radius_m, inclination_rad, speed);
  const Apex apex = apex_of(s);
  OblateOrbit orbit;
  orbit.rate_radps = 0.5 * std::numbers::pi / apex.time_s;
  orbit.node_rate_radps =
      (std::atan2(apex.state.y(), apex.state.x()) - 0.5 * std::numbers::pi) / apex.time_s;
  // Fourier's sums over one round.
  constexpr int kSamples = 64;
  constexpr int kStepsOfSample = 64;
  orbit.harmonics.fill(Eigen::Vector3d::Zero());
  const double step_s = 4.0 * apex.time_s / (kSamples * kStepsOfSample);
  for (int i = 0; i < kSamples; ++i) {
    const double time_s = i * kStepsOfSample * step_s;
    const Eigen::Vector3d p =
        Eigen::AngleAxisd(-orbit.node_rate_radps * time_s, Eigen::Vector3d::UnitZ()) *
        Eigen::Vector3d(s.head<3>());
    for (std::size_t k = 0; k < OblateOrbit::kHarmonics; ++k) {
      const double angle = orbit.rate_radps * time_s * static_cast<double>(2 * k + 1);
      orbit.harmonics[k] +=
          2.0 / kSamples *
          p.cwiseProduct(Eigen::Vector3d(std::cos(angle), std::sin(angle), std::sin(angle)));
    }
    for (int k = 0; k < kStepsOfSample; ++k) {
      s = moved(s, step_s);
    }
  }
  return orbit;
}

/// Returns the orbit that all slots share.
const OblateOrbit& glonass_orbit() {
  static const OblateOrbit kOrbit = [] {
    const NominalOrbit nominal = nominal_orbits(GnssSystem::glonass).front();
    return oblate_orbit(nominal.semi_major_axis_m, nominal.inclination_rad);
  }();
  return kOrbit;
}

/// By GPS time.
std::int64_t middle_ns(std::int64_t interval) {
  const std::int64_t utc_s = interval * kHalfHour_s + kHalfHour_s / 2 - kMoscow_s;
  // Leap seconds at an instant that is nearly this one.
  return (utc_s + leap_seconds(utc_s * kSecond_ns)) * kSecond_ns;
}

Eigen::Vector3d in_steps(const Eigen::Vector3d& value, double step) {
  return step * (value / step).array().round();
}

Eigen::Vector3d turned(const Eigen::Vector3d& v, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

const double kPositionStep_m = std::ldexp(1e3, -11);
const double kVelocityStep_mps = std::ldexp(1e3, -20);

}  // namespace

KeplerBroadcast::KeplerBroadcast(const NominalOrbit& orbit) : satellite_(orbit.satellite) {
  const bool beidou = is_beidou(satellite_);
  const OrbitConstants& earth = beidou ? kEarthOfBeidou : kEarthOfGalileo;
  const int number = satellite_.number;
  const StatedMotion motion = stated_motion(orbit);
  first_ = floor_divide(kEpoch_s - behind_s(satellite_), kInterval_s);
  const std::int64_t reference_s = first_ * kInterval_s + (beidou ? kInterval_s / 2 : 0);
  first_week_ = static_cast<std::int32_t>(floor_divide(reference_s, kWeek));
  const auto later_s = static_cast<double>(reference_s + behind_s(satellite_) - kEpoch_s);
  const double per_step_radps = kAngleStep_rad / double{kInterval_s};
  anomaly_change_ = motion.change_steps;
  anomaly_steps_ = angle_steps(orbit.mean_anomaly_rad +
                               static_cast<double>(anomaly_change_) * per_step_radps * later_s);
  node_change_ = angle_steps(-earth.rotation_radps * double{kWeek});
  // The node is stated for the beginning of the week, in which the earth turns on.
  node_steps_ =
      angle_steps(orbit.ascending_node_rad - earth.rotation_radps * later_s +
                  earth.rotation_radps * static_cast<double>(reference_s - first_week_ * kWeek));

  fixed_.prn = satellite_.number;
  fixed_.sqrt_semi_major_axis = motion.root_axis;
  fixed_.mean_motion_difference = motion.difference_radps;
  fixed_.inclination_rad = from_angle_steps(angle_steps(orbit.inclination_rad));
  constexpr int kClockStep = 100'000;
  constexpr std::uint8_t kGalileoAccuracy = 107;  // 3.12 m
  if (beidou) {
    fixed_.clock_bias_s = std::ldexp(spread(number, 37, 6) * kClockStep, -33);
    fixed_.group_delay_s = 1e-10 * spread(number, 11, 25);
    fixed_.second_delay_s = 1e-10 * spread(number, 17, 25);
  } else {
    fixed_.clock_bias_s = std::ldexp(spread(number, 37, 12) * kClockStep, -34);
    fixed_.accuracy_index = kGalileoAccuracy;
    fixed_.group_delay_s = std::ldexp(spread(number, 11, 20), -32);
    fixed_.second_delay_s = std::ldexp(spread(number, 17, 20), -32);
  }
}

std::int64_t KeplerBroadcast::interval(const GpsTime& time, double offset_s) const {
  return floor_divide(nanoseconds(time, offset_s) - behind_s(satellite_) * kSecond_ns,
                      kInterval_s * kSecond_ns);
}

GpsEphemeris KeplerBroadcast::set(std::int64_t interval) const {
  const std::int64_t reference_s =
      interval * kInterval_s + (is_beidou(satellite_) ? kInterval_s / 2 : 0);
  const std::int64_t week = floor_divide(reference_s, kWeek);
  GpsEphemeris eph = fixed_;
  eph.week = static_cast<std::int32_t>(week);
  eph.ephemeris_time_s = eph.clock_time_s = static_cast<double>(reference_s - week * kWeek);
  eph.mean_anomaly_rad = from_angle_steps(anomaly_steps_ + anomaly_change_ * (interval - first_));
  eph.ascending_node_rad = from_angle_steps(node_steps_ + node_change_ * (week - first_week_));
  if (is_beidou(satellite_)) {
    constexpr std::uint8_t kYoungerThanAnHour = 0;
    eph.issue_of_clock = eph.issue_of_ephemeris = kYoungerThanAnHour;
  } else {
    constexpr std::int64_t kIssues = 1'024;
    eph.issue_of_clock =
        static_cast<std::uint16_t>(interval - floor_divide(interval, kIssues) * kIssues);
    eph.issue_of_ephemeris = static_cast<std::uint8_t>(eph.issue_of_clock);
  }
  return eph;
}

SatelliteState KeplerBroadcast::state(const GpsTime& time, double offset_s) const {
  const bool beidou = is_beidou(satellite_);
  GpsTime own = time;
  own.time_of_week_ns -= behind_s(satellite_) * kSecond_ns;
  const OrbitConstants& earth = beidou ? kEarthOfBeidou : kEarthOfGalileo;
  SatelliteState state = satellite_state(set(interval(time, offset_s)), own, offset_s, earth);
  if (beidou) {
    state.second_delay_s = fixed_.second_delay_s;
  } else {
    const double ratio =
        carrier_hz(GnssSystem::galileo, false, 0) / carrier_hz(GnssSystem::galileo, true, 0);
    state.second_delay_s = ratio * ratio * fixed_.group_delay_s;
  }
  return state;
}

GlonassBroadcast::GlonassBroadcast(const NominalOrbit& orbit)
    : slot_(orbit.satellite.number),
      phase_rad_(orbit.mean_anomaly_rad),
      node_rad_(orbit.ascending_node_rad),
      clock_correction_s_(std::ldexp(spread(slot_, 37, 12) * 5'000, -30)) {}

std::int64_t GlonassBroadcast::interval(const GpsTime& time, double offset_s) {
  const std::int64_t gps_ns = nanoseconds(time, offset_s);
  return floor_divide(gps_ns + (kMoscow_s - leap_seconds(gps_ns)) * kSecond_ns,
                      kHalfHour_s * kSecond_ns);
}

GlonassBroadcast::Middle GlonassBroadcast::middle(std::int64_t interval) const {
  const OblateOrbit& shape = glonass_orbit();
  const auto middle_s = static_cast<double>(middle_ns(interval) / kSecond_ns - kEpoch_s);
  const double turn_radps = shape.node_rate_radps - kGlonassEarthRate_radps;
  return {interval, std::fmod(phase_rad_ + shape.rate_radps * middle_s, kTurn),
          std::fmod(node_rad_ + turn_radps * middle_s, kTurn)};
}

GlonassBroadcast::Motion GlonassBroadcast::orbit(const Middle& middle, double since_s) {
  const OblateOrbit& shape = glonass_orbit();
  const double turn_radps = shape.node_rate_radps - kGlonassEarthRate_radps;
  const double phase = middle.phase_rad + shape.rate_radps * since_s;
  const double node = middle.node_rad + turn_radps * since_s;
  // Odd multiples of the phase, by turning on by twice of it.
  double c = std::cos(phase);
  double s = std::sin(phase);
  const double c2 = c * c - s * s;
  const double s2 = 2.0 * c * s;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < OblateOrbit::kHarmonics; ++k) {
    const double rate = shape.rate_radps * static_cast<double>(2 * k + 1);
    p += shape.harmonics[k].cwiseProduct(Eigen::Vector3d(c, s, s));
    v += rate * shape.harmonics[k].cwiseProduct(Eigen::Vector3d(-s, c, c));
    const double next = c * c2 - s * s2;
    s = s * c2 + c * s2;
    c = next;
  }
  v += turn_radps * Eigen::Vector3d(-p.y(), p.x(), 0.0);
  return {turned(p, node), turned(v, node)};
}

GlonassEphemeris GlonassBroadcast::set(std::int64_t interval) const {
  const Motion at_middle = orbit(middle(interval), 0.0);
  const std::int64_t middle_s = interval * kHalfHour_s + kHalfHour_s / 2;
  const std::int64_t day = floor_divide(middle_s, kDay_s);
  const std::int64_t four_years = floor_divide(day - kDaysTo1996, kDaysOfFourYears);
  GlonassEphemeris set;
  set.slot = slot_;
  set.time_of_day_s = static_cast<std::int32_t>(middle_s - day * kDay_s);
  set.day = static_cast<std::int32_t>(day - kDaysTo1996 - four_years * kDaysOfFourYears + 1);
  set.four_years = static_cast<std::int32_t>(four_years + 1);
  Eigen::Map<Eigen::Vector3d>(set.position_m.data()) =
      in_steps(at_middle.position_m, kPositionStep_m);
  Eigen::Map<Eigen::Vector3d>(set.velocity_mps.data()) =
      in_steps(at_middle.velocity_mps, kVelocityStep_mps);
  set.clock_correction_s = clock_correction_s_;
  return set;
}

/// Returns what the quantisation of a set adds to the orbit.
GlonassBroadcast::Motion GlonassBroadcast::deviation(const Middle& middle, double since_s) {
  const Motion at_middle = orbit(middle, 0.0);
  const Eigen::Vector3d earth_rate = kGlonassEarthRate_radps * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d p = in_steps(at_middle.position_m, kPositionStep_m) - at_middle.position_m;
  // In axes that do not rotate, those of the earth at the middle.
  const Eigen::Vector3d v = in_steps(at_middle.velocity_mps, kVelocityStep_mps) -
                            at_middle.velocity_mps + earth_rate.cross(p);
  const Eigen::Vector3d up = at_middle.position_m.normalized();
  const double radius_m = at_middle.position_m.norm();
  const double stiffness = kGlonassGravity_m3ps2 / (radius_m * radius_m * radius_m);
  const auto pulled = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return stiffness * (3.0 * up * up.dot(x) - x);
  };
  // Series to the third order in time.
  const double t = since_s;
  const Eigen::Vector3d pull_p = pulled(p);
  const Eigen::Vector3d pull_v = pulled(v);
  const Eigen::Vector3d p_then = p + t * v + t * t / 2.0 * pull_p + t * t * t / 6.0 * pull_v;
  const Eigen::Vector3d v_then = v + t * pull_p + t * t / 2.0 * pull_v;
  const double turn = -kGlonassEarthRate_radps * t;
  Motion deviation{turned(p_then, turn), turned(v_then, turn)};
  deviation.velocity_mps -= earth_rate.cross(deviation.position_m);
  return deviation;
}

SatelliteState GlonassBroadcast::state(const GpsTime& time, double offset_s) const {
  const std::int64_t now = interval(time, offset_s);
  const std::int64_t since_ns = time.week * kWeek_ns + time.time_of_week_ns - middle_ns(now);
  const double since_s = static_cast<double>(since_ns) * 1e-9 + offset_s;
  const Middle at_middle = middle(now);
  const Motion motion = orbit(at_middle, since_s);
  Motion added = deviation(at_middle, since_s);
  const double into_change_s = std::abs(since_s) - (double{kHalfHour_s / 2} - kOver_s);
  if (into_change_s > 0.0) {
    const std::int64_t direction = since_s > 0.0 ? 1 : -1;
    const double neighbour_s = since_s - static_cast<double>(direction * kHalfHour_s);
    const Motion other = deviation(middle(now + direction), neighbour_s);
    const double s = into_change_s / (2.0 * kOver_s);
    const double share = s * s * (3.0 - 2.0 * s);
    const double share_rate =
        6.0 * s * (1.0 - s) / (2.0 * kOver_s) * static_cast<double>(direction);
    const Eigen::Vector3d apart = other.position_m - added.position_m;
    added.velocity_mps += share * (other.velocity_mps - added.velocity_mps) + share_rate * apart;
    added.position_m += share * apart;
  }
  SatelliteState state;
  state.position_E_m = motion.position_m + added.position_m;
  state.velocity_E_mps = motion.velocity_mps + added.velocity_mps;
  state.clock_s = -clock_correction_s_;
  return state;
}

}  // namespace rigwire::sim
