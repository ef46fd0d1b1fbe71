// A Velodyne lidar of a rig: its ports, its mount, what the device does and how well it measures.
// One structure for all models; the types differ in the model, and each has the keys that its model
// can mean something by.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "emulators/velodyne/velodyne_settings.h"
#include "fields/visitor.h"
#include "hil/configuration/velodyne_fault.h"
#include "hil/world/lidar_sensor_configuration.h"
#include "hil/world/mount.h"

namespace rigwire::hil {

/// The sensor's web interface.
struct LidarWebConfiguration {
  std::string address = "127.0.0.1";  ///< Where it listens.
  std::uint16_t port = 0;             ///< 0: there is none.
  bool silent_refusals = false;       ///< Success is told for requests that are refused, too.
};

enum class SourcePorts {
  any,    ///< The system chooses.
  model,  ///< As the model: the destination's port, or the HDL-64E's 443.
};

/// Velodyne lidar on UDP; as it stands, an HDL-32E.
struct VelodyneConfiguration {
  static constexpr fields::Named kNamed{"velodyne-hdl-32e",
                                        "Velodyne HDL-32E spinning lidar on UDP."};

  bool allow_remote = false;   ///< Needed for addresses outside this machine.
  std::string source_address;  ///< Of the packets; empty: the system chooses.
  SourcePorts source_ports = SourcePorts::any;
  LidarWebConfiguration web;
  std::string time_source{kAutomaticTimeSource};  ///< One of the words below, or a device's name.
  std::string calibration_file;                   ///< HDL-64E; empty: the nominal unit.
  MountConfiguration mount;           ///< Frame S: x forward, y left, z up, on the spin axis.
  emulators::VelodyneSettings lidar;  ///< But for what settings_of() fills in from the others.
  LidarSensorConfiguration sensor;
  std::vector<VelodyneFaultConfiguration> faults;

  static constexpr std::string_view kAutomaticTimeSource = "auto";
  static constexpr std::string_view kIdealTimeSource = "ideal";
  static constexpr std::string_view kPulseTimeSource = "pulse";
  static constexpr std::string_view kNoTimeSource = "none";

  VelodyneConfiguration() : VelodyneConfiguration("HDL-32E") {}

 protected:
  explicit VelodyneConfiguration(const char* model) {
    lidar.model = model;
    lidar.host_address = "127.0.0.1";
  }
};

struct VelodyneVlp16Configuration : VelodyneConfiguration {
  static constexpr fields::Named kNamed{
      "velodyne-vlp-16", "Velodyne VLP-16 (Puck) spinning lidar on UDP, web interface."};

  VelodyneVlp16Configuration() : VelodyneConfiguration("VLP-16") {}
};
struct VelodynePuckHiResConfiguration : VelodyneConfiguration {
  static constexpr fields::Named kNamed{
      "velodyne-puck-hi-res", "Velodyne Puck Hi-Res spinning lidar on UDP, web interface."};

  VelodynePuckHiResConfiguration() : VelodyneConfiguration("Puck Hi-Res") {}
};
struct VelodyneVlp32cConfiguration : VelodyneConfiguration {
  static constexpr fields::Named kNamed{
      "velodyne-vlp-32c", "Velodyne VLP-32C (Ultra Puck) spinning lidar on UDP, web interface."};

  VelodyneVlp32cConfiguration() : VelodyneConfiguration("VLP-32C") {}
};
struct VelodyneHdl64eConfiguration : VelodyneConfiguration {
  static constexpr fields::Named kNamed{"velodyne-hdl-64e",
                                        "Velodyne HDL-64E S2 spinning lidar on UDP."};

  VelodyneHdl64eConfiguration() : VelodyneConfiguration("HDL-64E S2") {}
};
struct VelodyneVls128Configuration : VelodyneConfiguration {
  static constexpr fields::Named kNamed{
      "velodyne-vls-128", "Velodyne VLS-128 (Alpha Prime) spinning lidar on UDP, web interface."};

  VelodyneVls128Configuration() : VelodyneConfiguration("VLS-128") {}
};

/// What the emulator is to be given: with the faults, the source of its time and the calibration
/// read from its file. Throws std::runtime_error for a file that cannot be used.
[[nodiscard]] emulators::VelodyneSettings settings_of(const VelodyneConfiguration& configuration);

/// Its model table. Precondition: one of the types above.
[[nodiscard]] const protocols::velodyne::Model& model_of(
    const VelodyneConfiguration& configuration);

/// Whether it may send there: loopback, or anywhere with `allow_remote`.
[[nodiscard]] bool permits(const VelodyneConfiguration& configuration, std::string_view address);

inline constexpr std::array<fields::Choice<protocols::velodyne::ReturnMode>, 3> kReturnModes{
    {{protocols::velodyne::ReturnMode::strongest, "strongest", "The strongest echo of a shot."},
     {protocols::velodyne::ReturnMode::last, "last", "The last echo of a shot."},
     {protocols::velodyne::ReturnMode::dual, "dual", "Both, or the second strongest."}}};
inline constexpr std::array<fields::Choice<SourcePorts>, 2> kSourcePorts{
    {{SourcePorts::any, "any", "The system chooses them."},
     {SourcePorts::model, "model", "As the sensor: the destination's, or 443."}}};
}  // namespace rigwire::hil

namespace rigwire::emulators {

inline constexpr std::array<fields::Choice<emulators::VelodyneReflectivity>, 4> kReflectivityScales{
    {{emulators::VelodyneReflectivity::model, "model", "As the model does."},
     {emulators::VelodyneReflectivity::to_100, "to_100", "Retro-reflectors from 101."},
     {emulators::VelodyneReflectivity::to_110, "to_110", "Retro-reflectors from 111."},
     {emulators::VelodyneReflectivity::full, "full", "0 .. 255, retro-reflectors at 255."}}};

}  // namespace rigwire::emulators

namespace rigwire::hil {

/// Groups of the settings that share a section.
struct LidarViewKeys {
  emulators::VelodyneSettings* lidar;
};
struct LidarPhaseLockKeys {
  emulators::VelodyneSettings* lidar;
};
struct LidarClockKeys {
  emulators::VelodyneSettings* lidar;
};
struct LidarInertialKeys {
  emulators::VelodyneSettings* lidar;
};

inline void visit(fields::Visitor& v, LidarViewKeys& p) {
  v.integer("start", p.lidar->view_start_deg, fields::IntegerRule{0, 359}, "Degrees, clockwise.");
  v.integer("end", p.lidar->view_end_deg, fields::IntegerRule{0, 359},
            "Included; may lie beyond 0.");
}

inline void visit(fields::Visitor& v, LidarPhaseLockKeys& p) {
  v.boolean("enabled", p.lidar->phase_lock, "The rotor passes the offset at each full second.");
  v.integer("offset", p.lidar->phase_lock_offset_centideg, fields::IntegerRule{0, 35999},
            "Hundredths of a degree.");
}

inline void visit(fields::Visitor& v, LidarClockKeys& p) {
  v.number("drift", p.lidar->clock_drift_ppm, fields::in("ppm").stored_as("ppm").between(-200, 200),
           "Of the sensor's own crystal; positive: fast.");
  v.duration("pulse_length", p.lidar->pulse_length, {20'000'000, 200'000'000},
             "Of the pulse per second.");
  v.duration("sentence_delay", p.lidar->sentence_delay, {50'000'000, 500'000'000},
             "From the pulse's end to the sentence.");
  v.boolean("sentence_tenths", p.lidar->sentence_tenths, "Sentences tell tenths of seconds.");
  v.boolean("pulse_without_fix", p.lidar->pulse_without_fix, "There are pulses before a fix.");
  v.duration("pulse_qualifier_delay", p.lidar->pulse_qualifier_delay, {0, 65'535'000'000'000},
             "Good pulses for so long: locked.");
  v.boolean("pulse_needs_valid_receiver", p.lidar->pulse_needs_valid_receiver,
            "Locked only while sentences say 'A'.");
  v.boolean("sentence_needs_valid", p.lidar->sentence_needs_valid,
            "Only sentences that say 'A' set the time.");
}

}  // namespace rigwire::hil

namespace rigwire::emulators {

inline void visit(fields::Visitor& v, emulators::VelodyneInertialAxes& p) {
  v.vector3("gyro", p.gyro, fields::plain().between(-1, 1), "Unit vector, or 0 0 0 for none.");
  v.vector3("acceleration_x", p.acceleration_x, fields::plain().between(-1, 1), "The same.");
  v.vector3("acceleration_y", p.acceleration_y, fields::plain().between(-1, 1), "The same.");
}

}  // namespace rigwire::emulators

namespace rigwire::hil {

inline void visit(fields::Visitor& v, LidarInertialKeys& p) {
  v.section("first", p.lidar->inertial_axes[0], "Along which it measures, in the sensor's frame.");
  v.section("second", p.lidar->inertial_axes[1], "The same.");
  v.section("third", p.lidar->inertial_axes[2], "The same.");
}

inline void visit(fields::Visitor& v, LidarWebConfiguration& p) {
  v.text("address", p.address, "Where it listens, an IPv4 address.");
  v.integer("port", p.port, fields::IntegerRule{0, 65535}, "0 = there is none.");
  v.boolean("silent_refusals", p.silent_refusals, "Answers success to what it refuses, too.");
}

inline void visit(fields::Visitor& v, VelodyneConfiguration& p) {
  using protocols::velodyne::PositionLayout;
  const protocols::velodyne::Model& model = model_of(p);
  v.text("address", p.lidar.host_address, "Where the packets go, an IPv4 address.");
  v.integer("port", p.lidar.data_port, fields::IntegerRule{1, 65535}, "Of the data packets.");
  if (model.position_layout != PositionLayout::none) {
    v.integer("position_port", p.lidar.telemetry_port, fields::IntegerRule{1, 65535},
              "Of the position packets.");
  }
  v.boolean("allow_remote", p.allow_remote, "Permits addresses outside this machine.");
  v.text("source_address", p.source_address, "Of the packets; empty = the system chooses.");
  v.choice("source_ports", p.source_ports, kSourcePorts, "Of the packets.");
  if (!model.status_channel) {
    v.section("web", p.web, "The sensor's web interface.");
  }
  v.number("rate", p.lidar.rotor_rpm, fields::in("rpm").stored_as("rpm").between(0, 1200),
           "Of the rotor; 10 Hz is 600 rpm; 0 = it stands.");
  v.choice("return_mode", p.lidar.return_mode, kReturnModes, "Which echoes are sent.");
  v.boolean("laser", p.lidar.laser_on, "Whether it fires.");
  LidarViewKeys view{&p.lidar};
  LidarPhaseLockKeys phase_lock{&p.lidar};
  LidarClockKeys clock{&p.lidar};
  v.section("fov", view, "Where it fires; whole degrees.");
  v.section("phase_lock", phase_lock, "Of the rotor to the pulse per second.");
  v.text("serial", p.lidar.serial_number, "As the web interface tells it.");
  if (!model.status_channel) {
    v.boolean("legacy_factory_bytes", p.lidar.legacy_factory_bytes, "As firmware before 2.2.20.");
  } else {
    v.file("calibration", p.calibration_file, "Of the unit, YAML; empty = nominal.");
  }
  v.choice("reflectivity", p.lidar.reflectivity, emulators::kReflectivityScales,
           "Scale of that byte.");
  v.boolean("vertical_offsets", p.lidar.vertical_offsets, "Each beam leaves from its own height.");
  v.number("minimum_range", p.lidar.minimum_range_m, fields::in("m").between(0, 1000),
           "0 = the model's.");
  v.number("maximum_range", p.lidar.maximum_range_m, fields::in("m").between(0, 1000),
           "0 = the model's.");
  v.duration("send_delay", p.lidar.send_delay, {0, 100'000'000}, "From the last shot to the wire.");
  if (model.position_layout != PositionLayout::none) {
    v.duration("position_period", p.lidar.position_period, {0, 10'000'000'000},
               "Between position packets; 0 = as long as 14 data packets.");
  }
  v.duration("start_up", p.lidar.start_up, {0, 600'000'000'000},
             "From power-on to the first packet; 0 = it runs already.");
  v.text("time_source", p.time_source,
         "Satellite receiver; auto = the first one, locked; or ideal, pulse, none.");
  v.section("clock", clock, "How it keeps and is told the time.");
  if (model.position_layout == PositionLayout::inertial) {
    LidarInertialKeys inertial{&p.lidar};
    v.section("inertial", inertial, "Directions of its gyroscopes and accelerometers.");
  }
  v.section("mount", p.mount, "Of the spin axis.");
  v.section("sensor", p.sensor, "How well it measures.");
  v.list("faults", p.faults, "What goes wrong, and when.");
}

/// Settings of the emulators and sensors validate themselves; these pass the wish on.
void validate(const VelodyneConfiguration& p);

}  // namespace rigwire::hil
