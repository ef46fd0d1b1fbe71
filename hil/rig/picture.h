// Takes one picture of a rig's camera without a run: no wire is opened, no client is there.
//
// The world runs free from the start to the exposure, as in a run without commands: the machine
// does not move, unless it is asked to drive straight ahead. The camera is in its state at
// power-on, with every part that its kind can make. With automatic exposure or gain it takes up to
// 32 pictures before, at its own rate or quicker, so that they settle. The same configuration and
// seed give the same bytes.
#pragma once

#include <optional>
#include <string>

#include "hil/record/run_log.h"
#include "hil/rig/rig_configuration.h"
#include "hil/world/picture_layers.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct PictureRequest {
  std::string device{};                           ///< Name in the rig; empty: its only camera.
  SimTime at = kStart + std::chrono::seconds(1);  ///< Start of the exposure.
  std::optional<double> travel_mps{};  ///< Held by the machine's own controller, from the start.
};

struct TakenPicture {
  std::string device;
  KeptPicture kept;
};

/// Throws std::invalid_argument for a device that is no camera of the rig, naming those that are,
/// for an instant before the start, and for a speed of a machine that does not drive;
/// std::runtime_error when the world or the camera fails. `log` may be null.
[[nodiscard]] TakenPicture take_picture(const RigConfiguration& configuration,
                                        const PictureRequest& request, RunLog* log = nullptr);

}  // namespace rigwire::hil
