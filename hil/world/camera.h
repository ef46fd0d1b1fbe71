// Cameras in the simulated world, of any kind.
//
// At each instant of its device's sample plan, and for each exposure that a client has triggered
// (CameraCommand::software_triggers; from the truth's frontier on), an exposure begins: where the
// camera is during it comes from the physics' steps. When it is over, the picture is rendered
// beside the loop (hil/world/camera_worker.h), and handed over when it has been read out and
// processed, `processing` after the end of the last row's exposure.
//
// Free-running, every picture is there: the run waits for it at that instant. Paced, the run never
// waits: a picture that is still being rendered then is handed over when it is ready, marked late,
// up to as long again. A later one, or one that has not been begun, becomes a sample without a
// picture.
//
// Pictures between their exposure and their handing over are kept in a memory of their own, as in a
// camera. A picture that has no room in it when its exposure begins becomes a sample without a
// picture, also free-running: which ones these are depends on simulated time alone.
//
// The ground truth of a picture is computed with it, for a CameraTruthObserver that wants it, and
// reported when the picture is handed over.
//
// Automatic exposure acts with its lag, counted in exposures. It is clipped to the plan's period;
// paced, a picture that is not there when its lag is over is not measured.
//
// Bodies move linearly between where they were at the beginning and at the end of an exposure with
// its read-out (error: sim/scene/scene.h); ground, dust and air are those at its end.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "hil/world/camera_worker.h"
#include "hil/world/world_sensor.h"
#include "sim/camera/camera_sensor.h"
#include "sim/camera/image_sensor.h"

namespace rigwire::hil {

/// Picture memory of one camera: half a minute of 640 x 480 grey pixels at 30 Hz.
constexpr std::size_t kPictureMemory_bytes = std::size_t{256} << 20U;

struct WorldCameraSettings {
  std::string name;  ///< Name of the device in the rig.
  SensorMount mount;
  bool sees_own_link = false;  ///< Sees the body that it is mounted on.
  /// Time from the end of the exposure until the picture is handed over.
  Duration processing{0};
  /// Memory for pictures that are not handed over yet; a single picture always fits. Their truth
  /// needs 12 bytes more for each pixel of the pictures that a truth observer wants.
  std::size_t memory_bytes = kPictureMemory_bytes;
  sim::AutoExposureParameters auto_exposure;
};

/// Puts a PictureSample on the station's shelf for each exposure. `terrain` is the first of the
/// scene. Throws what `make` throws.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_camera(
    StationIndex station, const WorldCameraSettings& settings, const sim::Scene& scene,
    sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings,
    const CameraWorker::MakeSensor& make);

}  // namespace rigwire::hil
