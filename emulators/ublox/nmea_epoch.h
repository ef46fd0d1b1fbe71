// The solution in the words of the NMEA writers, as CFG-NMEA wants it.
#pragma once

#include <vector>

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/solution.h"
#include "protocols/nmea/epoch.h"
#include "protocols/nmea/writers.h"

namespace rigwire::emulators {

/// `list` holds the epoch's satellites.
[[nodiscard]] protocols::nmea::Epoch nmea_epoch(
    const UbloxSolution& solution, const UbloxConfiguration& configuration,
    std::vector<protocols::nmea::SatelliteInView>& list);

/// What PUBX,04 says besides.
[[nodiscard]] protocols::nmea::PubxTime pubx_time(const UbloxSolution& solution);

}  // namespace rigwire::emulators
