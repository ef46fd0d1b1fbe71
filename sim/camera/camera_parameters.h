// Parameters of a camera: its lens, its sensor, and the quality and cost of its pictures.
#pragma once

#include <vector>

#include "fields/rules.h"
#include "sim/camera/image_sensor.h"
#include "sim/camera/lens.h"
#include "sim/camera/surface_look.h"

namespace rigwire::sim {

struct CameraParameters {
  static constexpr fields::Named kNamed{"camera", "One image."};

  LensParameters lens;
  ImageSensorParameters sensor;
  AutoExposureParameters auto_exposure;
  /// Rays per pixel, spread over its area and over the exposure; 1: through its middle, at the
  /// middle of the exposure, so that nothing is blurred by motion.
  int samples = 1;
  /// With one ray per pixel: a pixel whose light differs from a neighbour's by more than this
  /// factor is the mean of four rays in its area instead. 0: no pixel is.
  double edge_ratio = 4.0;
  /// Rays per sample that sample the sky, instead of the lattice of sky_visibility.h: more costly,
  /// noisy, but correct below moving things. 0: the lattice.
  int sky_rays = 0;
  double near_m = 0.05;   ///< Nearer than this nothing is seen.
  double far_m = 2000.0;  ///< Beyond this only sky and far ground.
  int threads = 1;        ///< Rendering threads with the caller's; pictures do not depend on it.
  std::vector<SurfaceLook> looks;
};
void visit(fields::Visitor& v, CameraParameters& p);
/// Those of its keys that are neither of the lens nor of the sensor.
void visit_pictures(fields::Visitor& v, CameraParameters& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const CameraParameters& parameters);

}  // namespace rigwire::sim
