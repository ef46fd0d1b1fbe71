#include "sim/gnss/gnss_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kCepPerSigma = 1.1774;  // sqrt(2 ln 2), circular normal distribution
constexpr double kDriftCorrelation_s = 100.0;
constexpr double kWarmUpBias_s = 1e-4;

void check(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(std::string("gnss: ") + name + " is " + std::to_string(value) +
                                ", allowed are " + std::to_string(lower) + " .. " +
                                std::to_string(upper));
  }
}

/// Exact step of a first-order Gauss-Markov process of sigma 1.
double gauss_markov(double state, double step_s, double correlation_s, double white) {
  if (correlation_s <= 0.0) {
    return white;
  }
  const double keep = std::exp(-step_s / correlation_s);
  return keep * state + std::sqrt(1.0 - keep * keep) * white;
}

}  // namespace

void validate(const GnssParameters& p) {
  check("elevation_mask_deg", p.elevation_mask_deg, 0.0, 89.0);
  check("antenna_clearance_m", p.antenna_clearance_m, 0.0, 100.0);
  check("circular_error_m", p.circular_error_m, 0.0, 1000.0);
  check("correlation_time_s", p.correlation_time_s, 0.0, 86'400.0);
  check("speed_sigma_mps", p.speed_sigma_mps, 0.0, 100.0);
  check("cn0_zenith_dbhz", p.cn0_zenith_dbhz, 0.0, 99.0);
  check("cn0_horizon_dbhz", p.cn0_horizon_dbhz, 0.0, 99.0);
  check("cn0_threshold_dbhz", p.cn0_threshold_dbhz, 0.0, 99.0);
  check("maximum_channels", p.maximum_channels, 1.0, double{kGpsSlots});
  check("clock_drift", p.clock_drift, -1e-4, 1e-4);
  check("clock_drift_sigma", p.clock_drift_sigma, 0.0, 1e-4);
}

GnssFix fix_by_count(int satellites) {
  if (satellites <= 1) {
    return GnssFix::none;
  }
  if (satellites <= 2) {
    return GnssFix::bad;
  }
  return satellites <= 3 ? GnssFix::two_d : GnssFix::three_d;
}

GnssSensor::GnssSensor(const GnssParameters& parameters, const Calendar& calendar,
                       const LocalFrame& frame, std::uint64_t seed, std::string_view name)
    : parameters_(parameters),
      calendar_(calendar),
      frame_(frame),
      dilution_(make_dilution(parameters.dilution)),
      random_(seed, name) {
  validate(parameters_);
  directions_enu_.reserve(kGpsSlots);
}

void GnssSensor::advance_errors(SimTime time) {
  // The same draws at every epoch, whatever is visible: one device's sky never shifts its noise.
  const Eigen::Vector3d white(random_.gaussian(), random_.gaussian(), random_.gaussian());
  const double white_drift = random_.gaussian();
  if (last_ == kNever) {
    unit_error_ = white;
    unit_drift_ = white_drift;
    clock_bias_s_ = random_.uniform(-kWarmUpBias_s, kWarmUpBias_s);
  } else {
    const double step_s = to_seconds(time - last_);
    for (int axis = 0; axis < 3; ++axis) {
      unit_error_(axis) =
          gauss_markov(unit_error_(axis), step_s, parameters_.correlation_time_s, white(axis));
    }
    clock_bias_s_ +=
        step_s * (parameters_.clock_drift + parameters_.clock_drift_sigma * unit_drift_);
    unit_drift_ = gauss_markov(unit_drift_, step_s, kDriftCorrelation_s, white_drift);
  }
  last_ = time;
}

void GnssSensor::view_satellites(SimTime time, const Eigen::Vector3d& p_W,
                                 const Visibility& visibility, GnssSample& sample) {
  const Eigen::Vector3d p_E = frame_.to_ecef(p_W);
  const Eigen::Matrix3d ned_from_world = frame_.ned_from_world(p_W);
  const auto constellation = gps_constellation_ecef(calendar_.gps(time));
  std::uint32_t tracked = 0;
  for (std::size_t slot = 0; slot < kGpsSlots; ++slot) {
    const Eigen::Vector3d direction_W =
        (frame_.world_from_ecef() * (constellation[slot] - p_E)).normalized();
    const Eigen::Vector3d ned = ned_from_world * direction_W;
    const double elevation = std::asin(std::clamp(-ned.z(), -1.0, 1.0));
    if (elevation <= 0.0) {
      continue;
    }
    SatelliteView view;
    view.number = static_cast<std::uint8_t>(slot + 1);
    view.elevation_rad = elevation;
    view.azimuth_rad = std::atan2(ned.y(), ned.x());
    if (view.azimuth_rad < 0.0) {
      view.azimuth_rad += 2.0 * std::numbers::pi;
    }
    const double cn0_dbhz =
        parameters_.cn0_horizon_dbhz +
        (parameters_.cn0_zenith_dbhz - parameters_.cn0_horizon_dbhz) * std::sin(elevation);
    if (cn0_dbhz >= parameters_.cn0_threshold_dbhz && tracked < parameters_.maximum_channels &&
        !visibility.blocked(p_W, direction_W, parameters_.antenna_clearance_m)) {
      ++tracked;
      view.tracked = true;
      view.cn0_dbhz = cn0_dbhz;
      view.used = elevation >= parameters_.elevation_mask_deg * kDegree;
    }
    if (view.used) {
      directions_enu_.emplace_back(ned.y(), ned.x(), -ned.z());
    }
    sample.satellites.push_back(view);
  }
}

bool GnssSensor::quadrants_filled(const GnssSample& sample) const {
  const double turn = parameters_.quadrant_rule == QuadrantRule::cardinal ? 45.0 * kDegree : 0.0;
  std::array<bool, 4> filled{};
  for (const auto& satellite : sample.satellites) {
    if (satellite.used) {
      const double quarter = (satellite.azimuth_rad + turn) / (0.5 * std::numbers::pi);
      filled[static_cast<std::size_t>(quarter) % 4] = true;
    }
  }
  return std::ranges::all_of(filled, [](bool one) { return one; });
}

GnssSample GnssSensor::sample(SimTime time, const LinkMotion& antenna,
                              const Visibility& visibility) {
  advance_errors(time);
  const Eigen::Vector3d white_velocity(random_.gaussian(), random_.gaussian(), random_.gaussian());

  GnssSample sample;
  sample.time = time;
  sample.satellites.reserve(kGpsSlots / 2);
  directions_enu_.clear();
  const Eigen::Vector3d p_W = antenna.X_WL.translation();
  view_satellites(time, p_W, visibility, sample);

  sample.geoid_separation_m = frame_.geoid_separation_m();
  sample.clock_bias_s = clock_bias_s_;
  sample.clock_drift = parameters_.clock_drift + parameters_.clock_drift_sigma * unit_drift_;
  sample.fix = fix_by_count(static_cast<int>(directions_enu_.size()));
  if (sample.fix == GnssFix::none || sample.fix == GnssFix::bad) {
    for (auto& satellite : sample.satellites) {
      satellite.used = false;
    }
    return sample;
  }
  if (sample.fix == GnssFix::three_d && parameters_.quadrant_rule != QuadrantRule::off &&
      !quadrants_filled(sample)) {
    sample.fix = GnssFix::two_d;
  }

  const Dilution reported = dilution_->reported(directions_enu_);
  const Dilution amplitude = dilution_->amplitude(directions_enu_);
  if (!std::isfinite(amplitude.horizontal)) {  // the satellites lie on a cone
    sample.fix = GnssFix::none;
    return sample;
  }
  sample.horizontal_dilution = reported.horizontal;
  sample.vertical_dilution = reported.vertical;
  sample.position_dilution = reported.position;
  sample.time_dilution = reported.time;
  if (parameters_.dilution == DilutionKind::regression && sample.fix == GnssFix::two_d) {
    sample.position_dilution = 0.0;  // the paper's rule for 2D
  }

  // Per unit of horizontal dilution; a held height keeps the horizontal scale.
  const double range_sigma_m = parameters_.circular_error_m / kCepPerSigma;
  const double vertical =
      std::isfinite(amplitude.vertical) ? amplitude.vertical : amplitude.horizontal;
  const double horizontal_sigma_m = amplitude.horizontal * range_sigma_m / std::numbers::sqrt2;
  const double vertical_sigma_m = vertical * range_sigma_m;
  const Eigen::Vector3d error_W(horizontal_sigma_m * unit_error_.x(),
                                horizontal_sigma_m * unit_error_.y(),
                                vertical_sigma_m * unit_error_.z());
  // The error is east-north-up at the antenna, so it is turned into W before it is added.
  const Eigen::Matrix3d ned_from_world = frame_.ned_from_world(p_W);
  const Eigen::Vector3d error_ned(error_W.y(), error_W.x(), -error_W.z());
  const GeodeticPoint point = frame_.to_geodetic(p_W + ned_from_world.transpose() * error_ned);
  sample.latitude_deg = point.latitude_deg;
  sample.longitude_deg = point.longitude_deg;
  sample.ellipsoid_height_m = point.ellipsoid_height_m;

  const double speed_sigma = parameters_.speed_sigma_mps * amplitude.horizontal;
  const Eigen::Vector3d v_ned = ned_from_world * antenna.v_WL_W + speed_sigma * white_velocity;
  sample.velocity_ned_mps = {v_ned.x(), v_ned.y(), v_ned.z()};

  sample.horizontal_accuracy_m = horizontal_sigma_m * std::numbers::sqrt2;
  sample.vertical_accuracy_m = vertical_sigma_m;
  sample.speed_accuracy_mps = speed_sigma * std::sqrt(3.0);
  sample.time_accuracy_s = amplitude.time * range_sigma_m / kLightSpeed_mps;
  return sample;
}

}  // namespace rigwire::sim
