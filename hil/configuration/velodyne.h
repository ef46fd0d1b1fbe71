// A Velodyne lidar of a rig: its ports, its mount, what the device does and how well it measures.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/velodyne/velodyne_lidar.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/lidar_sensor.h"
#include "hil/configuration/mount.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

/// Velodyne HDL-32E on UDP.
struct VelodyneConfiguration {
  std::string address = "127.0.0.1";  ///< Destination of the packets.
  std::uint16_t port = 2368;
  std::uint16_t position_port = 8308;
  bool allow_remote = false;  ///< Needed for a destination outside this machine.
  MountConfiguration mount;   ///< Frame S: x forward, y left, z up, on the spin axis.
  emulators::VelodyneSettings lidar;
  sim::SpinningLidarParameters sensor;
};

inline constexpr std::array<Choice<protocols::velodyne::ReturnMode>, 2> kReturnModes{
    {{protocols::velodyne::ReturnMode::strongest, "strongest", "The strongest echo of a shot."},
     {protocols::velodyne::ReturnMode::last, "last", "The last echo of a shot."}}};

template <class Visitor>
void visit(Visitor& v, VelodyneConfiguration& p) {
  v.text("address", p.address, "Where the packets go, an IPv4 address.");
  v.integer("port", p.port, IntegerRule{1, 65535}, "Of the data packets.");
  v.integer("position_port", p.position_port, IntegerRule{1, 65535}, "Of the position packets.");
  v.boolean("allow_remote", p.allow_remote, "Permits an address outside this machine.");
  v.number("rate", p.lidar.rotor_rpm, in("rpm").stored_as("rpm").above(0).at_most(1200),
           "Of the rotor; 10 Hz is 600 rpm.");
  v.choice("return_mode", p.lidar.return_mode, kReturnModes, "Which echo is sent.");
  v.boolean("legacy_factory_bytes", p.lidar.legacy_factory_bytes, "As firmware before 2.2.20.");
  v.boolean("vertical_offsets", p.lidar.vertical_offsets, "Each beam leaves from its own height.");
  v.number("minimum_range", p.lidar.minimum_range_m, in("m").between(0, 1000), "0 = the model's.");
  v.number("maximum_range", p.lidar.maximum_range_m, in("m").between(0, 1000), "0 = the model's.");
  v.duration("send_delay", p.lidar.send_delay, {0, 100'000'000}, "From the last shot to the wire.");
  v.duration("position_period", p.lidar.position_period, {0, 10'000'000'000},
             "Between position packets; 0 = as long as 14 data packets.");
  v.section("mount", p.mount, "Of the spin axis.");
  v.section("sensor", p.sensor, "How well it measures.");
}

// Settings of the emulators and sensors validate themselves; these pass the wish on.
inline void validate(const VelodyneConfiguration& p) {
  validate(p.lidar);
  validate(p.sensor);
}

}  // namespace rigwire::hil
