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

inline constexpr std::array<fields::Choice<SourcePorts>, 2> kSourcePorts{
    {{SourcePorts::any, "any", "The system chooses them."},
     {SourcePorts::model, "model", "As the sensor: the destination's, or 443."}}};

inline void visit(fields::Visitor& v, LidarWebConfiguration& p) {
  v.text("address", p.address, "Where it listens, an IPv4 address.");
  v.integer("port", p.port, fields::IntegerRule{0, 65535}, "0 = there is none.");
  v.boolean("silent_refusals", p.silent_refusals, "Answers success to what it refuses, too.");
}

inline void visit(fields::Visitor& v, VelodyneConfiguration& p) {
  visit(v, p.lidar);
  v.boolean("allow_remote", p.allow_remote, "Permits addresses outside this machine.");
  v.text("source_address", p.source_address, "Of the packets; empty = the system chooses.");
  v.choice("source_ports", p.source_ports, kSourcePorts, "Of the packets.");
  const bool has_status_channel = model_of(p).status_channel;
  if (!has_status_channel) {
    v.section("web", p.web, "The sensor's web interface.");
  }
  if (has_status_channel) {
    v.file("calibration", p.calibration_file, "Of the unit, YAML; empty = nominal.");
  }
  v.text("time_source", p.time_source,
         "Satellite receiver; auto = the first one, locked; or ideal, pulse, none.");
  v.section("mount", p.mount, "Of the spin axis.");
  v.section("sensor", p.sensor, "How well it measures.");
  v.list("faults", p.faults, "What goes wrong, and when.");
}

/// Settings of the emulators and sensors validate themselves; these pass the wish on.
void validate(const VelodyneConfiguration& p);

}  // namespace rigwire::hil
