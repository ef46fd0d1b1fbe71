#include "emulators/gps_broadcast.h"

namespace rigwire::emulators {
namespace {

using protocols::gps::Broadcast;
using protocols::gps::Ephemeris;
using protocols::gps::IonosphereUtc;

// The members that both have under the same name.
template <class To, class From>
To same_members(const From& from) {
  To to;
  to.prn = from.prn;
  to.week = from.week;
  to.issue_of_clock = from.issue_of_clock;
  to.issue_of_ephemeris = from.issue_of_ephemeris;
  to.accuracy_index = from.accuracy_index;
  to.health = from.health;
  to.group_delay_s = from.group_delay_s;
  to.second_delay_s = from.second_delay_s;
  to.clock_time_s = from.clock_time_s;
  to.clock_bias_s = from.clock_bias_s;
  to.clock_drift = from.clock_drift;
  to.clock_drift_rate = from.clock_drift_rate;
  to.ephemeris_time_s = from.ephemeris_time_s;
  to.sqrt_semi_major_axis = from.sqrt_semi_major_axis;
  to.eccentricity = from.eccentricity;
  to.mean_anomaly_rad = from.mean_anomaly_rad;
  to.mean_motion_difference = from.mean_motion_difference;
  to.ascending_node_rad = from.ascending_node_rad;
  to.inclination_rad = from.inclination_rad;
  to.argument_of_perigee_rad = from.argument_of_perigee_rad;
  to.ascending_node_rate = from.ascending_node_rate;
  to.inclination_rate = from.inclination_rate;
  to.latitude_cosine_rad = from.latitude_cosine_rad;
  to.latitude_sine_rad = from.latitude_sine_rad;
  to.radius_cosine_m = from.radius_cosine_m;
  to.radius_sine_m = from.radius_sine_m;
  to.inclination_cosine_rad = from.inclination_cosine_rad;
  to.inclination_sine_rad = from.inclination_sine_rad;
  return to;
}

}  // namespace

Ephemeris to_message(const GpsEphemeris& ephemeris) {
  return same_members<Ephemeris>(ephemeris);
}

GpsEphemeris to_sample(const Ephemeris& ephemeris) {
  return same_members<GpsEphemeris>(ephemeris);
}

IonosphereUtc to_message(const KlobucharParameters& ionosphere, const GpsUtcParameters& utc) {
  return {.alpha = ionosphere.alpha,
          .beta = ionosphere.beta,
          .utc_a0_s = utc.a0_s,
          .utc_a1 = utc.a1,
          .utc_reference_time_s = utc.reference_time_s,
          .utc_reference_week = utc.reference_week,
          .leap_seconds = utc.leap_seconds,
          .leap_week = utc.leap_week,
          .leap_day = utc.leap_day,
          .leap_seconds_future = utc.leap_seconds_future};
}

KlobucharParameters klobuchar_of(const IonosphereUtc& parameters) {
  return {.alpha = parameters.alpha, .beta = parameters.beta};
}

GpsUtcParameters utc_of(const IonosphereUtc& parameters) {
  return {.a0_s = parameters.utc_a0_s,
          .a1 = parameters.utc_a1,
          .reference_time_s = parameters.utc_reference_time_s,
          .reference_week = parameters.utc_reference_week,
          .leap_seconds = parameters.leap_seconds,
          .leap_week = parameters.leap_week,
          .leap_day = parameters.leap_day,
          .leap_seconds_future = parameters.leap_seconds_future};
}

Broadcast to_message(const GpsNavigation& navigation) {
  Broadcast broadcast;
  for (std::size_t i = 0; i < navigation.ephemerides.size(); ++i) {
    if (navigation.ephemerides[i]) {
      broadcast.ephemerides[i] = to_message(*navigation.ephemerides[i]);
    }
  }
  broadcast.ionosphere_utc = to_message(navigation.ionosphere, navigation.utc);
  derive_almanac(broadcast);
  return broadcast;
}

}  // namespace rigwire::emulators
