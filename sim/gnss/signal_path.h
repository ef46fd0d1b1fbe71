// The way of one satellite signal to one antenna: everything that a pseudorange, a carrier phase
// and a Doppler shift are made of, errors of receiver and surroundings excepted.
//
//   pseudorange = range + c (receiver clock - satellite clock + group delay) + ionosphere +
//                 troposphere
//   carrier     = the same with the ionosphere negative and no group delay, over the wavelength
//
// The satellite is where it was at the time of transmission, found by iterating the time of flight
// to 1e-12 s, and turned with the earth during the flight (Sagnac): IS-GPS-200 section 20.3.3.4.3.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "sim/gnss/constellation.h"

namespace rigwire::sim {

/// An antenna at the instant of reception, true GPS time = time + offset_s, earth-fixed.
struct ReceptionPoint {
  GpsTime time;
  double offset_s = 0.0;  ///< |offset_s| <= 1e-2.
  Eigen::Vector3d position_E_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_E_mps = Eigen::Vector3d::Zero();
};

struct SignalPath {
  Eigen::Vector3d direction_E = Eigen::Vector3d::UnitZ();  ///< Unit, antenna to satellite.
  double range_m = 0.0;                ///< In the earth-fixed frame of reception.
  double range_rate_mps = 0.0;         ///< Positive while it grows.
  double satellite_clock_s = 0.0;      ///< Polynomial and relativity, at transmission.
  double satellite_clock_drift = 0.0;  ///< s/s.
  double group_delay_s = 0.0;          ///< Delay of the first carrier.
  double second_delay_s = 0.0;         ///< Delay of the second carrier.
  double flight_s = 0.0;               ///< Time of flight.
  bool healthy = true;
};

[[nodiscard]] SignalPath signal_path(const Constellation& constellation, std::size_t index,
                                     const ReceptionPoint& antenna);

/// Klobuchar's broadcast model, metres on L1: IS-GPS-200 section 20.3.3.5.2.5. Angles rad;
/// elevation above 0; `time_of_week_s` GPS.
[[nodiscard]] double klobuchar_delay_m(const KlobucharParameters& parameters, double latitude_rad,
                                       double longitude_rad, double azimuth_rad,
                                       double elevation_rad, double time_of_week_s);

/// Saastamoinen's model in the standard atmosphere with 70 % humidity, metres; 0 below the horizon
/// and outside -100 m .. 10 km: J. Saastamoinen, "Contributions to the theory of atmospheric
/// refraction", Bull. Geodesique 107, 1973.
[[nodiscard]] double saastamoinen_delay_m(double latitude_rad, double height_m,
                                          double elevation_rad);

}  // namespace rigwire::sim
