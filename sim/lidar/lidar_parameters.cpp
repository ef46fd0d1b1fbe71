#include "sim/lidar/lidar_parameters.h"

#include <algorithm>
#include <array>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<RangeNoise>, 3> kRangeNoises{
    {{RangeNoise::constant, "constant", "Every echo has the same spread."},
     {RangeNoise::signal, "signal", "Spread of faint echoes by the root of their signal."},
     {RangeNoise::jitter, "jitter", "Spread of faint echoes by their signal, as of Velodynes."}}};

}  // namespace

void visit(fields::Visitor& v, SpinningLidarParameters& p) {
  v.number("range_sigma", p.range_sigma_m, in("mm").between(0, 1000),
           "Gaussian noise of the range, per echo.");
  v.number("housing_radius", p.housing_radius_m, in("mm").between(0, 1000),
           "Distance from the spin axis at which rays begin.");
  v.integer("threads", p.threads, IntegerRule{1, 64},
            "Threads that cast rays; results do not change.");
  v.integer("sub_rays", p.sub_rays, IntegerRule{0, 1000},
            "Rays per beam: 1, 5 or 19; 1000 to compare with; 0 = 1, or 5 for several echoes.");
  v.choice("range_noise", p.range_noise, kRangeNoises, "How range noise is made.");
  v.only_if(p.range_noise == RangeNoise::signal, "range_noise", "range_noise: signal",
            [&p](fields::Visitor& w) {
              w.number("range_resolution", p.range_resolution_m, in("mm").between(0, 1000),
                       "sqrt(2) times the spread of an echo that is just seen.");
            });
  v.only_if(p.range_noise == RangeNoise::jitter, "range_noise", "range_noise: jitter",
            [&p](fields::Visitor& w) {
              w.number("noise_onset", p.noise_onset, plain().between(0, 100),
                       "Signal over the faintest that is seen at which receiver noise sets in.");
            });
  v.number("reflectivity_sigma", p.reflectivity_sigma, in("%").between(0, 30),
           "Spread of the reflectivity from shot to shot, as a share of it.");
  v.number("laser_reflectivity_sigma", p.laser_reflectivity_sigma, in("%").between(0, 30),
           "Spread of the lasers' constant errors of reflectivity, as a share of it.");
  v.number("laser_bias_sigma", p.laser_bias_sigma_m, in("mm").between(0, 1000),
           "Spread of the lasers' constant errors.");
  v.number("reference_range", p.reference_range_m, in("m").between(0, 1000),
           "Where a 90 % target is just seen, head on in clear air; 0 = maximum range.");
  v.number("air_reference_range", p.air_reference_range_m, in("m").between(0, 1000),
           "Reference range for echoes of rain, fog and dust; 0 = reference_range.");
  v.number("air_minimum_range", p.air_minimum_range_m, in("m").between(0, 100),
           "Nearest echo of rain, fog and dust; 0 = that of surfaces.");
  v.number("air_focus_range", p.air_focus_range_m, in("m").between(0, 100),
           "Nearer, the lens images fog and haze wider than the detector; 0 = nowhere.");
  v.number("echo_separation", p.echo_separation_m, in("m").between(0, 100),
           "Distance of two echoes below which the weaker one is lost.");
  v.boolean("compensates_incidence", p.compensates_incidence,
            "Reflectivity is that of the surface at normal incidence.");
  v.number("drop_rate", p.drop_rate, in("%").between(0, 100), "Shots that come to nothing.");
  v.number("drop_limit", p.drop_limit, in("%").between(0, 200),
           "Echoes of a lower reflectivity may be lost.");
  v.number("drop_at_zero", p.drop_at_zero, in("%").between(0, 100),
           "Share of the echoes that is lost at reflectivity 0.");
  v.number("blooming_share", p.blooming_share, in("%").between(0, 10),
           "Share of a pulse that is scattered beside the beam.");
  v.number("blooming_angle", p.blooming_angle_rad, in("mrad").between(0, 100),
           "How far beside the beam a pulse is scattered.");
}

int rays_per_beam(const SpinningLidarParameters& parameters, bool several_echoes) {
  if (parameters.sub_rays != 0) {
    return parameters.sub_rays;
  }
  return several_echoes ? kSubRaysOfSeveralEchoes : 1;
}

void validate(const SpinningLidarParameters& p) {
  fields::check(p);
  constexpr std::array kSubRays{0, 1, 5, 19, 1000};
  if (std::ranges::find(kSubRays, p.sub_rays) == kSubRays.end()) {
    throw fields::Refused("sub_rays",
                          "found " + std::to_string(p.sub_rays) + ", allowed 0, 1, 5, 19 or 1000");
  }
}

}  // namespace rigwire::sim
