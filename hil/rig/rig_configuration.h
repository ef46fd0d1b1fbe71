// A rig: one machine in one scene with its devices and their wires. What `rigwire run` runs.
//
//   configs/rigs/excavator_pit.yaml is the commented example; docs/configuration.md the reference.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/fault_window.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "hil/devices/device_types.h"
#include "hil/devices/site.h"
#include "hil/wires/modbus_line_configuration.h"
#include "hil/wires/usb_configuration.h"
#include "hil/world/machine.h"
#include "hil/world/scene.h"
#include "hil/world/sky.h"
#include "hil/world/surroundings.h"
#include "sim/samples/calendar.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Ground truth leaves here and nowhere else.
struct TruthConfiguration {
  std::string path;  ///< File; empty = none. `run --truth FILE` overrides it.
  /// File for every lidar shot; empty = none. `run --lidar-truth FILE` overrides it.
  std::string lidar_path;
  /// Folder for every picture; empty = none. `run --camera-truth FOLDER` overrides it.
  std::string camera_folder;
  std::vector<std::string> cameras;  ///< Cameras whose pictures are written; empty = all.
  Duration period = std::chrono::milliseconds(10);
  Duration clouds_every{0};  ///< Period of each lidar's clouds in a recording; 0: none.
};

struct StatusConfiguration {
  Duration period = std::chrono::milliseconds(500);
};

struct RigConfiguration {
  std::string name = "rig";
  std::string text;        ///< One line for `rigwire list rigs`.
  std::uint64_t seed = 1;  ///< Seed of every random stream.
  UtcTime start{2026, 6, 1, 8, 0, 0, 0};
  Duration step = std::chrono::milliseconds(1);   ///< Step of the physics.
  Duration slice = std::chrono::milliseconds(2);  ///< Steps computed at once; whole steps.
  Duration lead = std::chrono::milliseconds(6);   ///< How far truth is computed ahead of the clock.
  OriginConfiguration origin;
  SatellitesConfiguration satellites;
  SceneConfiguration scene;
  MachineConfiguration machine;
  SurroundingsConfiguration surroundings;
  std::map<std::string, BusConfiguration> buses;
  std::map<std::string, ModbusLineConfiguration> modbus;
  UsbConfiguration usb;
  std::map<std::string, ConfiguredDevice> devices;
  TruthConfiguration truth;
  StatusConfiguration status;
};

inline void visit(fields::Visitor& v, TruthConfiguration& p) {
  v.text("path", p.path, "File; empty = none. `run --truth FILE` beats it.");
  v.text("lidar_path", p.lidar_path,
         "File of every lidar shot; `run --lidar-truth FILE` beats it.");
  v.text("camera_folder", p.camera_folder,
         "Folder for what is true behind every picture; `run --camera-truth FOLDER` beats it.");
  v.texts("cameras", p.cameras, "Cameras whose pictures go to that folder; empty = all.");
  v.rate("rate", p.period, fields::in("Hz").above(0).at_most(1000),
         "Records per second of run --truth and --record.");
  v.duration("clouds_every", p.clouds_every, {0, 3'600'000'000'000},
             "Between two point clouds of each lidar in a recording's truth, a turn each, decoded "
             "from its packets; 0 = none.");
}

inline void visit(fields::Visitor& v, StatusConfiguration& p) {
  v.duration("period", p.period, {50'000'000, 60'000'000'000},
             "Between two pictures of the table.");
}

inline void visit(fields::Visitor& v, RigConfiguration& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line for `rigwire list rigs`.");
  v.integer("seed", p.seed, fields::IntegerRule{0},
            "Seed of every random stream: same seed, same bytes.");
  v.spelled("start", utc_spelling(p.start), "UTC at the start of the run.");
  v.duration("step", p.step, {10'000, 20'000'000}, "Step of the physics.");
  v.duration("slice", p.slice, {10'000, 100'000'000}, "Computed at once; whole steps.");
  v.duration("lead", p.lead, {10'000, 1'000'000'000},
             "How far truth is computed ahead of the clock; at least a slice.");
  v.section("origin", p.origin, "Origin of the world frame (x east, y north, z up) on Earth.");
  v.section("satellites", p.satellites, "Satellites in the sky, for all receivers.");
  v.section("scene", p.scene, "Terrain, rocks, objects.");
  v.required("machine");
  v.section("machine", p.machine, "The machine.");
  v.section("surroundings", p.surroundings, "What goes wrong around the devices.");
  v.named("buses", p.buses, "bus", "CAN buses, by name.");
  v.named("modbus", p.modbus, "line", "Modbus lines that devices share, by name.");
  v.section("usb", p.usb, "The server for devices on USB.");
  v.named("devices", p.devices, "device", "Devices, by name.");
  v.section("truth", p.truth, "The tap for ground truth.");
  v.section("status", p.status, "The table.");
}

/// A rig read from its files.
struct LoadedRig {
  RigConfiguration configuration;
  Origins origins;
};

/// Reads the file, applies the `--set` arguments, checks every field and how the fields fit
/// together. Throws ConfigurationError with all findings.
[[nodiscard]] LoadedRig load_rig(const std::string& file, const std::vector<std::string>& sets);

/// Returns the hash of the effective configuration; see hash_text().
[[nodiscard]] std::string config_hash(const RigConfiguration& configuration);

/// Returns the effective configuration as YAML with the origin of each value; it loads to the same
/// hash.
[[nodiscard]] std::string print_rig(const LoadedRig& rig);

/// Returns the effective configuration as YAML without origins, which differ between machines.
[[nodiscard]] std::string print_rig(const RigConfiguration& configuration);
/// Names of the devices that make pictures.
[[nodiscard]] std::vector<std::string> camera_names(const RigConfiguration& configuration);

/// What devices may know of the rig. Refers to the configuration.
[[nodiscard]] RigView view_of(const RigConfiguration& configuration);

/// Shows every fault of devices, buses, lines and surroundings, in the order of their kinds and
/// names.
void each_fault(RigConfiguration& configuration,
                const std::function<void(const std::string& where, FaultPeriod& when,
                                         const std::string& name)>& take);
/// When they act, in that order.
[[nodiscard]] std::vector<FaultWindow> fault_windows(const RigConfiguration& configuration);

/// How the messages on a bus are laid out, each device under its name in the rig and with its
/// configured address. Empty when the rig has no such bus. Throws std::invalid_argument for
/// settings that make no device.
[[nodiscard]] std::vector<protocols::can::OwnedMessage> bus_messages(
    const RigConfiguration& configuration, const std::string& bus);

/// What a single field cannot know: mounts on links that exist, buses that exist, addresses and
/// ports taken twice, wires that cannot carry what their devices send, remote addresses without
/// opt-in, step and lead.
void check_rig(const RigConfiguration& configuration, const Origins& origins, Problems& problems);

}  // namespace rigwire::hil
