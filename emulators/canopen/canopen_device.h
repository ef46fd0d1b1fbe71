// A CANopen sensor on its bus: what is the same for every profile. Its node and dictionary, its
// supply, and what it is at delivery; the profile says what it measures (CanopenProfile).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/canopen/canopen_node.h"
#include "emulators/device.h"
#include "emulators/live_setting.h"
#include "emulators/supply.h"
#include "fields/rules.h"
#include "protocols/canopen/communication_objects.h"
#include "protocols/canopen/object_entry.h"

namespace rigwire::emulators {

/// Returns the remainder of `value` by `range`, 0 or above.
[[nodiscard]] constexpr std::int64_t modulo(std::int64_t value, std::int64_t range) {
  const std::int64_t rest = value % range;
  return rest < 0 ? rest + range : rest;
}

struct CanopenDeviceSettings {
  CanopenNodeSettings node;
  /// Transmission type of TPDO1 at delivery: 0..240, 254 or 255.
  std::uint8_t transmission_type = 255;
  std::uint16_t event_timer_ms = 0;  ///< Event timer of TPDO1 at delivery.
  std::uint16_t heartbeat_ms = 0;    ///< Heartbeat period at delivery; 0 is none.
  std::uint32_t serial = 1;
  std::uint32_t vendor = 0;  ///< Vendor-ID of the CiA's list; 0 is assigned to no vendor.
  SupplySettings supply;
  Duration sampling = std::chrono::milliseconds{5};  ///< Time between two readings.
};

/// The keys of node and identity; supply and sampling follow those of the profile.
void visit_canopen(fields::Visitor& v, CanopenDeviceSettings& p);
/// Checks what depends on several settings. Throws std::invalid_argument.
void validate_canopen(const CanopenDeviceSettings& settings);

class CanopenDevice : public CanDevice, protected CanopenProfile {
 public:
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const final;
  [[nodiscard]] SamplePlan sample_plan() const final { return plan_; }
  [[nodiscard]] ReceiveCounters received() const final { return node_.received(); }
  [[nodiscard]] double nominal_rate_hz() const final { return node_.nominal_rate_hz(); }
  void receive(SimTime now, const protocols::can::Frame& frame) final;

  /// Writes an object of the dictionary as an SDO download does. Returns why it is refused; empty
  /// if it is accepted.
  [[nodiscard]] std::string_view configure(SimTime now, protocols::canopen::ObjectAddress address,
                                           std::int64_t value);

  [[nodiscard]] const CanopenNode& node() const { return node_; }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] Pace& pace() { return node_.pace(); }
  [[nodiscard]] Refusal& refusal() { return node_.refusal(); }

 protected:
  /// `objects`, `memory` and `output` must outlive the device.
  CanopenDevice(const CanopenDeviceSettings& settings,
                std::span<const protocols::canopen::ObjectEntry> objects, NonvolatileMemory& memory,
                FrameOutput& output);
  /// Once, when the dictionary holds what is delivered of the profile: the rest of it, and the
  /// electronic data sheet.
  void deliver(const CanopenDeviceSettings& settings, std::uint32_t device_type,
               std::uint32_t product, const std::string& file, const std::string& description,
               const std::string& vendor_name);
  /// The dictionary may hold something else.
  virtual void written(SimTime /*now*/) {}
  /// The supply came or went at `now`.
  virtual void switched(SimTime now) = 0;

  ObjectDictionary dictionary_;
  CanopenNode node_;

 private:
  Supply supply_;
  SamplePlan plan_;
};

/// Settings that every CANopen device accepts at run time.
template <class Device, class Settings>
inline constexpr std::array<LiveSetting<Device, Settings>, 3> kCanopenLiveSettings{{
    {"transmission_type", "SDO, object 1800:2",
     [](Device& device, SimTime now, const Settings& wanted) {
       return device.configure(
           now, {protocols::canopen::object::kTransmitPdo, protocols::canopen::kPdoType},
           wanted.transmission_type);
     }},
    {"event_timer", "SDO, object 1800:5",
     [](Device& device, SimTime now, const Settings& wanted) {
       return device.configure(
           now, {protocols::canopen::object::kTransmitPdo, protocols::canopen::kPdoEventTimer_ms},
           wanted.event_timer_ms);
     }},
    {"heartbeat", "SDO, object 1017",
     [](Device& device, SimTime now, const Settings& wanted) {
       return device.configure(now, protocols::canopen::object::kHeartbeatTime,
                               wanted.heartbeat_ms);
     }},
}};

/// The profile's messages as device `name` sends them: heartbeats by time, and TPDO1 where `timed`.
[[nodiscard]] std::vector<protocols::can::OwnedMessage> sent_by(
    std::string_view name, const CanopenDeviceSettings& settings, bool timed,
    std::vector<protocols::can::OwnedMessage> layouts);

}  // namespace rigwire::emulators
