// How well a lidar measures, and by which model.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "hil/configuration/depth_image.h"
#include "hil/configuration/rotor.h"
#include "sim/lidar/lidar_parameters.h"

namespace rigwire::hil {

struct LidarSensorConfiguration {
  LidarMethod method = LidarMethod::rays;
  sim::SpinningLidarParameters beam;
  sim::DepthImageParameters images;  ///< Means nothing with LidarMethod::rays.
  sim::RotorParameters rotor;
};

}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::RangeNoise>, 2> kRangeNoises{
    {{sim::RangeNoise::constant, "constant", "The same spread for every echo."},
     {sim::RangeNoise::signal, "signal", "Faint echoes are less exact."}}};

inline void visit(fields::Visitor& v, sim::SpinningLidarParameters& p) {
  v.number("range_sigma", p.range_sigma_m, fields::in("mm").between(0, 1000),
           "Gaussian, per echo.");
  v.number("housing_radius", p.housing_radius_m, fields::in("mm").between(0, 1000),
           "Where rays begin.");
  v.integer("threads", p.threads, fields::IntegerRule{1, 64},
            "That cast rays; results do not change.");
  v.integer("sub_rays", p.sub_rays, fields::IntegerRule{1, 1000},
            "Rays per beam: 1, 5 or 19; 1000 to compare with.");
  v.choice("range_noise", p.range_noise, kRangeNoises, "How range noise is made.");
  v.number("range_resolution", p.range_resolution_m, fields::in("mm").between(0, 1000),
           "With noise by signal: sqrt(2) times the spread of an echo that is just seen.");
  v.number("laser_bias_sigma", p.laser_bias_sigma_m, fields::in("mm").between(0, 1000),
           "Spread of the lasers' constant errors.");
  v.number("reference_range", p.reference_range_m, fields::in("m").between(0, 1000),
           "Where a 90 % target is just seen; 0 = at the maximum range.");
  v.number("echo_separation", p.echo_separation_m, fields::in("m").between(0, 100),
           "Of two echoes nearer than this the weaker one is lost.");
  v.boolean("compensates_incidence", p.compensates_incidence,
            "Reflectivity is that of the surface met head on.");
  v.number("drop_rate", p.drop_rate, fields::in("%").between(0, 100),
           "Shots that come to nothing.");
  v.number("drop_limit", p.drop_limit, fields::in("%").between(0, 200),
           "Echoes of a lower reflectivity may be lost.");
  v.number("drop_at_zero", p.drop_at_zero, fields::in("%").between(0, 100),
           "How many of them at reflectivity 0.");
  v.number("blooming_share", p.blooming_share, fields::in("%").between(0, 10),
           "Of a pulse, scattered beside the beam.");
  v.number("blooming_angle", p.blooming_angle_rad, fields::in("mrad").between(0, 100),
           "How far beside it.");
}

}  // namespace rigwire::sim

namespace rigwire::hil {

inline void visit(fields::Visitor& v, LidarSensorConfiguration& p) {
  v.choice("method", p.method, kLidarMethods, "How shots are simulated.");
  visit(v, p.beam);
  v.section("images", p.images, "Of the method depth_image.");
  v.section("rotor", p.rotor, "The head's motor.");
}

}  // namespace rigwire::hil
