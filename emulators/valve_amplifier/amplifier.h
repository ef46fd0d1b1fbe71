// A valve amplifier: from a master's requests to spool set points, whatever bus they come over.
//
//   - Outputs follow the commands only while enabled (enable asked for and no fault latched). A
//     command given while disabled is stored, and has no effect: on the change to enabled every
//     section starts from 0 unless that same request commands it.
//   - Quick stop, disabling and faults go to neutral at once, past the ramps; when quick stop is
//     cleared, sections start from 0 as after enabling. Quick stop beats float.
//   - A section can be switched off by itself: it goes to neutral at once and stays there whatever
//     the reaction to a trip; switched on again it starts from 0 unless that request commands it.
//   - The watchdog runs while enabled, from the last feed(). A feed at the very instant of expiry
//     is too late. On expiry fault 1 is latched and the outputs react at exactly that instant;
//     hold, float and loss position last until the master clears enable, asks for quick stop or
//     resets the fault.
//   - A fault stays latched until fault_reset goes from false to true. What happens by itself at
//     the instant of a reset (a watchdog running out, a supervision delay ending) happens before
//     it. A reset begins every supervision anew, so that a cause that is still there latches again
//     after its delay; too hot and contradicting parameters latch again at once. If enable is asked
//     for then, the amplifier is enabled again, with all commands 0 unless that request carries
//     some.
//
// What leaves for the machine (command()) is the set point as far as the coil can carry it: the
// opening that belongs to the maximum current U / R(T), 0 without current, and the opening of its
// beginning while a spool is stuck. The coil's time constant is not on that way: the machine
// model's spool lag (sim/hydraulics/spool.h) is that of coil, pilot and spool together, and is
// there once. The lag is in the reported current. Dither is too fast for the machine; it is in the
// reported current and, through the same lag, in the reported position
// (docs/devices/valve-driver.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "emulators/valve_amplifier/coil.h"
#include "emulators/valve_amplifier/fault.h"
#include "emulators/valve_amplifier/settings.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

/// One section's output stage: ramp, gain, dead band jump and polarity between a command and the
/// spool set point. Pure arithmetic over time; the valve amplifier owns one per section.
class ValveStage {
 public:
  /// The command to go to, -1 .. 1, from `now` on. Without a ramp it is reached at once.
  void set_target(SimTime now, double command, const ValveStageParameters& parameters);
  /// Moves along the ramp until `now`. Times must not decrease.
  void advance(SimTime now, const ValveStageParameters& parameters);
  /// To neutral at once, past every ramp.
  void neutral(SimTime now);

  [[nodiscard]] bool ramping() const { return ramped_ != target_; }
  /// Spool set point, -1 .. 1: with c the ramped command times gain, held within -1 .. 1, and b the
  /// dead band of its sign, polarity * sign(c) * (b + (1 - b) |c|); 0 for c = 0.
  [[nodiscard]] double opening(const ValveStageParameters& parameters) const;

 private:
  SimTime moved_until_{};
  double target_ = 0.0;
  double ramped_ = 0.0;
};

/// What one request of the master changes, all at the same instant. What has no value stays.
struct ValveRequest {
  std::optional<bool> enable;
  std::optional<bool> fault_reset;  ///< Acts on the change to true.
  std::optional<bool> quick_stop;
  std::array<std::optional<bool>, kValveSections> section_enable{};  ///< At power-up all are on.
  std::array<std::optional<bool>, kValveSections> floating{};
  std::array<std::optional<double>, kValveSections> command{};  ///< -1 .. 1.
};

class ValveAmplifier {
 public:
  /// Throws std::invalid_argument.
  explicit ValveAmplifier(const ValveAmplifierSettings& settings);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  void request(SimTime now, const ValveRequest& request);
  /// The master is alive.
  void feed(SimTime now);
  void set_parameters(SimTime now, const ValveAmplifierParameters& parameters);
  /// The supply went or came: outputs at neutral; what a master has set and what was latched is
  /// forgotten, defects stay.
  void restart(SimTime now);
  /// One more defect; it begins no earlier than the amplifier was advanced to. Throws
  /// std::invalid_argument for a section that there is not.
  ValveDefects::Id begin(const ValveDefect& defect);
  /// Ends a fault like FaultBook::end().
  bool end(ValveDefects::Id id, SimTime now);
  /// A spool position that is not a number latches fault 6; other quantities that are not numbers
  /// leave what was measured before.
  void update(const ValveSample& sample);

  /// What the machine sees.
  [[nodiscard]] const ValveCommand& command() const { return command_; }

  [[nodiscard]] std::size_t sections() const { return settings_.sections.size(); }
  [[nodiscard]] const ValveAmplifierSettings& settings() const { return settings_; }
  [[nodiscard]] const ValveAmplifierParameters& parameters() const { return parameters_; }
  [[nodiscard]] bool enabled() const { return enabled_; }
  /// Whether the section is switched on, and whether its output follows its command.
  [[nodiscard]] bool section_on(std::size_t section) const { return section_on_[section]; }
  [[nodiscard]] bool section_enabled(std::size_t section) const {
    return enabled_ && section_on_[section];
  }
  [[nodiscard]] ValveFault fault() const { return fault_; }
  /// Returns the section of the latched fault; nullopt if it concerns the whole amplifier.
  [[nodiscard]] std::optional<std::size_t> fault_section() const { return fault_section_; }
  [[nodiscard]] bool watchdog_tripped() const { return watchdog_tripped_; }
  /// Returns whether an output is at 100 %, or a coil cannot carry the wanted current.
  [[nodiscard]] bool at_limit() const;
  [[nodiscard]] bool limited(std::size_t section) const;
  /// The stored command, and what the stage makes of it at present.
  [[nodiscard]] double commanded(std::size_t section) const { return commanded_[section]; }
  [[nodiscard]] double set_point(std::size_t section) const { return set_point_[section]; }
  [[nodiscard]] bool floating(std::size_t section) const { return floating_[section]; }

  // What its transducers read, at `now`, not before the last call.
  /// With dither.
  [[nodiscard]] double current_ma(SimTime now, std::size_t section) const;
  /// The last measurement, with the dither's trace.
  [[nodiscard]] double position(SimTime now, std::size_t section) const;
  [[nodiscard]] double coil_temperature_c(std::size_t section) const;
  [[nodiscard]] double supply_voltage_v() const { return defect_.supply_voltage_v; }
  [[nodiscard]] double driver_temperature_c() const { return driver_temperature_c_; }
  /// The last measurement, each quantity the last that was a number. Before the first: zeros.
  [[nodiscard]] const ValveSample& measured() const { return measured_; }
  [[nodiscard]] std::uint64_t measurements() const { return measurements_; }

 private:
  [[nodiscard]] SimTime watchdog_deadline() const;
  [[nodiscard]] SimTime supervision_deadline() const;
  void latch(SimTime now, ValveFault fault, std::optional<std::size_t> section = std::nullopt);
  void begin_from_zero(const ValveRequest& request);
  void set_targets(SimTime now);
  void release(SimTime now);
  void step_ramps(SimTime now);
  void schedule_ramp(SimTime now);
  void take_defects(SimTime now);
  void refresh_set_points(SimTime now);
  void refresh_output(SimTime now);
  void drive_coils(SimTime now);
  void supervise(SimTime now);
  void supervise_spools(const ValveSample& sample);
  void forget_suspicions();
  [[nodiscard]] double wanted_ma(std::size_t section) const;
  [[nodiscard]] double carried(std::size_t section) const;

  const ValveAmplifierSettings settings_;
  ValveDefects defects_;
  ValveAmplifierParameters parameters_;
  std::array<ValveStage, kValveSections> stages_{};
  std::array<ValveCoil, kValveSections> coils_;

  bool enable_wanted_ = false;
  bool reset_wanted_ = false;
  bool quick_stop_ = false;
  std::array<bool, kValveSections> section_on_{};
  std::array<bool, kValveSections> float_wanted_{};
  std::array<double, kValveSections> commanded_{};

  bool enabled_ = false;
  bool watchdog_tripped_ = false;
  ValveFault fault_ = ValveFault::none;
  std::optional<std::size_t> fault_section_;
  ValveReaction active_reaction_ = ValveReaction::neutral;  ///< After a trip.
  std::array<double, kValveSections> set_point_{};
  std::array<bool, kValveSections> floating_{};
  ValveCommand command_;

  ValveDefectState defect_;
  SimTime next_defect_ = kNever;
  SimTime fed_{};               ///< Last time the watchdog was fed.
  SimTime next_ramp_ = kNever;  ///< Next output step.
  // Since when something is suspicious; kNever while it is not.
  std::array<SimTime, kValveSections> coil_open_since_{};
  std::array<SimTime, kValveSections> over_current_since_{};
  std::array<SimTime, kValveSections> spool_off_since_{};
  SimTime under_voltage_since_ = kNever;

  double driver_temperature_c_ = 0.0;
  SimTime driver_warmed_until_{};
  ValveSample measured_;
  std::uint64_t measurements_ = 0;
};

}  // namespace rigwire::emulators
