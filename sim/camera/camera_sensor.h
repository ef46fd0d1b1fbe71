// A camera of any kind as the world sees it: what it makes of one exposure.
//
// A kind is one class: the plain camera (one image), stereo (two images, matched), depth (range
// with an image), all-round (several views or rays joined to one picture). What differs between
// kinds is what a Picture's parts are; when an exposure begins and how long it is are the caller's.
//
// A picture depends on its shot, on the scene in its present slice, and on the sensor's parameters,
// seed and name alone: not on pictures before, and not on threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/camera/camera_air.h"
#include "sim/camera/camera_renderer.h"
#include "sim/camera/daylight.h"
#include "sim/camera/sky_visibility.h"
#include "sim/samples/picture_sample.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// One exposure to take.
struct CameraShot {
  CameraCommand command;    ///< Region, binning, format and parts.
  Duration exposure{};      ///< Exposure time of each row, commanded or automatic.
  double gain_db = 0.0;     ///< Commanded or automatic.
  std::uint64_t frame = 0;  ///< Draws the noise.
  SimTime start{};          ///< Start of exposure of the first row.
  /// Poses of the camera's mount frame S in order of time, at least two. They and the scene's slice
  /// span the exposure of all rows (CameraSensor::span()).
  std::vector<CameraPose> poses;
  std::uint32_t mask = Scene::kSeeEverything;  ///< Mask of the camera's rays; shadows ignore it.
  const Daylight* light = nullptr;             ///< Must not be null.
  const CameraAir* air = nullptr;              ///< Null: clear.
  const SkyVisibility* sky = nullptr;          ///< Null: all of the sky, everywhere.
  double wetness = 0.0;                        ///< Wetness of the ground, 0 .. 1.
};

/// What is true behind each pixel of a picture's first part, at the middle of that pixel's
/// exposure. Leaves by the truth tap only.
struct CameraTruth {
  int width = 0;
  int height = 0;
  std::vector<float> range_m;           ///< Along the ray; 0: nothing.
  std::vector<float> depth_m;           ///< Along the optical axis; 0: nothing.
  std::vector<std::uint32_t> instance;  ///< Scene::InstanceId; ~0: none.
};

class CameraSensor {
 public:
  CameraSensor() = default;
  virtual ~CameraSensor() = default;
  CameraSensor(const CameraSensor&) = delete;
  CameraSensor& operator=(const CameraSensor&) = delete;

  /// From the first row's start to the end of the last one's exposure.
  [[nodiscard]] virtual Duration span(const CameraCommand& command, Duration exposure) const = 0;

  /// What was made of a shot.
  struct Taken {
    std::shared_ptr<const Picture> picture;
    /// Mean of the image, share of full scale: what automatic exposure measures.
    double mean = 0.0;
  };
  /// `truth`: filled unless null. The scene must be ready for a slice that spans the exposure, and
  /// must not change meanwhile. One call at a time. Throws std::invalid_argument for a shot that
  /// does not fit the sensor.
  [[nodiscard]] virtual Taken take(const Scene& scene, const CameraShot& shot,
                                   CameraTruth* truth) = 0;
};

}  // namespace rigwire::sim
