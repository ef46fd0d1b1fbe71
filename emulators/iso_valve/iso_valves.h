// A block of hydraulic valves on an ISO 11783 bus: auxiliary valve commands in, estimated and
// measured flow and position out; operator joysticks, too, where they are mapped.
//
// The outputs are those of every valve driver here (emulators/valve_amplifier/); channel.h says
// whose command counts. docs/devices/iso-valves.md has the bytes, periods, sources and deviations.
//
// Life: J1939Node claims the address; while it is held the outputs are enabled and each valve's
// three messages go out every 100 ms, section k's 10 ms after section k - 1's. A fault takes all
// outputs to neutral; a command of neutral to the faulty valve (any valve, where the fault is the
// whole block's) resets it, and every valve must be commanded neutral before it moves again. Its
// trouble codes are reported and cleared as trouble_memory.h says. A block that refuses takes a
// valve to neutral whenever that is commanded, says "error indication" for the reason, and wants a
// command of neutral afterwards; levers are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/iso_valve/channel.h"
#include "emulators/j1939/identity.h"
#include "emulators/j1939/j1939_device.h"
#include "emulators/supply.h"
#include "emulators/valve_amplifier/amplifier.h"
#include "emulators/valve_amplifier/settings.h"
#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Axes of the two joysticks, in the order of IsoValveSettings::levers.
enum class JoystickAxis : std::uint8_t {
  x1,
  y1,
  grip_x1,
  grip_y1,
  theta1,
  x2,
  y2,
  grip_x2,
  grip_y2,
  theta2,
};
inline constexpr std::size_t kJoystickAxes = 10;

struct IsoValveSettings {
  std::uint8_t source_address = 0x80;  ///< Preferred; 128 .. 247.
  std::uint32_t serial = 1;            ///< In the NAME; 21 bits.
  std::uint16_t manufacturer = 2047;   ///< In the NAME; 11 bits. 2047: no number assigned.
  std::uint8_t function = 255;         ///< In the NAME. 255: not specified.
  IdentificationSettings identification{.model = "valve block", .type = "auxiliary valve control"};
  std::uint8_t first_valve = 0;  ///< Auxiliary valve of section 1; the others follow.
  /// Section of the general-purpose valve, from 1; 0 = none.
  std::uint8_t general_purpose_section = 0;
  Duration command_timeout = std::chrono::milliseconds(300);  ///< 100 ms .. 10 s.
  SupplySettings supply;
  Duration processing_delay = std::chrono::microseconds(200);  ///< From an event to its frame.
  Duration sample_period = std::chrono::milliseconds(10);      ///< Transducers, 1 ms .. 1 s.
  double spool_travel_m = 0.007;                               ///< Neutral to full, 1e-4 .. 0.03.
  /// The section that each axis moves; a leading '-' turns it round; empty: none.
  std::array<std::string, kJoystickAxes> levers{};
  /// Its watchdog is not used: each valve has its own time-out.
  ValveAmplifierSettings amplifier;
};

void visit(fields::Visitor& v, IsoValveSettings& p);
/// Throws std::invalid_argument naming the setting, what was found and what is allowed.
void validate(const IsoValveSettings& settings);

class IsoValves final : public J1939Device, public ValveBackend {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{10};

  /// `output` must outlive the device. Throws like validate(settings).
  IsoValves(const IsoValveSettings& settings, FrameOutput& output);

  [[nodiscard]] static std::span<const LiveSetting<IsoValves, IsoValveSettings>> live_settings() {
    return kJ1939LiveSettings<IsoValves, IsoValveSettings>;
  }

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;
  void update(const ValveSample& sample) override;
  [[nodiscard]] const ValveCommand& command() const override { return amplifier_.command(); }

  [[nodiscard]] const ValveAmplifier& amplifier() const { return amplifier_; }
  /// What goes wrong with coils, spools, sensors and their surroundings.
  [[nodiscard]] ValveAmplifier& defects() { return amplifier_; }
  [[nodiscard]] const IsoValveChannel& channel(std::size_t section) const {
    return channels_[section];
  }

 private:
  static constexpr std::size_t kSlots = 10;  ///< Ticks from report to report.

  struct Lever {
    std::size_t section = 0;
    double sign = 1.0;
  };

  J1939Answer answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  TroubleMemory* troubles() override { return &troubles_; }
  [[nodiscard]] bool is_stopped() const override { return amplifier_.fault() != ValveFault::none; }
  J1939Reception obey(SimTime now, const J1939Message& message) override;
  [[nodiscard]] bool is_command(std::uint32_t pgn) const override;
  void refused(SimTime now, const J1939Message& message) override;
  /// The section that a command of group `pgn` is for; nothing: it is none of this block's.
  [[nodiscard]] std::optional<std::size_t> commanded_section(std::uint32_t pgn) const;
  J1939Reception take_command(SimTime now, std::size_t section, std::uint8_t source,
                              const protocols::iso11783::ValveCommandMembers& command);
  template <class Basic, class Extended>
  J1939Reception take_joystick(SimTime now, const protocols::can::Frame& frame, JoystickAxis first);
  void move_lever(SimTime now, std::size_t axis, double share);
  void follow_address(SimTime now);
  /// Notes what is wrong. A new fault: every valve must see neutral before it moves again.
  void follow_fault();
  void reset_fault(SimTime now);
  /// Gives the amplifier what the channels ask for.
  void drive(SimTime now);
  void switched(SimTime now) override;
  void tick(SimTime now);
  void send_estimate(SimTime now, std::size_t section);
  void send_measurement(SimTime now, std::size_t section);
  void send_position(SimTime now, std::size_t section);
  void send_general_purpose(SimTime now);
  template <class Message>
  [[nodiscard]] Message estimate(std::size_t section) const;
  [[nodiscard]] unsigned valve_of(std::size_t section) const {
    return settings_.first_valve + static_cast<unsigned>(section);
  }

  IsoValveSettings settings_;
  ValveAmplifier amplifier_;
  std::vector<IsoValveChannel> channels_;
  std::array<std::optional<Lever>, kJoystickAxes> levers_;
  ValveFault seen_fault_ = ValveFault::none;
  bool was_held_ = false;
  TroubleMemory troubles_;
  std::uint64_t ticks_ = 0;
  SimTime next_tick_ = kNever;
};

}  // namespace rigwire::emulators
