// A rig ready to run: truth source, devices and wires, built from its configuration.
//
// Order. What is due at equal instants runs in the order in which it was added to the executive
// (events by themselves, outlets by themselves), so that the order of construction determines the
// output:
//   1. CAN buses by name: bus, outlet.
//   1. CAN buses by name: bus, outlet.
//   2. Modbus lines by name: line, outlet.
//   3. Devices by name; within a device station, outlets, further stations. What a device sends on
//      a bus or a shared line waits in the outlet of that. A Modbus line of its own is added with
//      its outlet, before it.
//   4. Faults of the buses, which know their devices by name. Every fault of the file gets its
//      number then: devices first, then buses, then lines.
//   5. Device::connect() of each device, by name.
//   6. Truth taps, and what else is recorded.
//
// The USB server is added before the first bus or device that asks for it. A different order is
// another byte stream.
//
// Seeds. Every random stream has a name, so that a device that is added changes no other:
//
//   "<device>" ...            what its sensor measures; sensors add names of their own
//   "<device>/line"           what is random in the device and on its own line
//   "<device>/motion"         the inertial unit in a lidar's housing
//   "modbus.<line>/line"      delays and faults of a shared Modbus line
//   "<bus>/faults"            faults of a CAN bus
//
// A changed name is another byte stream, too.
//
// Ownership. The rig owns everything but the io_context, which must outlive it. Objects are made
// before those that refer to them, and destroyed after them: world, executive, buses, Modbus lines,
// devices; only the USB server is destroyed before what is plugged into it.
//
// Errors. The constructor throws, and closes what was open. After that nothing throws: a fault ends
// the run with RunOutcome::fault.
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "drivers/endpoints.h"
#include "hil/executive/executive.h"
#include "hil/record/output_file.h"
#include "hil/record/recorder.h"
#include "hil/record/report.h"
#include "hil/record/run_log.h"
#include "hil/rig/rig_configuration.h"
#include "hil/rig/rig_faults.h"
#include "hil/rig/rig_settings.h"
#include "hil/rig/rig_status.h"
#include "hil/wires/rig_can.h"
#include "hil/wires/rig_modbus.h"
#include "hil/world/simulated_world.h"
#include "sim/local_frame.h"
#include "sim/samples/calendar.h"

namespace rigwire::fields {
class Refused;
}
namespace rigwire::sim {
class Constellation;
}

namespace rigwire::hil {

/// Builds the machine in its scene, without devices, from which every rig and every benchmark
/// starts. Throws std::invalid_argument or std::runtime_error naming what is wrong, also where the
/// machine does not stand free (hil/world/standing_free.h), or a camera defines the look of a label
/// that nothing in the scene has. `log`: receives what was left out of files; may be null.
[[nodiscard]] MachineInScene build_machine_in_scene(const RigConfiguration& configuration,
                                                    RunLog* log = nullptr);

/// Builds the machine in its scene with weather and the clock of its physics, without sensors.
/// Throws like build_machine_in_scene(). `air`: faults of the air that others hold as well; null:
/// those of the configuration.
[[nodiscard]] SimulatedWorld make_world(const RigConfiguration& configuration,
                                        RunLog* log = nullptr,
                                        std::shared_ptr<const sim::AirFaults> air = nullptr);

/// Returns light and air of the rig's cameras.
[[nodiscard]] std::shared_ptr<CameraSurroundings> make_surroundings(
    const RigConfiguration& configuration, std::shared_ptr<const sim::AirFaults> air = nullptr);

/// Returns the world frame on Earth, with its geoid. Throws std::runtime_error when the geoid's
/// file cannot be read.
[[nodiscard]] sim::LocalFrame make_local_frame(const OriginConfiguration& origin);

/// Returns the problem of a structure that was refused at the start of a run, with its place in the
/// rig's files.
[[nodiscard]] Problem placed(const fields::Refused& refused, const Origins& origins);

/// Makes once what a run starts from, without wires: terrain, meshes, the machine at its start,
/// geoid and satellites. A rig that passes this and load_rig() can be run wherever its wires can be
/// opened. Throws ConfigurationError with the place of the key that is wrong.
void check_start(const LoadedRig& rig, RunLog* log = nullptr);

/// Throws std::invalid_argument when the machine has no such link.
[[nodiscard]] SensorMount sensor_mount(const MachineConfiguration& machine,
                                       const MountConfiguration& mount);

/// Returns the lidars whose point clouds a recording is to have.
[[nodiscard]] CloudSettings recorded_clouds(const RigConfiguration& configuration);

class CameraSurroundings;
class ClientDrain;
class RigUsb;

/// Files for the ground truth.
struct TruthFiles {
  std::filesystem::path machine{};     ///< hil/record/truth_tap.h
  std::filesystem::path lidar{};       ///< hil/record/lidar_truth_tap.h
  std::filesystem::path cameras{};     ///< A folder; hil/record/camera_truth_tap.h
  OutputFailures* failures = nullptr;  ///< May be null; outlives the rig.
  /// Wait for a reader that stalls; 0: for no reader or disk.
  std::chrono::milliseconds patience = kReaderPatience;
};

/// Ends of wires in the caller's own program, in place of the system's: by name of the bus. What a
/// device sends is delivered to them with its simulated time, on the thread that runs the
/// executive; what they give to their receiver comes in as from a client. They must outlive the
/// rig.
struct OwnEnds {
  std::map<std::string, drivers::CanBus*> buses;
  /// Buses among them whose client is absent until it is reported (CanBus::on_client).
  std::set<std::string> with_known_clients{};
};

class Rig {
 public:
  /// Opens every wire, in the order above. Throws drivers::EndpointError (environment),
  /// std::invalid_argument or std::runtime_error (configuration); nothing stays open then. Empty
  /// paths: no truth tap. The rig writes to `log`, with the simulated time, which the log keeps
  /// from the rig's end on; it must outlive the rig; may be null. A bus of `own` has no other
  /// endpoint: std::invalid_argument when its configuration asks for further ports or a socketcand,
  /// or when the rig has no such bus. `recorder` receives everything from now on, and must outlive
  /// the rig; may be null.
  Rig(const RigConfiguration& configuration, boost::asio::io_context& io, const TruthFiles& truth,
      RunLog* log = nullptr, const OwnEnds& own = {}, Recorder* recorder = nullptr);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  [[nodiscard]] Executive& executive() { return executive_; }
  [[nodiscard]] const TruthSource& truth() const { return world_; }
  [[nodiscard]] Hand& hand() { return world_.hand(); }
  /// For viewers: observers, and sensors of no device, are added after all others, before a run.
  [[nodiscard]] SimulatedWorld& world() { return world_; }
  [[nodiscard]] const Calendar& calendar() const { return calendar_; }
  /// The stations of its cameras, by the names of their devices.
  [[nodiscard]] std::map<std::string, StationIndex> camera_stations() const;
  /// Returns light and air like those around its cameras, with the same faults of the air, for
  /// pictures that no camera of the rig takes.
  [[nodiscard]] std::shared_ptr<CameraSurroundings> more_surroundings() const;

  /// Adds every wire that a client can be at.
  void watch_clients(ClientDrain& drain) const;
  /// Returns a line for each bus, with what carries it and why it was chosen, and for each device
  /// that describes its wire.
  [[nodiscard]] std::vector<std::string> wires() const;
  /// To be called on the thread that runs the executive; the caller fills `wall_s`.
  [[nodiscard]] RigStatus status() const;
  /// Returns the devices, buses and lines with their faults. To be called on the executive's
  /// thread.
  [[nodiscard]] RigFaults& faults() { return faults_; }
  [[nodiscard]] const RigFaults& faults() const { return faults_; }
  /// Returns the settings of its devices. To be called on the executive's thread.
  [[nodiscard]] RigSettings& settings() { return settings_; }
  /// To be called after the run.
  [[nodiscard]] std::vector<DeviceReport> device_reports() const;

 private:
  /// A CAN bus of the rig with its endpoint.
  struct Bus;
  struct NamedDevice {
    std::string name;
    std::unique_ptr<Device> device;
  };
  class DeviceSite;
  class DeviceNeighbours;

  void open_bus(const std::string& name, const BusConfiguration& configuration,
                drivers::CanBus* own, bool client_is_known);
  void open_modbus_line(const std::string& name, const ModbusLineConfiguration& configuration);
  /// Opens the server when the first bus or device asks for it.
  [[nodiscard]] UsbBus& usb();
  void number_faults();
  /// Numbers the faults of the devices' surroundings.
  void number_surroundings();
  void open_taps(const TruthFiles& files);
  /// Records the outlets that the executive was given from `first` on as one wire named `wire`.
  void record(const std::string& wire, std::size_t first, const drivers::EndpointStatus& endpoint);
  [[nodiscard]] RecordedStatus recorded_status() const;

  RigConfiguration configuration_;
  boost::asio::io_context& io_;
  RunLog* log_;
  Recorder* recorder_;
  Calendar calendar_;
  sim::LocalFrame frame_;
  std::shared_ptr<const sim::Constellation> satellites_;
  std::shared_ptr<sim::AntennaBook> antennas_ = std::make_shared<sim::AntennaBook>();
  std::shared_ptr<sim::AirFaults> air_;
  std::shared_ptr<CameraSurroundings> surroundings_;
  SimulatedWorld world_;
  Executive executive_;
  SurroundingsStation surroundings_station_;
  std::vector<std::pair<std::string, const QueuedOutlet*>> outlets_;  ///< With their wires' names.
  std::map<std::string, std::unique_ptr<Bus>> buses_;
  std::map<std::string, std::unique_ptr<RigModbus>> modbus_lines_;
  std::vector<NamedDevice> devices_;
  /// Fault ports of buses, lines and surroundings.
  std::vector<std::unique_ptr<FaultPort>> wire_faults_;
  RigFaults faults_;
  RigSettings settings_;
  /// Null while nothing is on USB. Last, because what is plugged into it must outlive it.
  std::unique_ptr<RigUsb> usb_;
};

}  // namespace rigwire::hil
