#include "sim/gnss/gnss_parameters.h"

#include <array>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr std::array<fields::Choice<DilutionKind>, 2> kDilutionKinds{
    {{DilutionKind::regression, "regression", "The paper's Eq. 1 over the satellite count."},
     {DilutionKind::geometric, "geometric", "From the directions of the satellites."}}};
constexpr std::array<fields::Choice<QuadrantRule>, 3> kQuadrantRules{
    {{QuadrantRule::off, "off", "Eq. 3 by count alone."},
     {QuadrantRule::cardinal, "cardinal", "2D when a sector around N, E, S or W is empty."},
     {QuadrantRule::diagonal, "diagonal", "2D when a sector around NE, SE, SW or NW is empty."}}};
constexpr std::array<fields::Choice<ErrorModel>, 3> kErrorModels{
    {{ErrorModel::engine, "engine",
      "Errors of each pseudorange and range rate, and a receiver's filter over them."},
     {ErrorModel::coloured, "coloured",
      "Errors of each pseudorange, and every epoch's position solved from them alone."},
     {ErrorModel::paper, "paper", "Dilution times noise: the paper's Eq. 1 to 3."}}};

}  // namespace

bool GnssSystems::receives(GnssSystem system) const {
  switch (system) {
    case GnssSystem::gps:
      return gps;
    case GnssSystem::glonass:
      return glonass;
    case GnssSystem::galileo:
      return galileo;
    case GnssSystem::beidou:
      return beidou;
    case GnssSystem::sbas:
      return sbas;
    case GnssSystem::qzss:
      return qzss;
    case GnssSystem::imes:
      return false;
  }
  return false;
}

void visit(fields::Visitor& v, GnssSystems& p) {
  v.boolean("gps", p.gps, "Whether GPS is received.");
  v.boolean("glonass", p.glonass, "Whether GLONASS is received.");
  v.boolean("galileo", p.galileo, "Whether Galileo is received.");
  v.boolean("beidou", p.beidou, "Whether BeiDou is received.");
  v.boolean("sbas", p.sbas, "Whether SBAS satellites are received.");
  v.boolean("qzss", p.qzss, "Whether QZSS is received.");
}

void visit(fields::Visitor& v, GnssParameters& p) {
  v.choice("error_model", p.error_model, kErrorModels, "How errors of the position arise.");
  v.only_if(p.error_model == ErrorModel::paper, "error_model", "error_model: paper",
            [&p](fields::Visitor& w) {
              w.choice("dilution", p.dilution, kDilutionKinds,
                       "How dilution of precision is found; the other models go by geometry.");
              w.number("circular_error", p.circular_error_m, in("m").between(0, 1000),
                       "CEP under open sky, as in the data sheet.");
              w.number("correlation_time", p.correlation_time_s, in("s").between(0, 86'400),
                       "Time constant of the position error; 0 = white noise.");
            });
  v.choice("quadrant_rule", p.quadrant_rule, kQuadrantRules, "The paper's rule on empty sectors.");
  v.section("systems", p.systems, "Satellite systems received.");
  visit(v, p.sky);
  v.only_if(p.error_model != ErrorModel::paper, "error_model", "error_model: engine or coloured",
            [&p](fields::Visitor& w) {
              w.section("ranges", p.ranges, "Errors of pseudoranges and range rates.");
              w.section("multipath", p.multipath, "Reflections.");
            });
  v.only_if(p.error_model == ErrorModel::engine, "error_model", "error_model: engine",
            [&p](fields::Visitor& w) {
              w.section("navigation", p.navigation, "The receiver's filter.");
            });
  v.only_if(p.error_model != ErrorModel::engine, "error_model", "error_model: paper or coloured",
            [&p](fields::Visitor& w) {
              w.number("speed_sigma", p.speed_sigma_mps, in("m/s").between(0, 100),
                       "White noise of the velocity, per axis at dilution 1.");
            });
  v.boolean("errors", p.errors, "False: position, velocity and ranges are exact.");
  v.section("corrections", p.corrections, "SBAS, services, RTK.");
  visit(v, p.clock);
  v.boolean("raw_measurements", p.raw_measurements, "Pseudoranges, phases and Doppler shifts too.");
  v.only_if(
      p.raw_measurements, "raw_measurements", "raw_measurements: true", [&p](fields::Visitor& w) {
        w.boolean("second_signals", p.second_signals,
                  "The radio part receives the second carriers too: L2C, E5b, L2OF, B2I.");
        w.boolean("ionosphere", p.ionosphere, "Raw ranges are delayed by the broadcast model.");
        w.boolean("troposphere", p.troposphere, "Raw ranges are delayed by Saastamoinen's model.");
      });
}

void validate(const GnssParameters& p) {
  fields::check(p);
  const GnssSystems& s = p.systems;
  if (!(s.gps || s.glonass || s.galileo || s.beidou || s.sbas || s.qzss)) {
    throw fields::Refused("systems", "none is received, allowed: at least one");
  }
  validate(p.clock);
  for (const GnssFault& fault : p.faults) {
    fields::check(fault);
  }
}

}  // namespace rigwire::sim
