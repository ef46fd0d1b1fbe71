#include "sim/camera/camera_parameters.h"

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

void visit(fields::Visitor& v, CameraParameters& p) {
  v.section("lens", p.lens, "In front of the sensor.");
  v.section("image_sensor", p.sensor, "What turns light into numbers.");
  visit_pictures(v, p);
}

void visit_pictures(fields::Visitor& v, CameraParameters& p) {
  v.section("auto_exposure", p.auto_exposure, "How exposure and gain are chosen.");
  v.integer("samples", p.samples, IntegerRule{1, 1024},
            "Rays per pixel, over its area and the exposure; 1 = no blur by motion.");
  if (p.samples > 1) {
    v.refused("edge_ratio", "with several samples every pixel is a mean over its area");
  } else {
    v.number("edge_ratio", p.edge_ratio, plain().between(0, 1000),
             "Pixels that differ more from a neighbour are means of four rays; 0 = none.");
  }
  v.integer("sky_rays", p.sky_rays, IntegerRule{0, 256},
            "Rays per sample that look for the sky; 0 = a lattice made once.");
  v.number("near", p.near_m, in("m").between(0, 10), "Nearer than this nothing is seen.");
  v.number("far", p.far_m, in("m").between(1, 100000), "Beyond this only sky and far ground.");
  v.integer("threads", p.threads, IntegerRule{1, 64},
            "Threads that render and match; pictures do not change.");
  v.list("looks", p.looks, "How surfaces look, by their labels.");
}

void validate(const CameraParameters& p) {
  fields::check(p);
  fields::require(p.near_m < p.far_m, "near", in("m").print(p.near_m),
                  "below far, " + in("m").print(p.far_m));
  fields::require(p.edge_ratio == 0.0 || p.edge_ratio > 1.0, "edge_ratio",
                  plain().print(p.edge_ratio), "0, or above 1");
}

}  // namespace rigwire::sim
