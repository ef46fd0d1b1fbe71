// The vehicle gateway: the one J1939 node through which a field controller drives a wheeled machine
// or a roller and receives what its sensors read.
//
// No maker's device, but the messages of such a node: those of SAE J1939-71 and ISO 11783-7 for
// engine, gearbox, brakes, wheels, steering and tyres, and one proprietary message each way
// (protocols/vehicle/). docs/devices/vehicle-gateway.md has the bytes, periods, time-outs and known
// deviations; control.h says what requests and silence do, report.h what is sent, VehicleSatellites
// what a satellite receiver adds, docs/j1939.md what every node does.
//
// Life: at power-on it claims its address; from the next tick on, if it may, it sends on schedule,
// first everything as not available, from sensor_start_up on what the samples say. A tick is half a
// millisecond after the instant of a sample; its frames are due `processing_delay` later. Foreign
// and malformed frames are counted and change nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "emulators/backends.h"
#include "emulators/j1939/engine_report.h"
#include "emulators/j1939/j1939_device.h"
#include "emulators/j1939/position_report.h"
#include "emulators/vehicle_gateway/control.h"
#include "emulators/vehicle_gateway/report.h"
#include "emulators/vehicle_gateway/settings.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/implement.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// What the vehicle gateway knows by satellites, when a receiver is wired to it: VP and VDS every
/// second, VP2 every five.
///
/// The latest fix counts until it is kStale old; then everything is not available.
class VehicleSatellites {
 public:
  static constexpr Duration kStale = std::chrono::seconds{2};

  [[nodiscard]] static std::span<const VehicleReport::Entry> schedule();

  void take(const GnssSample& sample);
  /// The frame of group `pgn`, if it is one of schedule().
  [[nodiscard]] std::optional<protocols::can::Frame> frame(SimTime now, std::uint32_t pgn,
                                                           std::uint8_t source) const;

 private:
  PositionReport report_;
  std::optional<SimTime> taken_at_;
};

class VehicleGateway final : public J1939Device, public VehicleBackend {
 public:
  static constexpr Duration kTick = VehicleReport::kTick;
  static constexpr Duration kTickOffset = std::chrono::microseconds{500};  ///< After a sample.

  /// `output` must outlive the device. Throws std::invalid_argument like validate().
  VehicleGateway(const VehicleGatewaySettings& settings, FrameOutput& output);

  [[nodiscard]] static std::span<const LiveSetting<VehicleGateway, VehicleGatewaySettings>>
  live_settings() {
    return kJ1939LiveSettings<VehicleGateway, VehicleGatewaySettings>;
  }

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  /// Returns the rate of the scheduled messages and the trouble codes.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;

  void update(const VehicleSample& sample) override;
  /// A fix of the satellite receiver that is wired to it (has_position).
  void observe_fix(const GnssSample& sample) { satellites_.take(sample); }
  [[nodiscard]] const VehicleCommand& command() const override { return control_.command(); }

  [[nodiscard]] const VehicleControl& control() const { return control_; }

 private:
  J1939Answer answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  TroubleMemory* troubles() override { return &control_.troubles(); }
  [[nodiscard]] bool is_stopped() const override { return control_.stopping(); }
  J1939Reception obey(SimTime now, const J1939Message& message) override;
  [[nodiscard]] bool is_command(std::uint32_t pgn) const override;

  /// False when the group is none that is sent in frames.
  bool send_group(SimTime now, std::uint32_t pgn);
  void send_due(SimTime now, std::span<const VehicleReport::Entry> schedule);
  void switched(SimTime now) override;
  void tick(SimTime now);
  [[nodiscard]] SimTime next_power_change() const;
  void change_power(SimTime now);
  /// Returns the functionalities of ISO 11783-12 that it has.
  [[nodiscard]] protocols::iso11783::SupportedFunctionality tractor() const;
  J1939Reception take_engine_request(SimTime now, const J1939Message& message);
  /// Decodes and executes a command. A request that cannot be executed is refused to its sender if
  /// `refuse`.
  template <class Message>
  J1939Reception take_command(SimTime now, const J1939Message& message, bool refuse);
  /// Decodes and executes a command and stores its sender as the requester.
  template <class Message>
  J1939Reception take_command(SimTime now, const J1939Message& message, VehicleRequest source);

  VehicleGatewaySettings settings_;
  VehicleControl control_;
  VehicleReport report_;
  VehicleSatellites satellites_;
  TorqueSpeedCheck check_{false};
  protocols::vehicle::LanguageCommand language_;
  bool key_off_ = false;
  bool unsupplied_ = false;
  std::uint64_t ticks_ = 0;
  SimTime next_tick_ = kNever;
  SimTime sensors_from_ = kStart;
};

}  // namespace rigwire::emulators
