// The constellation of a rig, from nominal slots or from a file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "fields/rules.h"
#include "sim/gnss/constellation.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::hil {

struct SatellitesConfiguration {
  /// Systems in their published nominal slots; used without a file.
  std::vector<std::string> systems{"gps", "sbas", "galileo", "beidou", "qzss", "glonass"};
  std::string file;  ///< GPS alone, from a RINEX navigation file or a YUMA almanac.
};
void visit(fields::Visitor& v, SatellitesConfiguration& p);

/// Throws std::invalid_argument for unknown or no systems.
void validate(const SatellitesConfiguration& configuration);

/// Throws as validate().
[[nodiscard]] std::vector<GnssSystem> systems_of(const SatellitesConfiguration& configuration);

/// Reads GPS satellites from a RINEX navigation file (2.x, 3.x) or a YUMA almanac; the first line
/// shows which. Weeks that a YUMA file states modulo 1024 are taken near `start`; so is UTC when
/// the file does not give it. A file of another date is shifted to the rig's: orbits keep their
/// shape, so that over months they are plausible, not true. Throws std::invalid_argument naming the
/// file, and the line where there is one.
[[nodiscard]] std::shared_ptr<const sim::Constellation> load_satellites(
    const std::filesystem::path& file, const Calendar& start);

[[nodiscard]] std::shared_ptr<const sim::Constellation> make_satellites(
    const SatellitesConfiguration& configuration, const Calendar& start);

}  // namespace rigwire::hil
