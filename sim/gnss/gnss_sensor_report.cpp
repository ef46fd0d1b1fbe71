// What a GNSS sensor puts into its sample once the epoch is solved: position, satellites, raw
// measurements.
#include <cmath>
#include <numbers>

#include "sim/gnss/gnss_sensor.h"

namespace rigwire::sim {

void GnssSensor::put_carrier(Epoch& epoch, GnssSample& sample) const {
  const CorrectionOutput& corrections = epoch.corrections;
  if (!corrections.error_ned_m || sample.fix != GnssFix::three_d || epoch.fault.spoofed) {
    return;
  }
  sample.carrier = corrections.carrier;
  epoch.error_ned_m = *corrections.error_ned_m;
  const double horizontal_m2 = corrections.horizontal_sigma_m * corrections.horizontal_sigma_m;
  const double vertical_m2 = corrections.vertical_sigma_m * corrections.vertical_sigma_m;
  sample.position_covariance_ned_m2 = {horizontal_m2, 0.0, 0.0, horizontal_m2, 0.0, vertical_m2};
  sample.horizontal_accuracy_m = std::sqrt(2.0 * horizontal_m2);
  sample.vertical_accuracy_m = corrections.vertical_sigma_m;
}

void GnssSensor::put_position(const Epoch& epoch, GnssSample& sample) const {
  const double switched = parameters_.errors ? 1.0 : 0.0;
  // A held height is off even without range errors.
  const Eigen::Vector3d error_ned_m =
      parameters_.error_model == ErrorModel::coloured && sample.carrier == CarrierSolution::none
          ? epoch.error_ned_m
          : Eigen::Vector3d(switched * epoch.error_ned_m);
  const GeodeticPoint point = frame_.to_geodetic(epoch.reception.ranges_p_W +
                                                 epoch.ned_from_world.transpose() * error_ned_m);
  sample.latitude_deg = point.latitude_deg;
  sample.longitude_deg = point.longitude_deg;
  sample.ellipsoid_height_m = point.ellipsoid_height_m;
  sample.geoid_separation_m = frame_.geoid_separation_m(point.latitude_deg, point.longitude_deg);
  const Eigen::Vector3d error_mps = parameters_.error_model == ErrorModel::coloured
                                        ? epoch.velocity_error_ned_mps
                                        : Eigen::Vector3d(switched * epoch.velocity_error_ned_mps);
  const Eigen::Vector3d v_ned = epoch.ned_from_world * epoch.v_W + error_mps;
  sample.velocity_ned_mps = {v_ned.x(), v_ned.y(), v_ned.z()};
}

void GnssSensor::put_satellites(std::span<const ReceivedSatellite> received, const Epoch& epoch,
                                GnssSample& sample) const {
  const bool fixed = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
  sample.satellites.reserve(received.size());
  std::size_t used = 0;
  for (const ReceivedSatellite& satellite : received) {
    SatelliteView& view = sample.satellites.emplace_back();
    view.system = satellite.satellite.system;
    view.number = satellite.satellite.number;
    view.azimuth_rad = satellite.azimuth_rad;
    view.elevation_rad = satellite.elevation_rad;
    view.cn0_dbhz = satellite.cn0_dbhz;
    view.tracked = satellite.tracked;
    if (satellite.usable) {
      view.used = fixed;
      view.residual_m = fixed && used < residuals_m_.size() ? residuals_m_[used] : 0.0;
      ++used;
    }
    view.corrected = view.used && epoch.corrections.differential;
  }
}

void GnssSensor::measure(std::span<const ReceivedSatellite> received, const Epoch& epoch,
                         GnssSample& sample) {
  const Reception& reception = epoch.reception;
  const GeodeticPoint point = frame_.to_geodetic(reception.ranges_p_W);
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double latitude = point.latitude_deg * kDegree;
  const double longitude = point.longitude_deg * kDegree;
  const double time_of_week_s = static_cast<double>(reception.gps.time_of_week_ns) * 1e-9;
  signals_.clear();
  for (const ReceivedSatellite& satellite : received) {
    if (!satellite.tracked || satellite.satellite.system != GnssSystem::gps) {
      continue;
    }
    TrackedSignal signal;
    signal.satellite = satellite.index;
    signal.cn0_dbhz = satellite.cn0_dbhz;
    if (parameters_.ionosphere && sample.navigation != nullptr) {
      signal.ionosphere_m =
          klobuchar_delay_m(sample.navigation->ionosphere, latitude, longitude,
                            satellite.azimuth_rad, satellite.elevation_rad, time_of_week_s);
    }
    if (parameters_.troposphere) {
      signal.troposphere_m =
          saastamoinen_delay_m(latitude, point.ellipsoid_height_m, satellite.elevation_rad);
    }
    if (parameters_.error_model == ErrorModel::coloured) {
      const RangeError& error = satellite.error;
      signal.ionosphere_m += error.ionosphere_m;
      signal.troposphere_m += error.troposphere_m;
      // Code has orbit, detour and local errors; the carrier none of the local ones.
      signal.code_error_m = error.orbit_clock_m + error.detour_m + error.local_m;
      signal.carrier_error_m = error.orbit_clock_m + error.detour_m;
      signal.range_rate_error_mps = parameters_.speed_sigma_mps * error.rate_mps;
    }
    signal.code_error_m += epoch.fault.clock_offset_m;
    signal.carrier_error_m += epoch.fault.clock_offset_m;
    signal.range_rate_error_mps += epoch.fault.clock_offset_rate_mps;
    signal.slipped = satellite.slipped;
    signals_.push_back(signal);
  }
  const Eigen::Matrix3d ecef_from_world = frame_.world_from_ecef().transpose();
  observations_.measure(
      *constellation_, reception.time, epoch.clock,
      reception_point(reception.gps, epoch.clock, frame_.to_ecef(reception.ranges_p_W),
                      ecef_from_world * epoch.v_W),
      signals_, sample.measurements);
}

}  // namespace rigwire::sim
