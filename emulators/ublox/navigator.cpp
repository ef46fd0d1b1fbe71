#include "emulators/ublox/navigator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::ubx::CfgNav5;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// Course is frozen below this speed or above this uncertainty.
constexpr double kFrozenSpeed_mps = 0.1;
constexpr double kFrozenCourse_deg = 15.0;
// How the position accuracy decays without a fix.
constexpr double kDriftingAccuracy_mps = 10.0;
// Shares of the time to first fix in a recorded cold start: 111 and 117 of 370 epochs; orbits of
// three satellites just before the fourth.
constexpr double kTimeShare = 0.300;
constexpr double kDateShare = 0.316;
constexpr double kOrbitShare = 0.99;
// After that start: when the fifth, sixth, seventh satellite joined the four of the first fix; the
// rest were there with the eighth.
constexpr std::size_t kFirstOrbits = 4;
constexpr std::array<Duration, 4> kMoreOrbits{37s, 54s, 84s, 132s};
// Data sheet of the NEO-7P, section 1.3.
constexpr Duration kUsualColdStart = 30s;
constexpr Duration kUsualWarmStart = 28s;

constexpr std::uint8_t kStationary = 2;
constexpr std::uint8_t kOnly2d = 1;
constexpr std::uint8_t kOnly3d = 2;

/// A dynamic platform model: sanity limits, R28 section 8.1, table "Dynamic Platform Models"; and
/// the accelerations that its filter reckons with, m/s per sqrt(s) and axis. Those of portable and
/// automotive are fitted to drives of two NEO-7Ps (speed late by a quarter of a second at 1 Hz),
/// the others are chosen in the order that u-blox states (more noise with more dynamics).
struct Dynamics {
  double altitude_m;
  double horizontal_mps;
  double vertical_mps;
  double level_acceleration;
  double vertical_acceleration;
};
constexpr std::array<Dynamics, 11> kDynamics{{
    {12'000.0, 310.0, 50.0, 0.45, 0.32},    // portable
    {12'000.0, 310.0, 50.0, 0.45, 0.32},    // reserved
    {9'000.0, 10.0, 6.0, 0.02, 0.02},       // stationary
    {9'000.0, 30.0, 20.0, 0.25, 0.18},      // pedestrian
    {6'000.0, 100.0, 15.0, 0.45, 0.10},     // automotive
    {9'000.0, 25.0, 5.0, 0.25, 0.10},       // at sea
    {50'000.0, 100.0, 6'400.0, 1.0, 1.0},   // airborne 1 g
    {50'000.0, 250.0, 10'000.0, 2.0, 2.0},  // airborne 2 g
    {50'000.0, 500.0, 20'000.0, 4.0, 4.0},  // airborne 4 g
    {9'000.0, 30.0, 20.0, 0.25, 0.18},      // wrist
    {6'000.0, 100.0, 15.0, 0.45, 0.18},     // bike
}};

// Subframe 4 page 18 carries the leap seconds: IS-GPS-200, section 20.3.3.5.1 and table 20-V.
constexpr std::int64_t kAlmanacCycle_s = 750;
constexpr std::int64_t kLeapPageBegins_s = 17 * 30 + 18;
constexpr std::int64_t kLeapPageEnds_s = kLeapPageBegins_s + 6;

std::uint32_t milliseconds(Duration span) {
  return static_cast<std::uint32_t>(span / 1ms);
}

bool is_satellite_used(const SatelliteView& view) {
  return view.used;
}

/// Share of the new value that a low-pass filter of CFG-ODO takes: 0 heavy .. 255 weak.
double filter_share(std::uint8_t gain) {
  constexpr double kLevels = 256.0;
  return (gain + 1.0) / kLevels;
}

/// A sphere is good enough for the distance from a held position.
double distance_m(double latitude1_deg, double longitude1_deg, double latitude2_deg,
                  double longitude2_deg) {
  constexpr double kRadius_m = 6'371'000.0;
  // Equirectangular projection.
  const double north = (latitude2_deg - latitude1_deg) * kDegree;
  const double east = std::remainder(longitude2_deg - longitude1_deg, 360.0) * kDegree *
                      std::cos(latitude1_deg * kDegree);
  return kRadius_m * std::hypot(north, east);
}

// Unknowns: north, east, clock, down; the last one is left out when the height is held.
constexpr std::size_t kMost = 4;
using Matrix = std::array<std::array<double, kMost>, kMost>;

/// Gauss and Jordan with pivots on the diagonal, which suits a positive definite matrix. False when
/// it is (nearly) singular.
bool invert(Matrix& a, std::size_t n) {
  constexpr double kSmallestPivot = 1e-9;
  Matrix inverse{};
  for (std::size_t i = 0; i < n; ++i) {
    inverse[i][i] = 1.0;
  }
  for (std::size_t column = 0; column < n; ++column) {
    const double pivot = a[column][column];
    if (!(pivot > kSmallestPivot)) {
      return false;
    }
    for (std::size_t k = 0; k < n; ++k) {
      a[column][k] /= pivot;
      inverse[column][k] /= pivot;
    }
    for (std::size_t row = 0; row < n; ++row) {
      const double factor = a[row][column];
      for (std::size_t k = 0; row != column && k < n; ++k) {
        a[row][k] -= factor * a[column][k];
        inverse[row][k] -= factor * inverse[column][k];
      }
    }
  }
  a = inverse;
  return true;
}

/// How the directions of the satellites that take part in a fix dilute it.
struct Geometry {
  double horizontal = 0.0;
  double vertical = 0.0;  ///< 0 with three satellites, when the height is held.
  double time = 0.0;
};

/// Q = (G^T G)^-1 with rows [-e, 1] of the used satellites, one clock for all; with three of them
/// the height's column is left out. Nothing with fewer, or when they lie on a cone.
std::optional<Geometry> geometry_of(std::span<const SatelliteView> satellites) {
  const auto used = std::ranges::count_if(satellites, &SatelliteView::used);
  if (used < 3) {
    return std::nullopt;
  }
  const std::size_t unknowns = used == 3 ? 3 : kMost;
  Matrix normal{};
  for (const SatelliteView& view : satellites) {
    if (!view.used) {
      continue;
    }
    const double level = std::cos(view.elevation_rad);
    const std::array<double, kMost> row{-level * std::cos(view.azimuth_rad),
                                        -level * std::sin(view.azimuth_rad), 1.0,
                                        std::sin(view.elevation_rad)};
    for (std::size_t i = 0; i < unknowns; ++i) {
      for (std::size_t k = 0; k < unknowns; ++k) {
        normal[i][k] += row[i] * row[k];
      }
    }
  }
  if (!invert(normal, unknowns)) {
    return std::nullopt;
  }
  return Geometry{std::sqrt(normal[0][0] + normal[1][1]),
                  unknowns == kMost ? std::sqrt(normal[3][3]) : 0.0, std::sqrt(normal[2][2])};
}

}  // namespace

UbloxMemory UbloxMemory::after_clearing(std::uint16_t mask) {
  const auto kept = [&](unsigned bit) { return (mask >> bit & 1U) == 0; };
  return {.ephemerides = kept(0),
          .almanac = kept(1),
          .position = kept(4),
          .time = kept(8),
          .leap_seconds = kept(7)};
}

UbloxNavigator::UbloxNavigator(const UbloxSettings& settings, const Calendar& calendar)
    : calendar_(calendar),
      cold_start_(settings.time_to_first_fix),
      default_leap_seconds_(settings.profile->default_leap_seconds) {}

UbloxTimeBase UbloxNavigator::time_base(const UbloxConfiguration& configuration,
                                        std::int32_t leap_error_s) const {
  const auto& expert = configuration.expert();
  return {expert.week_rollover, default_leap_seconds_, leap_error_s};
}

void UbloxNavigator::begin(SimTime now, const UbloxMemory& memory,
                           const UbloxConfiguration& configuration) {
  const Duration cold = cold_start_ > 0s ? cold_start_ : kUsualColdStart;
  const Duration first = cold_start_ > 0s ? cold : Duration{0};
  const bool all = memory.ephemerides && memory.time;
  const Duration later = all ? Duration{0} : !memory.time ? cold : std::min(cold, kUsualWarmStart);
  const bool known = begun_ ? memory.time : first == 0s;
  const bool with_orbits = begun_ ? memory.almanac && memory.time : first == 0s;
  const bool with_leap = begun_ ? memory.leap_seconds && solution_.leap_known : first == 0s;
  time_to_first_fix_ = begun_ ? later : first;
  hearing_orbits_ = begun_ ? !all : first > 0s;
  heard_.clear();
  counted_ = kNever;
  had_course_ = false;
  anchor_.reset();
  starts_ += begun_ ? 1 : 0;
  begun_ = true;
  searching_ = now;
  tracking_since_s_ = -1;
  hold_.reset();
  const bool forgotten = !memory.almanac && !memory.position && !memory.time;
  const UbloxSolution before = solution_;
  if (!memory.position) {
    solution_ = {};
    had_fix_ = false;
    had_3d_fix_ = false;
  }
  if (!forgotten) {
    solution_.distance_m = before.distance_m;
    solution_.distance_accuracy_m = before.distance_accuracy_m;
    solution_.total_distance_m = before.total_distance_m;
  } else {
    reset_odometer();
    solution_.total_distance_m = 0.0;
  }
  solution_.dimensions = 0;
  solution_.fix_ok = false;
  solution_.first_fix_ms = 0;
  solution_.time_known = known;
  solution_.date_known = known;
  solution_.orbits_known = with_orbits;
  solution_.leap_known = with_leap;
  solution_.since_start_ms = milliseconds(now - powered_);
  set_time(solution_, calendar_, time_base(configuration, 0), now, Duration{0});
}

GnssCommand UbloxNavigator::command(const UbloxConfiguration& configuration) const {
  const auto& navigation = configuration.navigation();
  const auto& expert = configuration.expert();
  const Dynamics& model = kDynamics[std::min<std::size_t>(navigation.dynamic_model, 10)];
  GnssCommand command;
  command.systems = 0;
  command.second_signals = 0;
  for (const GnssSystem system :
       {GnssSystem::gps, GnssSystem::sbas, GnssSystem::galileo, GnssSystem::beidou,
        GnssSystem::imes, GnssSystem::qzss, GnssSystem::glonass}) {
    command.systems |= static_cast<std::uint8_t>((configuration.enabled(system) ? 1U : 0U)
                                                 << static_cast<unsigned>(system));
    command.second_signals |= static_cast<std::uint8_t>(
        (configuration.second_enabled(system) ? 1U : 0U) << static_cast<unsigned>(system));
  }
  command.minimum_elevation_rad = navigation.minimum_elevation_deg * kDegree;
  command.minimum_cn0_dbhz = expert.minimum_cn0_dbhz;
  command.maximum_satellites = expert.maximum_satellites;
  if (navigation.fix_mode == kOnly2d) {
    command.altitude_m = navigation.fixed_altitude_cm * 0.01;
  }
  command.horizontal_acceleration = model.level_acceleration;
  command.vertical_acceleration = model.vertical_acceleration;
  command.stationary = navigation.dynamic_model == kStationary;
  command.starts = starts_;
  return command;
}

void UbloxNavigator::climb(const GnssSample& sample, bool tracking) {
  const double progress = time_to_first_fix_ == 0s ? 1.0
                                                   : to_seconds(sample.time - searching_) /
                                                         to_seconds(time_to_first_fix_);
  UbloxSolution& s = solution_;
  s.time_known |= tracking && progress >= kTimeShare;
  s.date_known |= tracking && progress >= kDateShare;
  s.orbits_known |= tracking && progress >= kOrbitShare;
  s.since_start_ms = milliseconds(sample.time - powered_);
}

void UbloxNavigator::hear_leap_seconds(const GnssSample& sample) {
  const bool tracking =
      solution_.time_known && std::ranges::any_of(solution_.satellites, &SatelliteView::tracked);
  const std::int64_t now_s = calendar_.gps(sample.time).time_of_week_ns / 1'000'000'000;
  if (!tracking) {
    tracking_since_s_ = -1;
    return;
  }
  if (tracking_since_s_ < 0 || tracking_since_s_ > now_s) {
    tracking_since_s_ = now_s;
  }
  // The last whole page with the leap seconds that began after tracking did.
  const std::int64_t cycle = (now_s - kLeapPageEnds_s) / kAlmanacCycle_s;
  solution_.leap_known |=
      now_s >= kLeapPageEnds_s && cycle * kAlmanacCycle_s + kLeapPageBegins_s >= tracking_since_s_;
}

void UbloxNavigator::list_satellites(const GnssSample& sample,
                                     const UbloxConfiguration& configuration) {
  // Time comes from the first satellite, the date from the data of more of them.
  const std::size_t acquired = !solution_.time_known   ? 0
                               : !solution_.date_known ? 1
                                                       : sample.satellites.size();
  const auto& expert = configuration.expert();
  const double lowest_rad = configuration.navigation().minimum_elevation_deg * kDegree;
  std::size_t tracked = 0;
  std::size_t used = 0;
  auto& list = solution_.satellites;
  list.clear();
  for (const SatelliteView& seen : sample.satellites) {
    if (!configuration.enabled(seen.system)) {
      continue;
    }
    SatelliteView view = seen;
    view.tracked = view.tracked && tracked < acquired;
    tracked += view.tracked ? 1 : 0;
    view.used = view.used && view.tracked && view.elevation_rad >= lowest_rad &&
                view.cn0_dbhz >= expert.minimum_cn0_dbhz && used < expert.maximum_satellites;
    used += view.used ? 1 : 0;
    if (view.tracked || solution_.orbits_known) {
      list.push_back(view);
    }
  }
  if (hearing_orbits_) {
    keep_known_orbits(sample.time);
  }
}

void UbloxNavigator::keep_known_orbits(SimTime now) {
  const Duration since_fix = now - searching_ - time_to_first_fix_;
  const auto joined = std::ranges::upper_bound(kMoreOrbits, since_fix) - kMoreOrbits.begin();
  if (joined == static_cast<std::ptrdiff_t>(kMoreOrbits.size())) {
    hearing_orbits_ = false;
    heard_.clear();
    return;
  }
  const std::size_t known = kFirstOrbits + static_cast<std::size_t>(joined);
  const auto is_heard = [&](const SatelliteView& view) {
    return std::ranges::find(heard_, std::pair{view.system, view.number}) != heard_.end();
  };
  auto& list = solution_.satellites;
  auto count = static_cast<std::size_t>(std::ranges::count_if(
      list, [&](const SatelliteView& view) { return view.used && is_heard(view); }));
  // The strongest of the others is the next one whose orbit is received.
  for (; count < known; ++count) {
    const SatelliteView* next = nullptr;
    for (const SatelliteView& view : list) {
      if (view.used && !is_heard(view) && (next == nullptr || view.cn0_dbhz > next->cn0_dbhz)) {
        next = &view;
      }
    }
    if (next == nullptr) {
      break;
    }
    heard_.emplace_back(next->system, next->number);
  }
  for (SatelliteView& view : list) {
    view.used = view.used && is_heard(view);
  }
}

int UbloxNavigator::dimensions_of(const GnssSample& sample,
                                  const UbloxConfiguration& configuration) const {
  const auto& limits = configuration.navigation();
  const auto& satellites = solution_.satellites;
  const auto used = std::ranges::count_if(satellites, is_satellite_used);
  int dimensions = sample.fix == GnssFix::three_d ? 3 : sample.fix == GnssFix::two_d ? 2 : 0;
  if (limits.fix_mode == kOnly2d) {
    dimensions = std::min(dimensions, 2);
  }
  dimensions = std::min(dimensions, used >= 4 ? 3 : used == 3 ? 2 : 0);
  const auto strong = std::ranges::count_if(satellites, [&](const SatelliteView& view) {
    return view.tracked && view.cn0_dbhz >= limits.cn0_threshold_dbhz;
  });
  const bool only_3d =
      limits.fix_mode == kOnly3d || (configuration.expert().initial_fix_3d != 0 && !had_3d_fix_);
  if ((only_3d && dimensions == 2) || used < configuration.expert().minimum_satellites ||
      strong < limits.cn0_satellites || sample.time - searching_ < time_to_first_fix_) {
    return 0;
  }
  return dimensions;
}

bool UbloxNavigator::within_limits(const GnssSample& sample,
                                   const UbloxConfiguration& configuration) const {
  const auto& limits = configuration.navigation();
  const Dynamics& model = kDynamics[std::min<std::size_t>(limits.dynamic_model, 10)];
  const double accuracy_m = std::hypot(dilution_ratio_[0] * sample.horizontal_accuracy_m,
                                       dilution_ratio_[1] * sample.vertical_accuracy_m);
  const Vector3& v = sample.velocity_ned_mps;
  const double altitude_m = sample.ellipsoid_height_m - sample.geoid_separation_m;
  const bool outside =
      solution_.position_dilution * 10.0 > limits.position_dilution_mask_e1 ||
      accuracy_m > limits.position_accuracy_mask_m || altitude_m > model.altitude_m ||
      std::hypot(v.x, v.y) > model.horizontal_mps || std::abs(v.z) > model.vertical_mps;
  return !outside;
}

void UbloxNavigator::take(const GnssSample& sample, const UbloxConfiguration& configuration,
                          const UbloxNavigationFaults& faults) {
  UbloxSolution& s = solution_;
  s.sample = &sample;
  const bool tracking = std::ranges::any_of(sample.satellites, [&](const SatelliteView& view) {
    return view.tracked && configuration.enabled(view.system);
  });
  climb(sample, tracking);
  const bool frozen = faults.frozen && had_fix_;
  if (!frozen) {
    list_satellites(sample, configuration);
  }
  hear_leap_seconds(sample);
  set_time(s, calendar_, time_base(configuration, faults.leap_error_s), sample.time,
           sample.measured_after);
  const bool on_own_clock = sample.measured_after != 0ns || sample.clock_label_offset != 0ns;
  s.clock_bias_s = on_own_clock ? to_seconds(sample.clock_label_offset - sample.measured_after)
                                : sample.clock_bias_s;
  s.clock_drift = sample.clock_drift;
  if (frozen) {
    return;
  }
  s.dimensions = dimensions_of(sample, configuration);
  s.geoid_separation_m = sample.geoid_separation_m;
  take_dilutions(sample);
  s.fix_ok = s.dimensions > 0 && within_limits(sample, configuration);
  security_.look(sample.time, s.satellites, sample.radio, s.fix_ok,
                 configuration.present().jamming_sensitive != 0);
  s.spoofing = security_.spoofing_now();
  if (s.dimensions == 0) {
    lose_position(sample, configuration);
    return;
  }
  if (s.first_fix_ms == 0) {
    s.first_fix_ms = std::max(1U, s.since_start_ms);
  }
  had_fix_ = true;
  had_3d_fix_ |= s.dimensions == 3;
  take_position(sample, configuration);
}

void UbloxNavigator::take_dilutions(const GnssSample& sample) {
  UbloxSolution& s = solution_;
  auto used = static_cast<int>(std::ranges::count_if(s.satellites, is_satellite_used));
  // Just before the first fix: three orbits are there, and their geometry.
  const bool preliminary =
      s.orbits_known && sample.time - searching_ < time_to_first_fix_ && used >= 3;
  if (s.dimensions == 0) {
    int left = preliminary ? 3 : 0;
    for (auto& view : s.satellites) {
      view.used = view.used && left > 0;
      left -= view.used ? 1 : 0;
    }
    used = std::min(used, preliminary ? 3 : 0);
  }
  s.satellites_used = used;
  const bool shown = s.dimensions > 0 || preliminary;
  dilution_ratio_ = {1.0, 1.0, 1.0};
  const auto of_sample = std::ranges::count_if(sample.satellites, is_satellite_used);
  const bool fewer = shown && used < of_sample;
  if (fewer) {
    const auto here = geometry_of(s.satellites);
    const auto there = geometry_of(sample.satellites);
    if (here && there) {
      const bool height = here->vertical > 0.0 && there->vertical > 0.0;
      dilution_ratio_ = {here->horizontal / there->horizontal,
                         height ? here->vertical / there->vertical : 1.0, here->time / there->time};
    }
  }
  const auto& [horizontal, vertical, time] = dilution_ratio_;
  s.horizontal_dilution = shown ? horizontal * sample.horizontal_dilution : kNone;
  s.vertical_dilution = shown ? vertical * sample.vertical_dilution : kNone;
  s.position_dilution = shown ? sample.position_dilution : kNone;
  if (fewer) {
    s.position_dilution =
        used == 3 ? s.horizontal_dilution : std::hypot(s.horizontal_dilution, s.vertical_dilution);
  }
  s.time_dilution = shown ? time * sample.time_dilution : kNone;
  s.north_dilution = shown ? horizontal * sample.north_dilution : kNone;
  s.east_dilution = shown ? horizontal * sample.east_dilution : kNone;
  if (!hearing_orbits_) {
    dilution_ratio_ = {1.0, 1.0, 1.0};
  }
}

void UbloxNavigator::lose_position(const GnssSample& sample,
                                   const UbloxConfiguration& configuration) {
  UbloxSolution& s = solution_;
  const bool predicted = sample.predicted && had_fix_;
  s.velocity_ned_mps = predicted ? sample.velocity_ned_mps : Vector3{};
  s.speed_mps = std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y, s.velocity_ned_mps.z);
  counted_ = kNever;
  had_course_ = false;
  anchor_.reset();
  s.heading_frozen = true;
  s.heading_accuracy_deg = 180.0;
  s.differential = false;
  s.differential_age_s.reset();
  s.carrier = CarrierSolution::none;
  hold_.reset();
  if (predicted) {
    s.horizontal_accuracy_m = sample.horizontal_accuracy_m;
    s.vertical_accuracy_m = sample.vertical_accuracy_m;
    s.speed_accuracy_mps = sample.speed_accuracy_mps;
    s.position_covariance_ned_m2 = sample.position_covariance_ned_m2;
  } else if (had_fix_) {
    // Without a fix accuracy decays linearly in time.
    const double grown_m =
        kDriftingAccuracy_mps * configuration.rate().measurement_period_ms * 1e-3;
    s.horizontal_accuracy_m += grown_m;
    s.vertical_accuracy_m += grown_m;
  }
}

void UbloxNavigator::take_position(const GnssSample& sample,
                                   const UbloxConfiguration& configuration) {
  UbloxSolution& s = solution_;
  const auto& limits = configuration.navigation();
  s.has_position = true;
  s.latitude_deg = sample.latitude_deg;
  s.longitude_deg = sample.longitude_deg;
  s.ellipsoid_height_m = limits.fix_mode == kOnly2d
                             ? limits.fixed_altitude_cm * 0.01 + sample.geoid_separation_m
                             : sample.ellipsoid_height_m;
  s.velocity_ned_mps = sample.velocity_ned_mps;
  const auto& [horizontal, vertical, time] = dilution_ratio_;
  s.horizontal_accuracy_m = horizontal * sample.horizontal_accuracy_m;
  s.vertical_accuracy_m = vertical * sample.vertical_accuracy_m;
  s.speed_accuracy_mps = std::max(horizontal, vertical) * sample.speed_accuracy_mps;
  s.time_accuracy_s = time * sample.time_accuracy_s;
  s.position_covariance_ned_m2 = sample.position_covariance_ned_m2;
  if (s.position_covariance_ned_m2 == std::array<double, 6>{}) {
    const double axis_m2 = 0.5 * s.horizontal_accuracy_m * s.horizontal_accuracy_m;
    s.position_covariance_ned_m2 = {axis_m2, 0.0, 0.0,
                                    axis_m2, 0.0, s.vertical_accuracy_m * s.vertical_accuracy_m};
  } else {
    const double down = horizontal * vertical;
    const std::array<double, 6> scale{
        horizontal * horizontal, horizontal * horizontal, down, horizontal * horizontal, down,
        vertical * vertical};
    for (std::size_t i = 0; i < scale.size(); ++i) {
      s.position_covariance_ned_m2[i] *= scale[i];
    }
  }
  const auto& sbas = configuration.sbas();
  constexpr std::uint8_t kEnabled = 0x01;
  constexpr std::uint8_t kCorrections = 0x02;
  const bool rtk = configuration.profile().carrier_solution;
  const bool by_sbas = (sbas.mode & kEnabled) != 0 && (sbas.usage & kCorrections) != 0 &&
                       configuration.enabled(GnssSystem::sbas);
  s.carrier = rtk ? sample.carrier : CarrierSolution::none;
  s.differential = sample.differential && (rtk || by_sbas);
  // The age is that of a base station's corrections; none is reported for SBAS (recordings of a
  // NEO-7P: 3890 of 3890 sentences).
  s.differential_age_s =
      s.carrier != CarrierSolution::none ? sample.differential_age_s : std::nullopt;
  hold_position(limits);
  filter_speed(configuration.odometer());
  take_course(sample.time, configuration.odometer());
  count_distance(sample.time, configuration.odometer());
}

void UbloxNavigator::set_own_place(const UbloxSurvey& survey,
                                   const std::optional<std::array<double, 3>>& place_E_m) {
  UbloxSolution& s = solution_;
  s.survey = survey;
  s.time_only = place_E_m && s.dimensions > 0;
  if (!s.time_only) {
    return;
  }
  const Geodetic place = geodetic_from_ecef(*place_E_m);
  s.latitude_deg = place.latitude_deg;
  s.longitude_deg = place.longitude_deg;
  s.ellipsoid_height_m = place.ellipsoid_height_m;
  s.velocity_ned_mps = {};
  s.speed_mps = 0.0;
  s.carrier = CarrierSolution::none;
  s.differential = false;
  s.differential_age_s.reset();
  s.base.reset();
}

void UbloxNavigator::filter_speed(const protocols::ubx::CfgOdo& odometer) {
  UbloxSolution& s = solution_;
  const Vector3& v = s.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y, v.z);
  const bool begun = counted_ != kNever;
  if ((odometer.flags & protocols::ubx::kOdoFilteredSpeed) == 0 || !begun) {
    s.speed_mps = speed_mps;
    return;
  }
  // The level is that of speeds below 5 m/s; above them the filter grows weaker with the speed.
  constexpr double kNominal_mps = 5.0;
  const double share =
      std::min(1.0, filter_share(odometer.speed_gain) * std::max(1.0, speed_mps / kNominal_mps));
  s.speed_mps += share * (speed_mps - s.speed_mps);
}

void UbloxNavigator::count_distance(SimTime now, const protocols::ubx::CfgOdo& odometer) {
  const SimTime before = std::exchange(counted_, now);
  if (before == kNever || !solution_.fix_ok || (odometer.flags & protocols::ubx::kOdoUse) == 0) {
    return;
  }
  // Speeds that could be noise do not count: so many standard deviations, by profile.
  constexpr std::array<double, 5> kDoubtful{3.0, 2.0, 1.0, 2.0, 2.0};
  UbloxSolution& s = solution_;
  const Vector3& v = s.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y);
  const double axis_mps = s.speed_accuracy_mps / std::numbers::sqrt3;
  if (speed_mps < kDoubtful[std::min<std::size_t>(odometer.profile, 4)] * axis_mps) {
    return;
  }
  const double step_s = to_seconds(now - before);
  s.distance_m += speed_mps * step_s;
  s.total_distance_m += speed_mps * step_s;
  s.distance_accuracy_m = std::hypot(s.distance_accuracy_m, axis_mps * step_s);
}

void UbloxNavigator::reset_odometer() {
  solution_.distance_m = 0.0;
  solution_.distance_accuracy_m = 0.0;
}

void UbloxNavigator::hold_position(const CfgNav5& limits) {
  UbloxSolution& s = solution_;
  const Vector3& v = s.velocity_ned_mps;
  const double threshold_mps = limits.static_hold_cmps * 0.01;
  if (std::hypot(v.x, v.y) >= threshold_mps) {
    hold_.reset();
    return;
  }
  if (hold_ && limits.static_hold_distance_m > 0 &&
      distance_m(hold_->latitude_deg, hold_->longitude_deg, s.latitude_deg, s.longitude_deg) >
          limits.static_hold_distance_m) {
    hold_.reset();
  }
  if (!hold_) {
    hold_ = Hold{s.latitude_deg, s.longitude_deg, s.ellipsoid_height_m};
  }
  s.latitude_deg = hold_->latitude_deg;
  s.longitude_deg = hold_->longitude_deg;
  s.ellipsoid_height_m = hold_->ellipsoid_height_m;
  s.velocity_ned_mps = {};
}

// Low-speed course over ground filter: "derives the course over ground from position at very low
// speed" (UBX-18010802, 3.1.8.3.3). The way over which it does is not documented: a quarter of the
// accuracy here, which a standing receiver does not wander within the time, and never below 5 cm.
bool UbloxNavigator::take_slow_course(SimTime now, const protocols::ubx::CfgOdo& odometer,
                                      double speed_mps) {
  constexpr double kLeastWay_m = 0.05;
  constexpr double kWayOfAccuracy = 0.25;
  constexpr double kNoiseOfAccuracy = 0.05;
  constexpr Duration kLongest = 10s;
  UbloxSolution& s = solution_;
  if ((odometer.flags & protocols::ubx::kOdoLowSpeedCourse) == 0 ||
      speed_mps >= odometer.course_speed_dmps * 0.1 ||
      s.horizontal_accuracy_m > odometer.course_accuracy_m) {
    anchor_.reset();
    return false;
  }
  const Anchor here{s.latitude_deg, s.longitude_deg, now};
  if (!anchor_) {
    anchor_ = here;
    return false;
  }
  const double way_m = distance_m(anchor_->latitude_deg, anchor_->longitude_deg, here.latitude_deg,
                                  here.longitude_deg);
  if (way_m >= std::max(kLeastWay_m, kWayOfAccuracy * s.horizontal_accuracy_m)) {
    const double north_deg = here.latitude_deg - anchor_->latitude_deg;
    const double east_deg = std::remainder(here.longitude_deg - anchor_->longitude_deg, 360.0) *
                            std::cos(here.latitude_deg * kDegree);
    s.heading_deg = std::fmod(std::atan2(east_deg, north_deg) / kDegree + 360.0, 360.0);
    s.heading_accuracy_deg =
        std::atan2(kNoiseOfAccuracy * s.horizontal_accuracy_m, way_m) / kDegree;
    s.heading_frozen = false;
    had_course_ = true;
    anchor_ = here;
    return true;
  }
  if (now - anchor_->since >= kLongest) {
    anchor_ = here;  // stationary
    return false;
  }
  // On its way from there: the course is the last one, if it has had one since it is slow.
  return !s.heading_frozen;
}

void UbloxNavigator::take_course(SimTime now, const protocols::ubx::CfgOdo& odometer) {
  UbloxSolution& s = solution_;
  const Vector3& v = s.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y);
  if (take_slow_course(now, odometer, speed_mps)) {
    return;
  }
  const double axis_mps = s.speed_accuracy_mps / std::numbers::sqrt3;
  // Course's uncertainty: the angle of one axis's speed error against the speed.
  const double uncertainty_deg = std::atan2(axis_mps, speed_mps) / kDegree;
  s.heading_frozen = speed_mps < kFrozenSpeed_mps || uncertainty_deg > kFrozenCourse_deg;
  if (s.heading_frozen) {
    s.heading_accuracy_deg = 180.0;
    return;
  }
  constexpr double kFilteredBelow_mps = 8.0;
  const bool filtered = (odometer.flags & protocols::ubx::kOdoFilteredCourse) != 0 && had_course_ &&
                        speed_mps < kFilteredBelow_mps;
  const double course_deg = std::atan2(v.y, v.x) / kDegree;
  const double share = filtered ? filter_share(odometer.course_gain) : 1.0;
  s.heading_accuracy_deg = uncertainty_deg;
  s.heading_deg = filtered
                      ? s.heading_deg + share * std::remainder(course_deg - s.heading_deg, 360.0)
                      : course_deg;
  s.heading_deg = std::fmod(s.heading_deg + 360.0, 360.0);
  had_course_ = true;
}

void UbloxNavigator::aid_position(const Geodetic& position, double accuracy_m) {
  UbloxSolution& s = solution_;
  if (s.dimensions > 0) {
    return;
  }
  s.has_position = true;
  s.latitude_deg = position.latitude_deg;
  s.longitude_deg = position.longitude_deg;
  s.ellipsoid_height_m = position.ellipsoid_height_m;
  s.horizontal_accuracy_m = s.vertical_accuracy_m = accuracy_m;
}

void UbloxNavigator::aid_time(SimTime now, const UbloxConfiguration& configuration) {
  solution_.time_known = true;
  solution_.date_known = true;
  set_time(solution_, calendar_, time_base(configuration, 0), now, Duration{0});
}

}  // namespace rigwire::emulators
