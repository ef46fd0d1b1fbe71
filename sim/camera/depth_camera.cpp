#include "sim/camera/depth_camera.h"

#include <cmath>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr double kGreatestValue = 65535.0;

}  // namespace

CameraParameters DepthCameraParameters::optics() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 480;
  p.sensor.pixel_pitch_m = 1e-5;
  p.lens.focal_length_m = 0.00483;
  p.lens.f_number = 1.4;
  return p;
}

void visit(fields::Visitor& v, DepthCameraParameters& p) {
  visit(v, p.camera);
  v.integer("rays", p.rays, IntegerRule{1, 64}, "Rays per pixel that its range comes from.");
  v.number("nearest", p.nearest_m, in("m").between(0, 100), "Nearer there is no range.");
  v.number("farthest", p.farthest_m, in("m").between(0.1, 1000), "Farther there is no range.");
  v.number("unambiguous", p.unambiguous_m, in("m").between(0.1, 10000),
           "Distances beyond fold back by this much.");
  v.number("step", p.step_m, in("mm").between(0.01, 100), "Of the coding of a range.");
  v.number("noise", p.noise_m, in("mm").between(0, 1000),
           "Standard deviation of the range of the reference surface, in the dark.");
  v.number("noise_distance", p.noise_distance_m, in("m").between(0.1, 1000),
           "Distance of the reference surface.");
  v.number("noise_reflectance", p.noise_reflectance, in("%").above(0).at_most(100),
           "Reflectance of the reference surface.");
  v.duration("noise_exposure", p.noise_exposure, {1'000, 1'000'000'000},
             "Exposure with which the reference is seen.");
  v.number("noise_floor", p.noise_floor_m, in("mm").between(0, 1000),
           "Standard deviation that is left at all distances.");
  v.number("greatest_noise", p.greatest_noise_m, in("mm").between(0.01, 10000),
           "Standard deviation above which there is no range.");
  v.number("doubling_luminance", p.doubling_luminance_cd, plain().between(1e-3, 1e9),
           "Of a surface in daylight, cd/m2, that doubles the variance at the reference exposure.");
  v.number("cyclic_error", p.cyclic_error_m, in("mm").between(0, 1000),
           "Amplitude of the error that repeats with distance.");
  v.number("cycle", p.cycle_m, in("m").between(0.001, 1000), "Distance after which it repeats.");
  v.number("own_luminance", p.own_luminance_cd, plain().between(0, 1e9),
           "Of the reference surface by the camera's own light, cd/m2, in the image.");
  v.number("daylight_share", p.daylight_share, in("%").between(0, 100),
           "Share of the light of day that comes through the filter into the image.");
}

void validate(const DepthCameraParameters& p) {
  fields::check(p);
  validate(p.camera);
  fields::require(!p.camera.sensor.colour, "image_sensor.colour", "true",
                  "false: it sees its own light");
  const LensParameters& lens = p.camera.lens;
  fields::require(lens.model == LensModel::brown_conrady, "lens.model", "kannala_brandt",
                  "brown_conrady: a pinhole camera is reported");
  for (const auto& [key, value] : {std::pair{"lens.k1", lens.k1},
                                   {"lens.k2", lens.k2},
                                   {"lens.p1", lens.p1},
                                   {"lens.p2", lens.p2},
                                   {"lens.k3", lens.k3}}) {
    fields::require(value == 0.0, key, plain().print(value), "0: a pinhole camera is reported");
  }
  fields::require(p.nearest_m < p.farthest_m, "nearest", in("m").print(p.nearest_m),
                  "below farthest, " + in("m").print(p.farthest_m));
  fields::require(p.farthest_m <= p.unambiguous_m, "farthest", in("m").print(p.farthest_m),
                  "up to unambiguous, " + in("m").print(p.unambiguous_m));
  fields::require(p.farthest_m <= kGreatestValue * p.step_m, "farthest",
                  in("m").print(p.farthest_m),
                  "up to 65535 steps, " + in("m").print(kGreatestValue * p.step_m));
  fields::require(p.noise_floor_m < p.greatest_noise_m, "noise_floor",
                  in("mm").print(p.noise_floor_m),
                  "below greatest_noise, " + in("mm").print(p.greatest_noise_m));
}

ReportedGeometry depth_geometry(const DepthCameraParameters& p) {
  const Lens lens(p.camera.lens, p.camera.sensor.pixel_pitch_m, p.camera.sensor.width_px,
                  p.camera.sensor.height_px);
  ReportedGeometry geometry;
  geometry.focal_length_px = lens.focal_length_px();
  geometry.principal_u_px = lens.principal_point_px().x();
  geometry.principal_v_px = lens.principal_point_px().y();
  geometry.coding = {p.step_m, 0.0, 0};
  return geometry;
}

double range_noise_m(const DepthCameraParameters& p, double strength, double luminance_cd,
                     Duration exposure) {
  // sigma^2 = floor^2 + (sigma0 / S)^2 (1 + L / L2 t / t0).
  const double longer = to_seconds(exposure) / to_seconds(p.noise_exposure);
  const double variance = (1.0 + luminance_cd / p.doubling_luminance_cd * longer) /
                          (strength * strength) * p.noise_m * p.noise_m;
  return std::sqrt(p.noise_floor_m * p.noise_floor_m + variance);
}

}  // namespace rigwire::sim
