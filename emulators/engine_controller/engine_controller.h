// The controller of an engine that drives hydraulic pumps, and of those pumps, on a J1939 bus:
// engine state, condition and configuration, and pump pressure out, torque/speed requests (TSC1)
// in.
//
// docs/devices/engine-controller.md has bytes, periods, sources and deviations. Life: J1939Node
// claims the address; while it is held the schedule runs in ticks of 10 ms, each half a millisecond
// after the instant of a sample. A request by TSC1 holds for `request_timeout`; of several nodes
// the one with the higher priority counts, of equal ones the first, until it is silent. A request
// whose counter repeats or whose checksum is wrong is ignored and an active trouble code; one
// without them (all ones) counts unless `requires_checksum`. Without supply the engine is the
// dial's; hours and fuel are of the engine, and go on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/j1939/engine_report.h"
#include "emulators/j1939/j1939_device.h"
#include "fields/rules.h"
#include "protocols/vehicle/engine.h"
#include "sim/samples/power_unit_sample.h"

namespace rigwire::emulators {

struct EngineControllerSettings {
  std::uint8_t source_address = 0x00;  ///< 0 .. 253; 0 is "engine #1".
  std::uint32_t serial = 1;            ///< In the NAME; 21 bits.
  J1939NameSettings name;              ///< Function 0 of the global group: engine.
  IdentificationSettings identification{.model = "engine controller",
                                        .type = "engine",
                                        .vehicle_identification_number = "RGWRE0EX000000001"};
  EngineData engine;         ///< Data of the machine's engine; no key.
  Duration engine_hours{0};  ///< Hours of the engine when the run begins.
  SupplySettings supply;
  Duration processing_delay = std::chrono::microseconds{500};  ///< From an event to its frame.
  /// Timeout of TSC1, sent every 10 ms.
  Duration request_timeout = std::chrono::milliseconds{100};
  bool requires_checksum = false;  ///< Requests without counter and checksum are refused.
};

void visit(fields::Visitor& v, EngineControllerSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const EngineControllerSettings& settings);

class EngineController final : public J1939Device, public PowerUnitBackend {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{10};
  static constexpr Duration kTickOffset = std::chrono::microseconds{500};  ///< After a sample.

  /// A group that it sends in one frame: by itself where it has a period, and on request.
  struct Entry {
    protocols::vehicle::Group group;
    std::uint64_t phase = 0;  ///< Ticks; below the period.
  };
  [[nodiscard]] static std::span<const Entry> schedule();

  /// `output` must outlive the device. Throws like validate(settings).
  EngineController(const EngineControllerSettings& settings, FrameOutput& output);

  [[nodiscard]] static std::span<const LiveSetting<EngineController, EngineControllerSettings>>
  live_settings() {
    return kJ1939LiveSettings<EngineController, EngineControllerSettings>;
  }

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  void update(const PowerUnitSample& sample) override;
  [[nodiscard]] const PowerUnitCommand& command() const override { return command_; }

 private:
  struct Request {
    std::uint8_t source = 0xFF;
    std::uint8_t priority = 3;
    SimTime expires = kNever;
  };

  J1939Answer answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  TroubleMemory* troubles() override { return &troubles_; }
  J1939Reception obey(SimTime now, const J1939Message& message) override;
  [[nodiscard]] bool is_command(std::uint32_t pgn) const override {
    return pgn == protocols::vehicle::Tsc1::kGroup.pgn;
  }
  J1939Reception take_request(SimTime now, const J1939Message& message);
  void govern(SimTime now, const protocols::vehicle::Tsc1& request);
  void end_request();
  void switched(SimTime now) override;
  void tick(SimTime now);
  /// False when the group is none of the schedule's.
  bool send_group(SimTime now, std::uint32_t pgn);

  EngineControllerSettings settings_;
  std::optional<PowerUnitSample> sample_;
  PowerUnitCommand command_;
  std::optional<Request> request_;
  EngineReport report_;
  TroubleMemory troubles_;
  TorqueSpeedCheck check_;
  std::uint64_t ticks_ = 0;
  SimTime next_tick_ = kNever;
};

}  // namespace rigwire::emulators
