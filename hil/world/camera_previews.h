// Small pictures of a rig's cameras for viewers, while no client takes the cameras' own pictures.
//
// When a slice is over, a preview of one camera is begun if that camera has a viewer, if it exposes
// for no client, and if its last preview is kPreviewPeriod of wall time old. A thread of its own,
// with lower priority than the run, renders what the camera would see at the end of that slice, in
// a twin of the scene (sim/scene/scene.h). The run never waits for it. Without viewers nothing is
// rendered; while time is paused, no slice ends and no preview begins.
//
// A preview changes no byte of the run: it draws from random streams of its own, has light and air
// of its own (CameraSurroundings), and puts nothing on a shelf. Which instants are shown depends on
// the wall clock.
//
// A preview is the image of the camera's first head, with the settings of power-on: the camera's
// lens and exposure, at most kPreviewWidth columns of pixels that are as many times coarser, one
// ray for each, all rows at once. It lacks blur by motion and faulty pixels.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/files/image_file.h"
#include "hil/world/camera_surroundings.h"
#include "hil/world/world_sensor.h"
#include "sim/camera/camera_kinds.h"
#include "sim/samples/picture_sample.h"

namespace rigwire::hil {

inline constexpr int kPreviewWidth_px = 320;
/// Minimum time between the starts of two previews of a camera.
inline constexpr std::chrono::milliseconds kPreviewPeriod{500};

struct PreviewedCamera {
  std::string name;          ///< Name of the device in the rig.
  StationIndex station = 0;  ///< Where the device asks for exposures.
  SensorMount mount;
  bool sees_own_link = false;  ///< Sees the body that it is mounted on.
  sim::CameraKind kind;
  CameraCommand command;  ///< At power-on: exposure, gain and black level.
};

struct CameraPreview {
  std::size_t camera = 0;  ///< Place in the list of cameras.
  SimTime time{};          ///< Time of the exposure.
  Image picture;           ///< One or three channels of 8 bits, in colours of a screen.
};

/// Callbacks to the viewers. All must live as long as the previews.
struct PreviewViewers {
  /// Returns whether that camera has a viewer; called on the truth's thread.
  std::function<bool(std::size_t camera)> wanted;
  /// Called on the thread of the previews.
  std::function<void(CameraPreview preview)> show;
  /// Reports once for each camera that no preview of it can be made; called on that same thread.
  std::function<void(std::string what)> failed;
};

/// Returns the kind of camera whose pictures are previews of `kind`'s.
[[nodiscard]] sim::CameraKind preview_of(const sim::CameraKind& kind);

/// `terrain`: the first of the scene. `surroundings` must not be those of the rig's cameras.
[[nodiscard]] std::unique_ptr<WorldSensor> make_camera_previews(
    std::vector<PreviewedCamera> cameras, std::uint64_t seed, const sim::Scene& scene,
    sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings,
    PreviewViewers viewers);

}  // namespace rigwire::hil
