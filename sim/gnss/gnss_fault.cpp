#include "sim/gnss/gnss_fault.h"

#include <array>

namespace rigwire::sim {

using fields::in;

namespace {

struct Add {
  GnssFaultState& state;
  const FaultPeriod& when;
  SimTime now;

  void operator()(const OutageFault&) const { state.no_signal = true; }
  void operator()(const JammingFault& p) const {
    const double loss_db = grown(p, when, now).loss_db;
    state.jamming_db += p.band == JammedBand::l2 ? 0.0 : loss_db;
    state.second_jamming_db += p.band == JammedBand::l1 ? 0.0 : loss_db;
  }
  void operator()(const SpoofDriftFault& p) const {
    const double since_s = to_seconds(now - when.began(now));
    state.spoofed = true;
    state.offset_m += since_s * p.velocity_mps;
    state.offset_rate_mps += p.velocity_mps;
    state.clock_offset_m += since_s * p.clock_rate_mps;
    state.clock_offset_rate_mps += p.clock_rate_mps;
  }
  void operator()(const JumpFault& p) const { state.offset_m += grown(p, when, now).offset_m; }
  void operator()(const AntennaShortFault&) const {
    state.no_signal = true;
    state.antenna = AntennaState::short_circuit;
  }
  void operator()(const AntennaOpenFault&) const {
    state.no_signal = true;
    if (state.antenna == AntennaState::ok) {
      state.antenna = AntennaState::open;
    }
  }
  void operator()(const CorrectionOutageFault&) const { state.corrections_lost = true; }
};

constexpr std::array<fields::Choice<JammedBand>, 3> kBands{
    {{JammedBand::all, "all", "All that satellites send on."},
     {JammedBand::l1, "l1", "L1, E1 and B1 alone; of a receiver with two bands."},
     {JammedBand::l2, "l2", "L2, E5b and B2 alone; of a receiver with two bands."}}};

}  // namespace

bool tells_bands_apart(const GnssFault& fault) {
  const auto* const jamming = std::get_if<JammingFault>(&fault.what);
  return jamming != nullptr && jamming->band != JammedBand::all;
}

void visit(fields::Visitor& v, JammingFault& p) {
  v.number("loss", p.loss_db, in("dB").stored_as("dB").between(0, 80),
           "How far the carrier-to-noise density falls.");
  v.choice("band", p.band, kBands, "What of the spectrum is disturbed.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, SpoofDriftFault& p) {
  v.vector3("velocity", p.velocity_mps, in("m/s").between(-1e4, 1e4),
            "Velocity of the false place, [east, north, up].");
  v.number("clock_rate", p.clock_rate_mps, in("m/s").between(-1e4, 1e4),
           "How fast all ranges grow alike, as of a clock that drifts.");
}

void visit(fields::Visitor& v, JumpFault& p) {
  v.vector3("offset", p.offset_m, in("m").between(-1e6, 1e6),
            "From the true place to the false one, [east, north, up].");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, GnssFault& p) {
  visit_fault(v, p);
}

GnssFaultState fault_state(const FaultBook<GnssFault>& faults, SimTime time) {
  GnssFaultState state;
  faults.each(time, [&](const GnssFault& fault) {
    std::visit(Add{state, fault.when, time}, fault.what);
  });
  return state;
}

}  // namespace rigwire::sim
