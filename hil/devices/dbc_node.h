// A device of the user's own on CAN: its files, its bus, and what of the machine it is attached to.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/dbc_node/fault.h"
#include "emulators/dbc_node/quantities.h"
#include "emulators/own_clock.h"
#include "emulators/supply.h"
#include "fields/visitor.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/mounting.h"
#include "hil/devices/node_faults.h"
#include "hil/files/dbc_node_file.h"
#include "hil/world/shapes.h"
#include "sim/gnss/gnss_parameters.h"
#include "sim/imu/imu_sensor.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {

// What the device is attached to, each by its backend.
struct AttachedToNothing {
  using Backend = emulators::NothingBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "It measures and moves nothing."};
};
struct AttachedToJoint : JointConfiguration {
  using Backend = emulators::EncoderBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "The angle between two links of the machine."};
};
struct AttachedToLink {
  using Backend = emulators::ImuBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "A link, whose motion it feels."};

  MountConfiguration mount;
  sim::ImuParameters sensor;
};
struct AttachedToSky {
  using Backend = emulators::GnssBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "A link, with an antenna."};

  MountConfiguration mount;
  sim::GnssParameters sensor;
};
struct AttachedToValves {
  using Backend = emulators::ValveBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "The machine's valve block."};

  /// Actuators of the machine; number 1 of the binding's names is the first.
  std::vector<std::string> sections{"swing", "boom", "stick", "bucket"};
};
struct AttachedToPowerUnit {
  using Backend = emulators::PowerUnitBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "An engine that drives pumps."};
};
struct AttachedToVehicle {
  using Backend = emulators::VehicleBackend;
  static constexpr fields::Named kNamed{emulators::Attachment<Backend>::kName,
                                        "Drive train, steering and brakes."};

  sim::VehicleSensorParameters sensor;
  sim::OdometryParameters odometry;
};
inline void visit(fields::Visitor&, AttachedToNothing&) {}
void visit(fields::Visitor& v, AttachedToLink& p);
void visit(fields::Visitor& v, AttachedToSky& p);
void visit(fields::Visitor& v, AttachedToValves& p);
inline void visit(fields::Visitor&, AttachedToPowerUnit&) {}
void visit(fields::Visitor& v, AttachedToVehicle& p);

/// The source address of a rig's device that has its binding's.
inline constexpr std::uint8_t kAddressOfBinding = 254;

struct DbcNodeConfiguration final : DeviceConfigurationOf<DbcNodeConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::string file;  ///< The binding (hil/files/dbc_node_file.h).
  /// In place of the binding's, so that several of one kind can be on a bus.
  std::uint8_t source_address = kAddressOfBinding;
  std::variant<AttachedToNothing, AttachedToJoint, AttachedToLink, AttachedToSky, AttachedToValves,
               AttachedToPowerUnit, AttachedToVehicle>
      attached;
  emulators::SupplySettings supply;
  std::vector<
      NodeFault<NoSample, emulators::DbcNodeFault, emulators::SupplyFault, emulators::PaceFault>>
      faults;

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;

 private:
  /// Both files, with what the rig says. Throws ConfigurationError.
  [[nodiscard]] DbcNodeDescription description() const;
};

}  // namespace rigwire::hil
