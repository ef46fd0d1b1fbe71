#include "hil/world/satellites_configuration.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::hil {
namespace {

/// Systems that have nominal slots.
constexpr std::array<fields::Choice<GnssSystem>, 6> kSatelliteSystems{
    {{GnssSystem::gps, "gps", "24 slots, with broadcast orbits and clocks."},
     {GnssSystem::sbas, "sbas", "Standing satellites of EGNOS, WAAS, MSAS, GAGAN."},
     {GnssSystem::galileo, "galileo", "Walker 24/3/1."},
     {GnssSystem::beidou, "beidou", "Medium orbits, Walker 24/3/1."},
     {GnssSystem::qzss, "qzss", "Three inclined, one standing."},
     {GnssSystem::glonass, "glonass", "Walker 24/3/1."}}};

}  // namespace

void visit(fields::Visitor& v, SatellitesConfiguration& p) {
  v.file("file", p.file, "RINEX navigation file or YUMA almanac of GPS; empty = nominal slots.");
  if (p.file.empty()) {
    v.texts("systems", p.systems,
            "Systems in nominal slots: gps sbas galileo beidou qzss glonass.");
  } else {
    v.refused("systems", "the satellites come from a file, which holds GPS; leave one of both out");
  }
}

std::vector<GnssSystem> systems_of(const SatellitesConfiguration& p) {
  std::vector<GnssSystem> systems;
  for (const std::string& name : p.systems) {
    const auto found = std::ranges::find(kSatelliteSystems, std::string_view(name),
                                         &fields::Choice<GnssSystem>::name);
    if (found == kSatelliteSystems.end()) {
      throw std::invalid_argument("systems has \"" + name +
                                  "\", allowed gps, sbas, galileo, beidou, qzss, glonass");
    }
    if (std::ranges::find(systems, found->value) != systems.end()) {
      throw std::invalid_argument("systems has \"" + name + "\" twice");
    }
    systems.push_back(found->value);
  }
  if (systems.empty()) {
    throw std::invalid_argument(
        "systems is empty, allowed gps, sbas, galileo, beidou, qzss, glonass");
  }
  return systems;
}

void validate(const SatellitesConfiguration& configuration) {
  fields::check(configuration);
  if (configuration.file.empty()) {
    (void)systems_of(configuration);
  }
}

}  // namespace rigwire::hil
