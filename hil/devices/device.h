// One device of the rig at run time, with everything between its emulator and its client: endpoint,
// outlets, statistics. One class per device type, made by the type's configuration.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/device.h"
#include "hil/configuration/fault_port.h"
#include "hil/devices/client_request.h"
#include "hil/devices/device_configuration.h"
#include "hil/executive/shelves.h"
#include "hil/wires/wire_statistics.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::hil {

class Executive;

struct DeviceStatus {
  std::string name;
  std::string wire;          ///< What a client opens.
  std::uint64_t frames = 0;  ///< Messages on the wire since the start.
  std::uint64_t bytes = 0;
  std::uint64_t dropped = 0;
  double nominal_rate_hz = 0.0;  ///< Messages per simulated second; 0 when the device only answers.
  Duration lateness_p50{0};
  Duration lateness_p99{0};
  Duration lateness_max{0};
  LatencyClasses lateness{};
  bool client_present = false;
  unsigned readers = 0;  ///< Programs on one plug (drivers::EndpointStatus).
  std::optional<Duration> since_client_activity;  ///< Simulated time since a client last sent.
  std::optional<ClientRequest> last_request;      ///< The last request that the device understood.
};

/// Receives every fix of a satellite receiver: a lidar for its time, a vehicle gateway for its
/// position.
class FixListener {
 public:
  virtual ~FixListener() = default;
  virtual void observe_fix(const GnssSample& sample) = 0;
};

/// Source of a receiver's fixes, for the devices that are wired to it.
class FixSource {
 public:
  virtual ~FixSource() = default;
  /// Notifies `listener` of every fix from now on; it must outlive the source's use.
  virtual void inform(FixListener& listener) = 0;
};

/// Receives the bytes that a base station sends to its rovers.
class CorrectionListener {
 public:
  virtual ~CorrectionListener() = default;
  /// `baud`: rate at which the line carries the bytes.
  virtual void hear_corrections(SimTime now, std::span<const std::uint8_t> bytes,
                                std::uint32_t baud) = 0;
};

/// A base station's line to its rovers: a receiver's second UART, or a reference station.
class CorrectionSource {
 public:
  virtual ~CorrectionSource() = default;
  /// From now on passes all bytes to `listener`, which must outlive the source's use.
  virtual void inform(CorrectionListener& listener) = 0;
};

class Neighbours;
class ValveSource;

class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Connects it with others of the rig; called once, when all exist.
  virtual void connect(const Neighbours& /*neighbours*/) {}

  [[nodiscard]] virtual drivers::EndpointStatus endpoint() const = 0;
  [[nodiscard]] virtual const emulators::Device& emulator() const = 0;
  /// Returns the number of messages on the wire so far.
  [[nodiscard]] virtual std::uint64_t frames() const { return statistics_.units; }
  /// Returns the number of units of output lost before and at the endpoint.
  [[nodiscard]] virtual std::uint64_t dropped() const { return statistics_.dropped; }
  [[nodiscard]] virtual const WireStatistics& statistics() const { return statistics_; }

  /// Returns further counts for the report.
  [[nodiscard]] virtual std::vector<NamedCount> counts() const { return {}; }

  /// Returns the last request of a client that the device understood; nullopt before the first.
  [[nodiscard]] virtual std::optional<ClientRequest> last_request() const = 0;

  /// Returns the ports of its faults, in the order of the faults' windows.
  [[nodiscard]] const std::vector<std::unique_ptr<FaultPort>>& fault_ports() const {
    return fault_ports_;
  }

  /// Changes one of DeviceConfiguration::live_keys() to its value in `wanted`, a valid
  /// configuration of its type. Returns why the device refuses it; empty: it is changed.
  [[nodiscard]] virtual std::string tell(SimTime /*now*/, const DeviceConfiguration& /*wanted*/,
                                         std::string_view /*key*/) {
    return "this device has no settings that can be changed at run time";
  }

  /// What other devices can be connected to; null when it has none.
  [[nodiscard]] virtual FixSource* fixes() { return nullptr; }
  [[nodiscard]] virtual CorrectionSource* corrections() { return nullptr; }
  [[nodiscard]] virtual const ValveSource* valves() const { return nullptr; }
  /// Returns how it differs from the real device here, for the run's start; empty: it does not.
  [[nodiscard]] virtual std::string remark() const { return {}; }
  /// Returns whether the file of every lidar shot names it.
  [[nodiscard]] virtual bool is_lidar() const { return false; }
  /// Returns the station of a camera, at which it asks for exposures; nullopt for other devices.
  [[nodiscard]] virtual std::optional<StationIndex> camera_station() const { return std::nullopt; }

  [[nodiscard]] DeviceStatus status(const std::string& name, SimTime now) const;

 protected:
  Device() = default;
  [[nodiscard]] WireStatistics& own_statistics() { return statistics_; }
  /// Adds a port; to be called once for each list of faults, while the device is made.
  void offer(std::unique_ptr<FaultPort> port) { fault_ports_.push_back(std::move(port)); }
  /// To be called when a client has sent something; brings the devices up to the present.
  SimTime client_arrived(Executive& executive);

 private:
  WireStatistics statistics_;
  std::vector<std::unique_ptr<FaultPort>> fault_ports_;
};

/// The devices of the rig, in the order of their names.
class Neighbours {
 public:
  virtual ~Neighbours() = default;
  /// Returns the fix source of the device `name`, or for an empty name of the first that has one;
  /// null: none.
  [[nodiscard]] virtual FixSource* fixes_of(const std::string& name) const = 0;
  /// Returns the corrections of the base station `name`; null: it is none.
  [[nodiscard]] virtual CorrectionSource* corrections_of(const std::string& name) const = 0;
  /// Returns the valves of every device that has some.
  [[nodiscard]] virtual std::vector<const ValveSource*> valves() const = 0;
};

/// Returns what an emulator's wire format can carry.
[[nodiscard]] std::vector<DescribedQuantity> quantities_of(const emulators::Device& emulator);

/// Returns a calendar for emulators that are built only to describe them.
[[nodiscard]] const Calendar& some_calendar();

}  // namespace rigwire::hil
