// How well a satellite receiver measures: sim/gnss/gnss_sensor.h has the words.
#pragma once

#include <array>

#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::hil {

inline constexpr std::array<Choice<sim::DilutionKind>, 2> kDilutionKinds{
    {{sim::DilutionKind::regression, "regression", "The paper's Eq. 1 over the satellite count."},
     {sim::DilutionKind::geometric, "geometric", "From the directions of the satellites."}}};
inline constexpr std::array<Choice<sim::QuadrantRule>, 3> kQuadrantRules{
    {{sim::QuadrantRule::off, "off", "Eq. 3 by count alone."},
     {sim::QuadrantRule::cardinal, "cardinal", "2D when a sector around N, E, S or W is empty."},
     {sim::QuadrantRule::diagonal, "diagonal", "2D when a sector between them is empty."}}};

template <class Visitor>
void visit(Visitor& v, sim::GnssParameters& p) {
  v.choice("dilution", p.dilution, kDilutionKinds, "How dilution of precision is found.");
  v.choice("quadrant_rule", p.quadrant_rule, kQuadrantRules, "The paper's rule on empty sectors.");
  v.number("elevation_mask", p.elevation_mask_deg, in("deg").stored_as("deg").between(0, 89.9),
           "Satellites below it are not used.");
  v.number("antenna_clearance", p.antenna_clearance_m, in("mm").at_least(0),
           "Things nearer do not block the sky.");
  v.number("circular_error", p.circular_error_m, in("m").at_least(0),
           "CEP under open sky, as in the data sheet.");
  v.number("correlation_time", p.correlation_time_s, in("s").at_least(0),
           "Of the position error; 0 = white noise.");
  v.number("speed_sigma", p.speed_sigma_mps, in("m/s").at_least(0), "White, per axis.");
  v.number("cn0_zenith", p.cn0_zenith_dbhz, in("dBHz").between(0, 63), "Signal from above.");
  v.number("cn0_horizon", p.cn0_horizon_dbhz, in("dBHz").between(0, 63),
           "Signal from the horizon.");
  v.number("cn0_threshold", p.cn0_threshold_dbhz, in("dBHz").between(0, 63), "Weakest tracked.");
  v.integer("maximum_channels", p.maximum_channels, IntegerRule{1, 24}, "Satellites at once.");
  v.number("clock_drift", p.clock_drift, in("ppm").between(-100, 100), "Of the receiver, mean.");
  v.number("clock_drift_sigma", p.clock_drift_sigma, in("ppm").at_least(0), "Its slow wander.");
}

}  // namespace rigwire::hil
