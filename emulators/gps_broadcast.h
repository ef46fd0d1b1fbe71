// Broadcast navigation data between the samples of the simulation and the GPS message. Both sides
// hold SI units and radians, so nothing is lost either way.
#pragma once

#include "protocols/gps/broadcast.h"
#include "sim/samples/gps_navigation.h"

namespace rigwire::emulators {

[[nodiscard]] protocols::gps::Ephemeris to_message(const GpsEphemeris& ephemeris);
[[nodiscard]] protocols::gps::IonosphereUtc to_message(const KlobucharParameters& ionosphere,
                                                       const GpsUtcParameters& utc);

/// Everything, with the almanac that follows from the ephemerides (protocols::gps::derive_almanac).
[[nodiscard]] protocols::gps::Broadcast to_message(const GpsNavigation& navigation);

/// The way back, for orbits out of files.
[[nodiscard]] GpsEphemeris to_sample(const protocols::gps::Ephemeris& ephemeris);
[[nodiscard]] KlobucharParameters klobuchar_of(const protocols::gps::IonosphereUtc& parameters);
[[nodiscard]] GpsUtcParameters utc_of(const protocols::gps::IonosphereUtc& parameters);

}  // namespace rigwire::emulators
