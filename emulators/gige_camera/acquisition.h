// When the camera exposes: freely at a rate, by pulses of its line, or by a client's command.
//
// Free-running and by the line, the exposures are a sample plan; pulses that come while the sensor
// is not ready are passed over, as many as it takes. By software, exposures are counted; a command
// that comes while the sensor is not ready has no effect, and is counted as well.
//
// A picture belongs to the acquisition when its exposure began within it; of a limited acquisition
// the last one ends it.
#pragma once

#include <cstdint>

#include "emulators/bounded_queue.h"
#include "emulators/gige_camera/camera_features.h"
#include "sim/samples/picture_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Acquisition settings taken from the registers.
struct AcquisitionMeans {
  AcquisitionMode mode = AcquisitionMode::continuous;
  std::uint32_t frames = 1;  ///< Number of frames of a multi-frame acquisition.
  bool triggered = false;
  TriggerSource source = TriggerSource::software;
  Duration trigger_delay{0};
  Duration period{1};    ///< From exposure to exposure without a trigger; greater than 0.
  Duration shortest{1};  ///< The sensor is not ready earlier; greater than 0.
  CameraLine line;

  friend bool operator==(const AcquisitionMeans&, const AcquisitionMeans&) = default;
};

class Acquisition {
 public:
  [[nodiscard]] bool running() const { return running_; }
  void start(SimTime now, const AcquisitionMeans& means);
  void stop();
  /// The registers have changed; the exposures that are planned stay in step as far as can be.
  void change(SimTime now, const AcquisitionMeans& means);

  /// False: nothing waits for one, or the sensor is not ready.
  bool trigger(SimTime now);
  /// Triggers that were given in vain.
  [[nodiscard]] std::uint64_t ignored_triggers() const { return ignored_triggers_; }

  /// Lets delayed triggers take effect.
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// Exposures by themselves.
  [[nodiscard]] const SamplePlan& plan() const { return plan_; }
  /// Exposures by software since the start of the run.
  [[nodiscard]] std::uint32_t software_exposures() const { return software_exposures_; }

  /// Whether the picture of an exposure that began then is of this acquisition; counts it.
  [[nodiscard]] bool admit(SimTime exposure_start);

 private:
  void make_plan(SimTime from);

  AcquisitionMeans means_;
  bool running_ = false;
  SimTime started_{};
  std::uint32_t admitted_ = 0;
  SamplePlan plan_;
  BoundedQueue<SimTime, 16> delayed_;
  SimTime ready_at_{};  ///< For the next trigger by software.
  std::uint32_t software_exposures_ = 0;
  std::uint64_t ignored_triggers_ = 0;
};

}  // namespace rigwire::emulators
