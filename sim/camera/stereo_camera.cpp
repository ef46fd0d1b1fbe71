#include "sim/camera/stereo_camera.h"

#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::sim {

using fields::in;

namespace {

/// Steps of a disparity in a pixel.
constexpr double kSteps = 16.0;

}  // namespace

CameraParameters StereoCameraParameters::heads() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 480;
  p.sensor.pixel_pitch_m = 7.5e-6;
  p.lens.focal_length_m = 0.004;
  return p;
}

void visit(fields::Visitor& v, StereoCameraParameters& p) {
  visit(v, p.camera);
  v.number("baseline", p.baseline_m, in("m").between(0.001, 10), "Between left and right head.");
  v.vector3("misalignment", p.misalignment_rad, in("deg").between(-5, 5),
            "Of the right head, unknown to the calibration: roll, pitch, yaw.");
  v.section("matching", p.matching, "How the pictures become disparities.");
}

void validate(const StereoCameraParameters& p) {
  fields::check(p);
  validate(p.camera);
  fields::require(!p.camera.sensor.colour, "image_sensor.colour", "true",
                  "false: grey pictures are matched");
  fields::require(p.camera.lens.model == LensModel::brown_conrady, "lens.model", "kannala_brandt",
                  "brown_conrady: pictures are rectified to a pinhole camera");
  const int searched = p.matching.least_disparity + p.matching.disparities;
  fields::require(
      searched < p.camera.sensor.width_px, "matching.disparities",
      std::to_string(p.matching.disparities),
      "with least_disparity below the width, " + std::to_string(p.camera.sensor.width_px));
}

ReportedGeometry stereo_geometry(const StereoCameraParameters& p) {
  const Lens lens(p.camera.lens, p.camera.sensor.pixel_pitch_m, p.camera.sensor.width_px,
                  p.camera.sensor.height_px);
  ReportedGeometry geometry;
  geometry.focal_length_px = lens.focal_length_px();
  geometry.baseline_m = p.baseline_m;
  geometry.principal_u_px = lens.principal_point_px().x();
  geometry.principal_v_px = lens.principal_point_px().y();
  geometry.coding = {1.0 / kSteps, 0.0, 0};
  return geometry;
}

}  // namespace rigwire::sim
