// The vehicle gateway: the one J1939 node through which a field controller drives a wheeled machine
// or a roller and hears what its sensors read.
//
// No maker's device, but what such a node speaks: the messages of SAE J1939-71 and ISO 11783-7 for
// engine, gearbox, brakes, wheels, steering and tyres, and one proprietary message each way
// (protocols/vehicle/). docs/devices/vehicle-gateway.md has the bytes, periods, time-outs and known
// deviations; vehicle_gateway_control.h says what requests and silence do, vehicle_gateway_report.h
// what is sent.
//
// Life: at power-on it claims its address; from the next tick on, if it may, it sends on schedule,
// first everything as not available, from sensor_start_up on what the samples say. A tick is half a
// millisecond after the instant of a sample; its frames are due `processing_delay` later. Foreign
// and malformed frames are counted and change nothing.
#pragma once

#include <cstdint>
#include <span>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/j1939/j1939_address.h"
#include "emulators/vehicle_gateway/control.h"
#include "emulators/vehicle_gateway/diagnostics.h"
#include "emulators/vehicle_gateway/report.h"
#include "emulators/vehicle_gateway/settings.h"

namespace rigwire::emulators {

class VehicleGateway final : public CanDevice, public VehicleBackend {
 public:
  static constexpr Duration kTick = VehicleReport::kTick;
  static constexpr Duration kTickOffset = std::chrono::microseconds{500};  ///< After a sample.

  /// `output` must outlive the device. Throws std::invalid_argument like validate().
  VehicleGateway(const VehicleGatewaySettings& settings, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  /// Of the schedule and the trouble codes.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;

  void update(const VehicleSample& sample) override;
  [[nodiscard]] const VehicleCommand& command() const override { return control_.command(); }

  [[nodiscard]] std::uint8_t address() const { return address_.address(); }
  [[nodiscard]] bool address_held() const { return address_.held(); }
  [[nodiscard]] std::uint64_t name() const { return address_.name(); }
  [[nodiscard]] std::uint64_t address_conflicts() const { return address_.conflicts(); }
  [[nodiscard]] const VehicleControl& control() const { return control_; }

 private:
  void send(SimTime now, const protocols::can::Frame& frame);
  void send_group(SimTime now, std::uint32_t pgn);
  void tick(SimTime now);
  void receive_request(SimTime now, const protocols::can::Frame& frame);
  /// Decodes, takes and counts; a request that cannot be honoured is refused to its sender where
  /// `refuse` says so.
  template <class Message>
  void receive_command(SimTime now, const protocols::can::Frame& frame, bool refuse);
  void refuse(SimTime now, std::uint8_t requester, std::uint32_t pgn);
  /// Addressed to this node or to everybody.
  [[nodiscard]] bool is_for_us(std::uint8_t destination) const;

  VehicleGatewaySettings settings_;
  FrameOutput& output_;
  J1939Address address_;
  VehicleControl control_;
  VehicleReport report_;
  VehicleDiagnostics diagnostics_;
  std::uint64_t ticks_ = 0;
  SimTime next_tick_;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
