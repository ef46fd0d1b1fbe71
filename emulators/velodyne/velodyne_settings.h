// Settings of an emulated Velodyne lidar: what it is, the settings that it keeps, its time source,
// and its faults.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "emulators/live_setting.h"
#include "emulators/supply.h"
#include "emulators/velodyne/velodyne_control.h"
#include "emulators/velodyne/velodyne_fault.h"
#include "fields/rules.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire::emulators {

/// What is on the sensor's pulse and sentence input.
enum class VelodyneTimeSource : std::uint8_t {
  none,        ///< Nothing: the counter runs from power-up.
  pulse_only,  ///< A pulse per second, but no sentence.
  receiver,    ///< The rig's satellite receiver, as given to observe_fix().
  ideal,       ///< Warm: locked from power-up on, sentences with the fix that is known.
};

/// Firmware version, where it changes what is on the wire: in the VLS-128, the duration of a
/// firing.
enum class VelodyneFirmware : std::uint8_t {
  newest,
  until_5_1_7,
};

/// How the reflectivity byte is scaled.
enum class VelodyneReflectivity : std::uint8_t {
  model,   ///< Scale of the model.
  to_100,  ///< 0 .. 100 diffuse per cent, 101 .. 255 retro-reflector.
  to_110,  ///< 0 .. 110 and 111 .. 255 (VLS-128).
  full,    ///< 0 .. 255 diffuse, retro-reflectors at 255 (old HDL-32E, HDL-64E).
};

/// Directions in the sensor's frame that the parts of one inertial group measure along; of unit
/// length or zero (not fitted).
struct VelodyneInertialAxes {
  Vector3 gyro;
  Vector3 acceleration_x;
  Vector3 acceleration_y;
};

void visit(fields::Visitor& v, VelodyneInertialAxes& p);
/// Throws std::invalid_argument for a direction that is neither of unit length nor zero.
void validate(const VelodyneInertialAxes& axes);

/// Each group turns about one axis and feels the two others, in cyclic order. The manual shows the
/// real arrangement in a figure only that could not be read: measure it on a unit and set it here.
inline constexpr std::array<VelodyneInertialAxes, protocols::velodyne::kInertialGroups>
    kDefaultInertialAxes{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                          {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}};

struct VelodyneSettings {
  std::string model = "HDL-32E";
  VelodyneFirmware firmware = VelodyneFirmware::newest;
  std::string serial_number = "11001210145135";

  /// What the sensor has saved: in force from power-up and after every reset.
  VelodyneLiveSettings saved;

  /// Firmware before 2.2.20.0: both factory bytes are zero.
  bool legacy_factory_bytes = false;
  VelodyneReflectivity reflectivity = VelodyneReflectivity::model;
  /// Calibration of an HDL-64E; without one, the nominal table with corrections of a usual size.
  /// The unit measures with it and reports it in its status channel, rounded to what that can
  /// carry.
  std::optional<protocols::velodyne::Hdl64eCalibration> calibration;
  /// False: all beams leave from the origin, for clients that ignore the offsets.
  bool vertical_offsets = true;
  /// Returns outside are reported as none. Zero: the model's own limit.
  double minimum_range_m = 0.0;
  double maximum_range_m = 0.0;
  /// Where the head just sees a 90 % surface, for dirt on its window. 0: at the maximum range.
  double reference_range_m = 0.0;
  /// From the last laser's shot to the packet's start on the wire.
  Duration send_delay = std::chrono::microseconds{5};
  /// Zero: as long as 14 single-return data packets last (7.741 44 ms for the HDL-32E).
  Duration position_period{0};
  /// A position packet waits up to so long for its place between data packets, evenly drawn; at
  /// most the period. In real sensors at least as long as a data packet lasts.
  Duration position_wait{0};
  /// From power-up or reset to the first firing that is sent, 0 .. 600 s. 0: running at once, with
  /// the rotor at speed; a reset then takes kResetTime.
  Duration start_up{0};

  VelodyneTimeSource time_source = VelodyneTimeSource::ideal;
  double clock_drift_ppm = 0.0;  ///< Drift of the sensor's crystal, -200 .. 200; positive: fast.
  Duration pulse_length = std::chrono::milliseconds{100};  ///< 20 .. 200 ms
  Duration sentence_delay =
      std::chrono::milliseconds{50};  ///< After the pulse's end, 50 .. 500 ms.
  bool sentence_tenths = false;       ///< "hhmmss.s" instead of "hhmmss".
  bool pulse_without_fix = false;     ///< The receiver gives pulses before it has a fix.
  Duration pulse_qualifier_delay = std::chrono::seconds{5};  ///< Good pulses for so long: locked.
  bool pulse_needs_valid_receiver = false;                   ///< Lock only while sentences say 'A'.
  bool sentence_needs_valid = true;  ///< Only sentences that say 'A' set the time.

  std::array<VelodyneInertialAxes, protocols::velodyne::kInertialGroups> inertial_axes =
      kDefaultInertialAxes;

  std::vector<VelodyneFault> faults;
  std::vector<SupplyFault> supply_faults;
  /// Seed of the unit's random properties and of the faults that have a probability.
  std::uint64_t seed = 1;
};

/// How long a sensor whose `start_up` is zero is silent after a reset. Not documented by the maker.
inline constexpr Duration kResetTime = std::chrono::seconds{10};

/// Each model has the keys that it can mean something by. What the sensor's network has besides,
/// its source of time, its calibration and its faults come from elsewhere. Throws
/// std::invalid_argument for an unknown model.
void visit(fields::Visitor& v, VelodyneSettings& p);
/// Throws std::invalid_argument naming the member, the value found and what is allowed; also for
/// what the model cannot do.
void validate(const VelodyneSettings& settings);
/// Whether a device with these settings can have it. Throws std::invalid_argument.
void check_fault(const VelodyneFault& fault, const VelodyneSettings& settings);

/// Settings that can be changed on a running sensor: the rows change `live`, for
/// VelodyneControl::apply(). The position packets' port is among them only if the model sends such
/// packets.
using VelodyneLiveRow = LiveSetting<VelodyneLiveSettings, VelodyneSettings>;
[[nodiscard]] std::span<const VelodyneLiveRow> velodyne_live_settings(
    const protocols::velodyne::Model& model);

/// Its model table. Throws std::invalid_argument for an unknown one.
[[nodiscard]] const protocols::velodyne::Model& model_of(const VelodyneSettings& settings);

/// Limits of what is reported: the setting, or the model's own.
struct VelodyneRangeWindow {
  double minimum_m = 0.0;
  double maximum_m = 0.0;
};
[[nodiscard]] VelodyneRangeWindow range_window(const VelodyneSettings& settings,
                                               const protocols::velodyne::Model& model);
/// Time between position packets: the setting, or that of 14 data packets.
[[nodiscard]] Duration position_period(const VelodyneSettings& settings,
                                       const protocols::velodyne::Model& model);

}  // namespace rigwire::emulators
