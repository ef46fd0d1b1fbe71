// A block of hydraulic valves on an ISO 11783 bus: auxiliary valve commands in, estimated and
// measured flow and position out; operator joysticks, too, where they are mapped.
//
// The outputs are those of every valve driver here (emulators/valve_amplifier/); channel.h says
// whose command counts. docs/devices/iso-valves.md has the bytes, periods, sources and deviations.
//
// Life: J1939Node claims the address; while it is held the outputs are enabled and each valve's
// three messages go out every 100 ms, section k's 10 ms after section k - 1's. A fault takes all
// outputs to neutral; a command of neutral to the faulty valve (any valve, where the fault is the
// whole block's) resets it, and every valve must be commanded neutral before it moves again. DM1
// every second and on change.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/iso_valve/channel.h"
#include "emulators/iso_valve/settings.h"
#include "emulators/j1939/j1939_node.h"
#include "emulators/j1939/trouble_memory.h"
#include "emulators/valve_amplifier/amplifier.h"
#include "protocols/vehicle/diagnostics.h"

namespace rigwire::emulators {

class IsoValves final : public CanDevice, public ValveBackend, J1939Application {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{10};

  /// `output` must outlive the device. Throws like validate(settings).
  IsoValves(const IsoValveSettings& settings, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return node_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;
  void controller(SimTime now, const protocols::can::ControllerReport& report) override {
    node_.controller(now, report);
  }
  void update(const ValveSample& sample) override;
  [[nodiscard]] const ValveCommand& command() const override { return amplifier_.command(); }

  [[nodiscard]] std::uint8_t address() const { return node_.address(); }
  [[nodiscard]] bool address_held() const { return node_.held(); }
  [[nodiscard]] const ValveAmplifier& amplifier() const { return amplifier_; }
  [[nodiscard]] const IsoValveChannel& channel(std::size_t section) const {
    return channels_[section];
  }

 private:
  static constexpr std::size_t kSlots = 10;               ///< Ticks from report to report.
  static constexpr std::uint64_t kDiagnosticTicks = 100;  ///< Between two DM1.

  struct Lever {
    std::size_t section = 0;
    double sign = 1.0;
  };

  using Troubles = TroubleMemory::Codes;

  J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  J1939Reception take(SimTime now, const J1939Message& message) override;
  J1939Reception take_command(SimTime now, std::size_t section, std::uint8_t source,
                              const protocols::iso11783::ValveCommandMembers& command);
  template <class Basic, class Extended>
  J1939Reception take_joystick(SimTime now, const protocols::can::Frame& frame, JoystickAxis first);
  void move_lever(SimTime now, std::size_t axis, double share);
  void follow_address(SimTime now);
  /// A new fault: every valve must see neutral before it moves again.
  void follow_fault();
  void reset_fault(SimTime now);
  /// Gives the amplifier what the channels ask for.
  void drive(SimTime now);
  void tick(SimTime now);
  void send_estimate(SimTime now, std::size_t section);
  void send_measurement(SimTime now, std::size_t section);
  void send_position(SimTime now, std::size_t section);
  void send_general_purpose(SimTime now);
  template <class Message>
  [[nodiscard]] Message estimate(std::size_t section) const;
  bool send_diagnostics(SimTime now);
  [[nodiscard]] Troubles troubles() const;
  [[nodiscard]] unsigned valve_of(std::size_t section) const {
    return settings_.first_valve + static_cast<unsigned>(section);
  }

  IsoValveSettings settings_;
  ValveAmplifier amplifier_;
  J1939Node node_;
  std::vector<IsoValveChannel> channels_;
  std::array<std::optional<Lever>, kJoystickAxes> levers_;
  ValveFault seen_fault_ = ValveFault::none;
  bool was_held_ = false;
  std::uint64_t ticks_ = 0;
  SimTime next_tick_;
  Troubles reported_;  ///< In the last DM1.
  std::uint64_t last_change_tick_ = 0;
};

}  // namespace rigwire::emulators
