// Observers of the ground truth, beside the devices. The simulated world knows no files;
// hil/record/truth_tap.h, hil/record/lidar_truth_tap.h and hil/record/camera_truth_tap.h write
// them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/camera/camera_sensor.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/link_motion.h"
#include "sim/local_frame.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/picture_sample.h"
#include "sim/samples/power_unit_sample.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::hil {

/// Where a satellite receiver's antenna is.
struct AntennaTruth {
  std::string_view device;  ///< Name in the rig; holds as long as the world.
  sim::GeodeticPoint place;
};

/// What solid things did to the machine in its last inner step, and since the start.
struct ContactTruth {
  bool touching = false;
  std::string_view body;  ///< Link of the machine; empty without contact.
  /// The obstacle's name in the scene, or "terrain"; empty without contact. Both names live as long
  /// as the world.
  std::string_view with;
  /// Position of the point with the largest force.
  Eigen::Vector3d place_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_W = Eigen::Vector3d::Zero();  ///< Sum, on the machine.
  double deepest_m = 0.0;
  double dent_m = 0.0;
  double pressed_m = 0.0;
  double sunk_m = 0.0;
  double lost_j = 0.0;     ///< Since the start.
  std::size_t felled = 0;  ///< Trees, since the start.
};

/// A rock or crate that is not where it began.
struct MovedBodyTruth {
  std::string_view name;  ///< In the scene; holds as long as the world.
  sim::LinkMotion motion;
};

/// A quantity of the machine, as in `read` and `wait` (hil/world/quantities.h).
struct StateTruth {
  std::string_view name;  ///< Holds as long as the world.
  double value = 0.0;     ///< In the quantity's unit.
};

/// Ground truth of the machine at one instant.
struct TruthRecord {
  SimTime time{};
  /// Motion of all links of the machine; the first carries it.
  std::vector<sim::LinkMotion> links;
  std::vector<double> machine;    ///< In the order of the machine's truth fields.
  std::vector<StateTruth> state;  ///< In the order of state_quantities().
  /// What the transducers of the ports that the machine has read, without errors.
  std::optional<ValveSample> valves;
  std::optional<VehicleSample> vehicle;
  std::optional<PowerUnitSample> power_unit;
  std::optional<ContactTruth> contact;  ///< For machines that can touch obstacles.
  std::vector<MovedBodyTruth> moved;
  std::vector<std::string_view> hand;  ///< Overridden set points (hil/world/hand.h).
  std::vector<AntennaTruth> antennas;  ///< In the order in which their sensors were added.
};

class TruthObserver {
 public:
  virtual ~TruthObserver() = default;
  /// In order of time.
  virtual void record(const TruthRecord& record) = 0;
};

class LidarTruthObserver {
 public:
  virtual ~LidarTruthObserver() = default;
  /// Receives all shots of these firings of the lidar of that name in the rig; `truth` has one
  /// entry per firing. Called slice by slice, and within one in the order in which the lidars were
  /// added.
  virtual void record(std::string_view lidar, const LidarPattern& pattern,
                      const std::vector<LidarFiring>& firings,
                      const std::vector<sim::LidarBankTruth>& truth) = 0;
};

/// A picture that was handed to its camera, with its ground truth.
struct CameraTruthRecord {
  std::uint64_t exposure = 0;  ///< Number of the camera's exposure, from 0; skipped ones count.
  std::shared_ptr<const Picture> picture;
  sim::CameraTruth truth;  ///< Truth of the picture's first part.
};

class CameraTruthObserver {
 public:
  virtual ~CameraTruthObserver() = default;
  /// Returns whether to compute the truth of a picture of the camera of that name in the rig, whose
  /// exposure begins at `start`; called when the exposure is over.
  [[nodiscard]] virtual bool wants(std::string_view camera, SimTime start) const = 0;
  /// Called when the picture is handed over, in the order of each camera's exposures; not called
  /// for a skipped picture.
  virtual void record(std::string_view camera, CameraTruthRecord record) = 0;
};

}  // namespace rigwire::hil
