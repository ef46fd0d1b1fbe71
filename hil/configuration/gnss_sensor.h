// How well a satellite receiver measures: sim/gnss/gnss_sensor.h has the words.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::DilutionKind>, 2> kDilutionKinds{
    {{sim::DilutionKind::regression, "regression", "The paper's Eq. 1 over the satellite count."},
     {sim::DilutionKind::geometric, "geometric", "From the directions of the satellites."}}};
inline constexpr std::array<fields::Choice<sim::QuadrantRule>, 3> kQuadrantRules{
    {{sim::QuadrantRule::off, "off", "Eq. 3 by count alone."},
     {sim::QuadrantRule::cardinal, "cardinal", "2D when a sector around N, E, S or W is empty."},
     {sim::QuadrantRule::diagonal, "diagonal", "2D when a sector between them is empty."}}};

inline constexpr std::array<fields::Choice<sim::ErrorModel>, 2> kErrorModels{
    {{sim::ErrorModel::paper, "paper", "Dilution times noise: the paper's Eq. 2."},
     {sim::ErrorModel::coloured, "coloured",
      "Errors of each pseudorange, and the position solved from them."}}};
inline constexpr std::array<fields::Choice<sim::SkySamples>, 3> kSkySamples{
    {{sim::SkySamples::one, "one", "Sharp edges."},
     {sim::SkySamples::four, "four", "Soft edges."},
     {sim::SkySamples::sixteen, "sixteen", "Soft edges, finer where there is one."}}};
inline constexpr std::array<fields::Choice<sim::CorrectionKind>, 4> kCorrectionKinds{
    {{sim::CorrectionKind::none, "none", "The receiver alone."},
     {sim::CorrectionKind::sbas, "sbas", "Orbits, clocks and ionosphere by SBAS."},
     {sim::CorrectionKind::service, "service", "Precise point positions (StarFire SF2 class)."},
     {sim::CorrectionKind::rtk, "rtk", "Real-time kinematic: float, then fixed."}}};

inline void visit(fields::Visitor& v, sim::GnssSystems& p) {
  v.boolean("gps", p.gps, "Is received.");
  v.boolean("glonass", p.glonass, "Is received.");
  v.boolean("galileo", p.galileo, "Is received.");
  v.boolean("beidou", p.beidou, "Is received.");
  v.boolean("sbas", p.sbas, "Is received.");
  v.boolean("qzss", p.qzss, "Is received.");
}

inline void visit(fields::Visitor& v, sim::SkyViewParameters& p) {
  v.number("elevation_mask", p.elevation_mask_deg,
           fields::in("deg").stored_as("deg").between(0, 89.9),
           "Satellites below it are not used.");
  v.number("antenna_clearance", p.antenna_clearance_m, fields::in("mm").between(0, 100'000),
           "Things nearer do not block the sky.");
  v.number("cn0_zenith", p.cn0_zenith_dbhz, fields::in("dBHz").between(0, 63),
           "Signal from above.");
  v.number("cn0_horizon", p.cn0_horizon_dbhz, fields::in("dBHz").between(0, 63),
           "Signal from the horizon.");
  v.number("cn0_threshold", p.cn0_threshold_dbhz, fields::in("dBHz").between(0, 63),
           "Weakest tracked.");
  v.number("cn0_hysteresis", p.cn0_hysteresis_db, fields::plain().between(0, 30),
           "dB above the threshold to be acquired again.");
  v.number("cn0_sigma", p.cn0_sigma_db, fields::plain().between(0, 10), "dB, slow fading.");
  v.number("reacquisition_time", p.reacquisition_time_s, fields::in("s").between(0, 600),
           "From signal to tracking after a loss.");
  v.number("foliage_attenuation", p.foliage_attenuation_dbpm, fields::plain().between(0, 100),
           "dB per metre within crowns.");
  v.choice("sky_samples", p.samples, kSkySamples, "Rays per satellite.");
  v.number("cone_half_angle", p.cone_half_angle_deg,
           fields::in("deg").stored_as("deg").between(0, 10), "Of the cone of these rays.");
  v.integer("maximum_channels", p.maximum_channels, fields::IntegerRule{1, 184},
            "Satellites at once.");
}

inline void visit(fields::Visitor& v, sim::RangeErrorParameters& p) {
  const fields::NumberRule metres = fields::in("m").between(0, 1000);
  const fields::NumberRule seconds = fields::in("s").between(0, 1e6);
  v.number("orbit_clock_sigma", p.orbit_clock_sigma_m, metres, "Broadcast orbits and clocks.");
  v.number("orbit_clock_correlation", p.orbit_clock_correlation_s, seconds, "Its time constant.");
  v.number("ionosphere_sigma", p.ionosphere_sigma_m, metres,
           "Vertical, what the broadcast model leaves.");
  v.number("ionosphere_gradient_sigma", p.ionosphere_gradient_sigma_mpkm,
           fields::plain().between(0, 1), "m per km, per axis.");
  v.number("ionosphere_correlation", p.ionosphere_correlation_s, seconds, "Its time constant.");
  v.number("troposphere_sigma", p.troposphere_sigma_m, metres, "Vertical, what the model leaves.");
  v.number("troposphere_correlation", p.troposphere_correlation_s, seconds, "Its time constant.");
  v.number("code_noise", p.code_noise_m, metres, "At 45 dBHz; doubles every 6 dB.");
  v.number("code_noise_correlation", p.code_noise_correlation_s, seconds, "Of the code loop.");
  v.number("multipath_sigma", p.multipath_sigma_m, metres, "At the zenith, over sin E below.");
  v.number("multipath_correlation", p.multipath_correlation_s, seconds, "At rest.");
  v.number("multipath_length", p.multipath_length_m, fields::in("m").between(0.001, 1e6),
           "In motion: correlated over this way.");
  v.number("weak_signal_sigma", p.weak_signal_sigma_mpdb, fields::plain().between(0, 1000),
           "m per dB that a signal is too weak, beyond 3 dB; the receiver's belief only.");
}

inline void visit(fields::Visitor& v, sim::MultipathParameters& p) {
  v.boolean("enabled", p.enabled, "Reflections are searched by rays.");
  v.number("reach", p.reach_m, fields::in("m").between(0.1, 500), "Of the search.");
  v.number("reflection_loss", p.reflection_loss_db, fields::plain().between(0, 40),
           "dB, reflected against direct signal.");
  v.number("correlator_spacing", p.correlator_spacing_m, fields::in("m").between(1, 300),
           "Early to late.");
  v.number("search_distance", p.search_distance_m, fields::in("m").between(0, 1000),
           "Searched again after so much motion,");
  v.number("search_period", p.search_period_s, fields::in("s").between(0, 86'400),
           "or so much time.");
}

inline void visit(fields::Visitor& v, sim::CorrectionParameters& p) {
  const fields::NumberRule metres = fields::in("m").between(0, 1000);
  const fields::NumberRule seconds = fields::in("s").between(0, 86'400);
  v.choice("kind", p.kind, kCorrectionKinds, "What they make of the position.");
  v.number("interval", p.interval_s, fields::in("s").between(0.01, 86'400), "Between corrections.");
  v.number("latency", p.latency_s, seconds, "From their measurement to their arrival.");
  v.number("largest_age", p.largest_age_s, seconds, "Older ones are not applied.");
  v.number("sbas_share", p.sbas_share, fields::plain().between(0, 1),
           "Of orbit, clock and ionosphere errors that SBAS leaves.");
  v.number("baseline", p.baseline_m, fields::in("m").between(0, 1e6),
           "RTK: from the base station.");
  v.number("fixed_horizontal", p.fixed_horizontal_m, metres, "RTK fixed, radial, 1 sigma.");
  v.number("fixed_vertical", p.fixed_vertical_m, metres, "RTK fixed, 1 sigma.");
  v.number("fixed_per_baseline", p.fixed_per_baseline, fields::in("ppm").between(0, 1e6),
           "RTK fixed: on both, of the baseline.");
  v.number("float_start", p.float_start_m, metres, "RTK float, per axis: at the start");
  v.number("float_end", p.float_end_m, metres, "and after long.");
  v.number("float_decay", p.float_decay_s, fields::in("s").between(0.001, 86'400), "Between them.");
  v.number("first_fix", p.first_fix_s, seconds, "RTK: from float to fixed, the first time.");
  v.number("refix_shortest", p.refix_shortest_s, seconds, "RTK: after a loss, at least");
  v.number("refix_longest", p.refix_longest_s, seconds, "and at most.");
  v.integer("least_satellites", p.least_satellites, fields::IntegerRule{4, 40},
            "RTK fixed: in line of sight.");
  v.number("service_start", p.service_start_m, metres, "Service, per axis: at the start");
  v.number("service_end", p.service_end_m, metres, "and converged.");
  v.number("service_decay", p.service_decay_s, fields::in("s").between(0.001, 86'400),
           "Between them.");
  v.number("vertical_ratio", p.vertical_ratio, fields::plain().between(0, 100),
           "Float and service: vertical over horizontal.");
  v.number("service_bridge", p.service_bridge_s, seconds,
           "Service: shorter losses cost no convergence.");
  v.number("correlation", p.correlation_s, seconds, "Of carrier positions' errors.");
}

inline void visit(fields::Visitor& v, sim::GnssParameters& p) {
  v.choice("error_model", p.error_model, kErrorModels, "How its errors arise.");
  v.choice("dilution", p.dilution, kDilutionKinds, "How dilution of precision is found.");
  v.choice("quadrant_rule", p.quadrant_rule, kQuadrantRules, "The paper's rule on empty sectors.");
  v.section("systems", p.systems, "Satellite systems received.");
  visit(v, p.sky);
  v.number("circular_error", p.circular_error_m, fields::in("m").between(0, 1000),
           "CEP under open sky, as in the data sheet; error model paper.");
  v.number("correlation_time", p.correlation_time_s, fields::in("s").between(0, 86'400),
           "Of the position error; 0 = white noise; error model paper.");
  v.section("ranges", p.ranges, "Errors of pseudoranges; error model coloured.");
  v.section("multipath", p.multipath, "Reflections; error model coloured.");
  v.number("speed_sigma", p.speed_sigma_mps, fields::in("m/s").between(0, 100),
           "White, per axis at dilution 1.");
  v.boolean("errors", p.errors, "False: position, velocity and ranges without any.");
  v.section("corrections", p.corrections, "SBAS, services, RTK.");
  v.number("clock_drift", p.clock.drift, fields::in("ppm").between(-100, 100),
           "Of the receiver, mean.");
  v.number("clock_drift_sigma", p.clock.wander_sigma, fields::in("ppm").between(0, 1),
           "Its slow wander.");
  v.boolean("raw_measurements", p.raw_measurements, "Pseudoranges, phases and Doppler shifts too.");
  v.boolean("ionosphere", p.ionosphere, "Raw ranges are delayed by the broadcast model.");
  v.boolean("troposphere", p.troposphere, "Raw ranges are delayed by Saastamoinen's model.");
}

}  // namespace rigwire::sim
