// The navigation satellites over a rig, the same for all of its receivers.
#pragma once

#include <string>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::hil {

struct SatellitesConfiguration {
  /// In their published nominal slots; without a file.
  std::vector<std::string> systems{"gps", "sbas", "galileo", "beidou", "qzss", "glonass"};
  std::string file;  ///< GPS alone, from a RINEX navigation file or a YUMA almanac.
};
void visit(fields::Visitor& v, SatellitesConfiguration& p);

/// Throws std::invalid_argument for unknown or no systems.
void validate(const SatellitesConfiguration& configuration);

/// Throws as validate().
[[nodiscard]] std::vector<GnssSystem> systems_of(const SatellitesConfiguration& configuration);

}  // namespace rigwire::hil
