// What a camera's sensor and its device say to each other.
#pragma once

#include "sim/samples/picture_sample.h"

namespace rigwire::emulators {

/// Exposures are the device's sample plan and its command's triggers
/// (sim/samples/picture_sample.h).
class CameraBackend {
 public:
  using Sample = PictureSample;
  using Command = CameraCommand;

  virtual ~CameraBackend() = default;
  /// What the camera wants of its sensor at present.
  [[nodiscard]] virtual const Command& command() const = 0;
  virtual void update(const Sample& sample) = 0;
};

}  // namespace rigwire::emulators
