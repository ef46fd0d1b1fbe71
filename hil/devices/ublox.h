// A u-blox receiver of a rig: its line, its antenna, what the device does and how well it measures.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "emulators/ublox/settings.h"
#include "fields/visitor.h"
#include "hil/configuration/gnss_fault.h"
#include "hil/wires/baud_check.h"
#include "hil/wires/usb_configuration.h"
#include "hil/world/mount.h"
#include "sim/gnss/gnss_parameters.h"

namespace rigwire::hil {

enum class SerialWire { pty, usb };
inline constexpr std::array<fields::Choice<SerialWire>, 2> kSerialWires{
    {{SerialWire::pty, "pty", "A pseudo-terminal under `path`."},
     {SerialWire::usb, "usb",
      "A device on the rig's USB server; the client's kernel makes a tty."}}};

/// A u-blox receiver on a serial line; as it stands, a NEO-7P.
struct UbloxConfiguration {
  static constexpr fields::Named kNamed{
      "ublox-neo-7p", "u-blox NEO-7P satellite receiver on a serial line (NMEA, UBX)."};

  SerialWire wire = SerialWire::pty;
  std::string path = "/tmp/rigwire/gnss";  ///< Symbolic link to the pty that a client opens.
  BaudCheck check_baud = BaudCheck::lenient;
  MountConfiguration mount;  ///< Of the antenna.
  emulators::UbloxSettings receiver;
  sim::GnssParameters sensor;
  std::vector<GnssFaultConfiguration> faults;
  std::vector<UnplugConfiguration> unplugged;  ///< On USB.

  UbloxConfiguration() : UbloxConfiguration(emulators::ublox_neo_7p()) {
    sensor.raw_measurements = true;  // RXM-RAW, when a client asks for it
  }

 protected:
  explicit UbloxConfiguration(const emulators::UbloxProfile& profile) {
    receiver.profile = &profile;
    receiver.baud = profile.baud;
    sensor.sky.maximum_channels = profile.channels;
  }
};

/// The other types differ in their profile, and in what they receive unless told otherwise.
struct UbloxM8Configuration : UbloxConfiguration {
  static constexpr fields::Named kNamed{
      "ublox-neo-m8", "u-blox NEO-M8 satellite receiver of several systems (NMEA, UBX)."};

  UbloxM8Configuration() : UbloxM8Configuration(emulators::ublox_neo_m8()) {}

 protected:
  explicit UbloxM8Configuration(const emulators::UbloxProfile& profile)
      : UbloxConfiguration(profile) {
    sensor.systems = {.gps = true, .glonass = true, .sbas = true, .qzss = true};
    sensor.raw_measurements = true;  // RXM-SFRBX, RXM-RAWX
  }
};
struct UbloxM8tConfiguration : UbloxM8Configuration {
  static constexpr fields::Named kNamed{
      "ublox-neo-m8t", "u-blox NEO-M8T, the same with raw measurements (NMEA, UBX)."};

  UbloxM8tConfiguration() : UbloxM8Configuration(emulators::ublox_neo_m8t()) {}
};
struct UbloxF9pConfiguration : UbloxConfiguration {
  static constexpr fields::Named kNamed{
      "ublox-zed-f9p", "u-blox ZED-F9P satellite receiver with carrier solution (NMEA, UBX)."};

  UbloxF9pConfiguration() : UbloxConfiguration(emulators::ublox_zed_f9p()) {
    sensor.systems = {
        .gps = true, .glonass = true, .galileo = true, .beidou = true, .sbas = true, .qzss = true};
    sensor.raw_measurements = true;  // RXM-RAWX
  }
};

inline void visit(fields::Visitor& v, UbloxConfiguration& p) {
  v.choice("wire", p.wire, kSerialWires, "What carries the bytes.");
  v.text("path", p.path, "Symbolic link to the pty; what a client opens.");
  v.choice("check_baud", p.check_baud, kBaudChecks, "When a client hears garbage.");
  visit(v, p.receiver);
  v.section("mount", p.mount, "Of the antenna.");
  v.section("sensor", p.sensor, "How well it knows where it is.");
  v.list("faults", p.faults, "What goes wrong, and when.");
  v.list("unplugged", p.unplugged, "On USB: when the plug is out.");
  v.check(p.unplugged.empty() || p.wire == SerialWire::usb, "unplugged",
          "only a device on USB has a plug that can be out", {}, "`wire: usb`");
}

inline void validate(const UbloxConfiguration& p) {
  validate(p.receiver);
  validate(p.sensor);
}

}  // namespace rigwire::hil
