// What the controllers on the bus ask, and what becomes of it when they fall silent: requests in,
// one VehicleCommand out.
//
// In force             silence does                                              fault (DM1)
// TSC1                 engine idles                                              SPN 695, FMI 9
// TC1                  gear and locks stay                                       SPN 525, FMI 9
// XBR                  brake released                                            SPN 2920, FMI 9
// guidance, intended   steering stays where it is; the machine stops; one        SPN 5237, FMI 9
//                      "not intended" is needed before the next "intended"
// speed command        travel speed 0: the machine stops and is held             SPN 4310, FMI 9
// hitches, PTO         hitches stay, shafts are disengaged                       SPN 1874, FMI 9
// the last of them     the machine stops, unless it was TC1 or an implement's alone
//
// A machine that stops by itself idles, has travel speed 0 and its service brake at
// stop_brake_share; when it has been at rest for park_delay, the parking brake is on and the gear
// neutral until a request says otherwise. A source that ends properly (TSC1 and XBR "disabled",
// guidance "not intended", speed command with neither speed nor direction) is no longer in force
// and no fault. A request whose value is not available or in error does not count as one.
//
// While the speed command is in force the machine's own controller has engine and brake, and the
// gear, too, unless TC1 is in force: then that gear stays. TSC1 can only limit the engine. A gear
// of the other direction, neutral or the parking brake refuse a speed other than 0: the machine is
// stopped and held, and the speed's status says why. After its end the machine stays held until the
// next speed command, or until a TSC1 that was not in force before.
#pragma once

#include <array>
#include <cstdint>

#include "emulators/j1939/trouble_memory.h"
#include "emulators/vehicle_gateway/settings.h"
#include "protocols/vehicle/brake.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/implement.h"
#include "protocols/vehicle/machine.h"
#include "protocols/vehicle/speed.h"
#include "protocols/vehicle/steering.h"
#include "protocols/vehicle/transmission.h"
#include "protocols/vehicle/tyre.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

/// Kinds of requests with a timeout.
enum class VehicleRequest : std::size_t { engine, gearbox, brake, guidance, speed, implement };
inline constexpr std::size_t kVehicleRequests = 6;

class VehicleControl {
 public:
  explicit VehicleControl(const VehicleGatewaySettings& settings);

  /// Time-outs until `now`.
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  // Each returns whether the request is one that the machine can honour. A message that holds one
  // that it cannot is refused whole; of a refused gear only the trouble code stays.
  bool take(SimTime now, const protocols::vehicle::Tsc1& request);
  bool take(SimTime now, const protocols::vehicle::Tc1& request);
  bool take(SimTime now, const protocols::vehicle::Xbr& request);
  bool take(SimTime now, const protocols::vehicle::GuidanceCommand& request);
  bool take(SimTime now, const protocols::vehicle::MachineSelectedSpeedCommand& request);
  bool take(SimTime now, const protocols::vehicle::Tprs& request);
  bool take(SimTime now, const protocols::vehicle::MachineFunctionCommand& request);
  bool take(SimTime now, const protocols::vehicle::HitchPowerTakeOffCommand& request);

  /// The key is off: no fuel, and the machine stops for good.
  void switch_off(SimTime now);
  /// The supply ends: what is held by springs engages.
  void lose_supply(SimTime now);

  /// The supply fails: no request is in force, the engine idles, steering stays where it is, and
  /// what is held by springs engages. It is the same when the supply comes back.
  void fail(SimTime now);

  /// The machine's speed at `now`, for parking after a stop; NaN when it is not known. `drives`:
  /// whether it is one that travels at all.
  void observe(SimTime now, double speed_mps, bool drives);

  [[nodiscard]] const VehicleCommand& command() const { return command_; }
  [[nodiscard]] bool in_force(VehicleRequest source) const;
  /// Whether the machine stops by itself.
  [[nodiscard]] bool stopping() const { return stopping_; }
  /// Whether guidance waits for one "not intended".
  [[nodiscard]] bool guidance_needs_reset() const { return guidance_ == Guidance::fault; }
  [[nodiscard]] bool guidance_engaged() const { return guidance_ == Guidance::engaged; }
  [[nodiscard]] protocols::vehicle::ExitReason guidance_exit() const { return guidance_exit_; }
  [[nodiscard]] protocols::vehicle::LimitStatus guidance_limit() const { return guidance_limit_; }
  [[nodiscard]] protocols::vehicle::ExitReason implement_exit() const {
    return lost(VehicleRequest::implement) ? protocols::vehicle::ExitReason::command_timeout
                                           : protocols::vehicle::ExitReason::none;
  }
  /// Whether the last request for economy or mode of that shaft was not honoured: there is none.
  [[nodiscard]] bool economy_refused(ImplementEnd end) const {
    return economy_refused_[static_cast<std::size_t>(end)];
  }
  [[nodiscard]] bool mode_refused(ImplementEnd end) const {
    return mode_refused_[static_cast<std::size_t>(end)];
  }
  [[nodiscard]] protocols::vehicle::ExitReason speed_exit() const { return speed_exit_; }
  /// Returns the limit status that follows from gear, brake and set point.
  [[nodiscard]] protocols::vehicle::LimitStatus speed_limit() const { return speed_limit_; }

  /// Time-outs in the order of VehicleRequest, then a refused gear, then a TSC1 in error.
  [[nodiscard]] TroubleMemory& troubles() { return troubles_; }
  [[nodiscard]] const TroubleMemory& troubles() const { return troubles_; }

  /// Whether counter and checksum of the last TSC1 were right.
  void note_engine_request(bool right);
  /// Says whose request take() took last.
  void note_requester(VehicleRequest source, std::uint8_t address) {
    requester_[index(source)] = address;
  }
  /// Address of the node whose request is in force; 0xFF when none is.
  [[nodiscard]] std::uint8_t requester(VehicleRequest source) const;

 private:
  enum class Guidance : std::uint8_t { idle, engaged, fault };

  static constexpr std::size_t index(VehicleRequest source) {
    return static_cast<std::size_t>(source);
  }
  [[nodiscard]] Duration timeout(VehicleRequest source) const;
  void renew(SimTime now, VehicleRequest source);
  void end(VehicleRequest source);
  void lose(SimTime now, VehicleRequest source);
  [[nodiscard]] bool lost(VehicleRequest source) const {
    return troubles_.is_active(index(source));
  }
  void fail_guidance(SimTime now, protocols::vehicle::ExitReason reason);
  [[nodiscard]] bool allows(protocols::vehicle::SteeringMode mode) const;
  void steer();
  /// The part of a composed command that the travel speed is.
  void travel(VehicleCommand& next);
  void clear_engine_limit();
  /// Composes the command; it counts as changed at `now` if anything differs.
  void compose(SimTime now);

  VehicleGatewaySettings settings_;
  VehicleCommand command_;
  VehicleCommand asked_;  ///< Requested command, before compose() applies a stop and travel limits.
  std::array<SimTime, kVehicleRequests> deadline_;
  TroubleMemory troubles_;
  std::array<std::uint8_t, kVehicleRequests> requester_{};
  bool stopping_ = false;
  SimTime standing_since_ = kNever;
  Guidance guidance_ = Guidance::idle;
  protocols::vehicle::ExitReason guidance_exit_ = protocols::vehicle::ExitReason::none;
  protocols::vehicle::LimitStatus guidance_limit_ = protocols::vehicle::LimitStatus::not_limited;
  protocols::vehicle::ExitReason speed_exit_ = protocols::vehicle::ExitReason::none;
  protocols::vehicle::LimitStatus speed_limit_ = protocols::vehicle::LimitStatus::not_limited;
  bool speed_clipped_ = false;  ///< The set point was above a limit.
  bool drives_ = true;
  bool key_off_ = false;
  std::array<bool, kImplementEnds> economy_refused_{};
  std::array<bool, kImplementEnds> mode_refused_{};
  protocols::vehicle::SteeringMode mode_ = protocols::vehicle::SteeringMode::front;
  double curvature_1pm_ = 0.0;
  double crab_angle_rad_ = 0.0;
};

}  // namespace rigwire::emulators
