// Where samples come from: the simulated world, a recording, or somebody else's simulator. The
// executive and the emulators do not notice which.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/samples/encoder_sample.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/imu_sample.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::hil {

/// Position of a device in the rig; addresses samples, plans and commands.
using DeviceIndex = std::size_t;

template <class Content>
struct Addressed {
  DeviceIndex device = 0;
  Content content;
};

/// The firings of one lidar.
struct LidarBlock {
  DeviceIndex device = 0;
  std::vector<LidarFiring> firings;
};

/// All samples of one slice of simulated time, each kind in order of time. Reused from slice to
/// slice so that its memory is taken once.
struct SampleBatch {
  SimTime from{};
  SimTime
      until{};  ///< Samples lie in (from, until]; those of the very first slice in [from, until].
  std::vector<Addressed<GnssSample>> gnss;
  std::vector<Addressed<ImuSample>> imu;
  std::vector<LidarBlock> lidar;  ///< One per lidar of the rig; kept by clear(), emptied.
  std::vector<Addressed<ValveSample>> valves;
  std::vector<Addressed<VehicleSample>> vehicles;
  std::vector<Addressed<EncoderSample>> encoders;
  std::vector<double> state;  ///< At `until`, in the order of TruthSource::state_quantities().

  void clear();
};

/// What flows from the devices back to the truth: actuator commands and changed sample plans.
struct TruthRequests {
  std::vector<Addressed<ValveCommand>> valve_commands;
  std::vector<Addressed<VehicleCommand>> vehicle_commands;
  std::vector<Addressed<SamplePlan>> plans;
  std::vector<Addressed<LidarCommand>> lidar_commands;

  void clear();
  [[nodiscard]] bool empty() const;
};

/// One number of the machine's state for the status table.
struct StateQuantity {
  std::string name;
  std::string unit;
};

/// CPU seconds that the truth has spent, by stage.
struct TruthStages {
  double physics_s = 0.0;
  double ray_casting_s = 0.0;
  double sensors_s = 0.0;
};

class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// The length of one slice, the grain in which truth is produced.
  [[nodiscard]] virtual Duration slice() const = 0;

  /// Takes the requests (they act from the present frontier on), then produces one more slice.
  /// Returns the text of a fault when truth can go no further (a state that is no number), else
  /// nullopt.
  virtual std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) = 0;

  /// What SampleBatch::state holds.
  [[nodiscard]] virtual const std::vector<StateQuantity>& state_quantities() const = 0;

  /// Read after the run.
  [[nodiscard]] virtual TruthStages stages() const = 0;
};

}  // namespace rigwire::hil
