// Hydraulic valves on ISO 11783: command, estimated flow, measured flow and position of sixteen
// auxiliary valves, and the general-purpose valve's. One parameter group per valve: valve n's
// number is valve 0's plus n. Values are shares, pressures in Pa; positive is the extend port.
//
// Sources: ISO 11783-7 parameters as listed by isobus.net (positions, scales, SPNs of the commands,
// of measured flow and of the limit status); Open-SAE-J1939 (estimated flow's bytes, measured
// position, general-purpose valve). The exit/reason code of estimated flow (byte 5, low six bits)
// and the position's offset are by analogy with the guidance message and with this project's
// choice; docs/devices/iso-valves.md says what is certain.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocols/can/message.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::iso11783 {

using vehicle::Group;
using vehicle::kNotAvailable;
using vehicle::Scale;

inline constexpr unsigned kAuxiliaryValves = 16;

/// Commanded or actual state of a valve.
enum class ValveState : std::uint8_t {
  neutral = 0,  ///< Ports blocked.
  extend = 1,
  retract = 2,
  floating = 3,
  initialization = 10,
  error = 14,
  not_available = 15,
};

/// Names of ValveState as messages have it.
inline constexpr std::array<can::NamedValue, 7> kValveStates{{{0, "neutral"},
                                                              {1, "extend"},
                                                              {2, "retract"},
                                                              {3, "float"},
                                                              {10, "init"},
                                                              {14, "error"},
                                                              {15, "not available"}}};

/// What a valve does without commands.
enum class FailSafeMode : std::uint8_t {
  block = 0,
  floating = 1,  ///< "Activated".
  error = 2,
  not_available = 3,
};

enum class ValveLimit : std::uint8_t {
  not_limited = 0,
  by_operator = 1,
  limited_high = 2,
  limited_low = 3,
  not_recoverable = 6,
  not_available = 7,
};

/// Why a valve no longer follows its command; the codes of the guidance message.
enum class ValveExit : std::uint8_t {
  none = 0,
  operator_override = 3,
  command_timeout = 5,
  out_of_range = 6,
  function_fault = 9,
  error = 62,
  not_available = 63,
};

/// One count of 0.4 %: a command and its estimate, 0 .. 100 %.
inline constexpr Scale kPortFlow{0.004, 0.0, "1"};
/// One count of 0.0015625 %.
inline constexpr Scale kExtendedFlow{0.0015625e-2, 0.0, "1"};
/// One count of 1 %, from -125 %.
inline constexpr Scale kMeasuredFlow{0.01, -1.25, "1"};
/// One count of 5 kPa, and of 16 kPa.
inline constexpr Scale kPortPressure{5e3, 0.0, "Pa"};
inline constexpr Scale kReturnPressure{16e3, 0.0, "Pa"};
/// One count of 0.1 %, from -3200 %; and of 1 um, from -32 mm. This project's choice.
inline constexpr Scale kPositionShare{0.001, -32.0, "1"};
inline constexpr Scale kPosition{1e-6, -0.032, "m"};

/// The members that a command and its resolution share.
struct ValveCommandMembers {
  double flow_share = kNotAvailable;           ///< 0 .. 1, direction by the state.
  std::uint8_t resolution = 3;                 ///< 2 bits; 1: the extended value counts.
  std::uint8_t state = 15;                     ///< ValveState.
  std::uint8_t fail_safe = 3;                  ///< FailSafeMode.
  double extended_flow_share = kNotAvailable;  ///< 0 .. 1.
};

/// Auxiliary valve 0 command; 100 ms while active.
struct AuxiliaryValveCommand : ValveCommandMembers {
  static constexpr Group kGroup{"AV00C", 65072, 3, std::chrono::milliseconds{100}};
  static constexpr auto parameters() {
    using M = AuxiliaryValveCommand;
    return std::array<vehicle::Parameter<M>, 5>{
        vehicle::number<M>("port flow", 1907, {1}, 8, kPortFlow, &M::flow_share),
        vehicle::code<M>("resolution mode", 7872, {2, 1}, 2, &M::resolution),
        vehicle::code<M>("state", 1908, {3, 1}, 4, &M::state, kValveStates),
        vehicle::code<M>("fail-safe mode", 1909, {3, 7}, 2, &M::fail_safe),
        vehicle::number<M>("port flow, extended", 7856, {4}, 16, kExtendedFlow,
                           &M::extended_flow_share),
    };
  }
};

/// General-purpose valve command, to one node.
struct GeneralPurposeValveCommand : ValveCommandMembers {
  static constexpr Group kGroup{"GPVC", 50176, 3, std::chrono::milliseconds{100}};
  static constexpr auto parameters() {
    using M = GeneralPurposeValveCommand;
    return std::array<vehicle::Parameter<M>, 4>{
        vehicle::number<M>("port flow", 0, {1}, 8, kPortFlow, &M::flow_share),
        vehicle::code<M>("state", 0, {3, 1}, 4, &M::state, kValveStates),
        vehicle::code<M>("fail-safe mode", 0, {3, 7}, 2, &M::fail_safe),
        vehicle::number<M>("port flow, extended", 0, {4}, 16, kExtendedFlow,
                           &M::extended_flow_share),
    };
  }
};

struct ValveEstimateMembers {
  double extend_share = kNotAvailable;   ///< 0 .. 1.
  double retract_share = kNotAvailable;  ///< 0 .. 1.
  std::uint8_t state = 15;               ///< ValveState.
  std::uint8_t fail_safe = 3;            ///< FailSafeMode.
  std::uint8_t limit = 7;                ///< ValveLimit.
  std::uint8_t exit_reason = 63;         ///< ValveExit.
};

template <class M>
[[nodiscard]] constexpr std::array<vehicle::Parameter<M>, 6> estimate_rows(
    std::uint32_t limit_spn) {
  return {vehicle::number<M>("extend port flow", 0, {1}, 8, kPortFlow, &M::extend_share),
          vehicle::number<M>("retract port flow", 0, {2}, 8, kPortFlow, &M::retract_share),
          vehicle::code<M>("state", 0, {3, 1}, 4, &M::state, kValveStates),
          vehicle::code<M>("fail-safe mode", 0, {3, 7}, 2, &M::fail_safe),
          vehicle::code<M>("limit status", limit_spn, {4, 6}, 3, &M::limit),
          vehicle::code<M>("exit/reason code", 0, {5, 1}, 6, &M::exit_reason)};
}

/// Auxiliary valve 0 estimated flow.
struct AuxiliaryValveEstimate : ValveEstimateMembers {
  static constexpr Group kGroup{"AV00EF", 65040, 3, std::chrono::milliseconds{100}};
  static constexpr auto parameters() { return estimate_rows<AuxiliaryValveEstimate>(0); }
};

/// General-purpose valve estimated flow.
struct GeneralPurposeValveEstimate : ValveEstimateMembers {
  static constexpr Group kGroup{"GPVEF", 50688, 3, std::chrono::milliseconds{100}};
  static constexpr auto parameters() { return estimate_rows<GeneralPurposeValveEstimate>(0); }
};

/// Auxiliary valve 0 measured flow.
struct AuxiliaryValveMeasuredFlow {
  static constexpr Group kGroup{"AV00MF", 65056, 3, std::chrono::milliseconds{100}};

  double extend_share = kNotAvailable;   ///< Out of the extend port; negative: returning.
  double retract_share = kNotAvailable;  ///< Out of the retract port.
  double extend_pressure_pa = kNotAvailable;
  double retract_pressure_pa = kNotAvailable;
  double return_pressure_pa = kNotAvailable;
  std::uint8_t limit = 7;  ///< ValveLimit.

  static constexpr auto parameters() {
    using M = AuxiliaryValveMeasuredFlow;
    return std::array{
        vehicle::number("extend port flow", 1899, {1}, 8, kMeasuredFlow, &M::extend_share),
        vehicle::number("retract port flow", 1900, {2}, 8, kMeasuredFlow, &M::retract_share),
        vehicle::number("extend port pressure", 1904, {3}, 16, kPortPressure,
                        &M::extend_pressure_pa),
        vehicle::number("retract port pressure", 1905, {5}, 16, kPortPressure,
                        &M::retract_pressure_pa),
        vehicle::number("return port pressure", 1906, {7}, 8, kReturnPressure,
                        &M::return_pressure_pa),
        vehicle::code("limit status", 5160, {8, 6}, 3, &M::limit),
    };
  }
};

/// Auxiliary valve 0 measured position (Proprietary B).
struct AuxiliaryValveMeasuredPosition {
  static constexpr Group kGroup{"AV00MP", 65312, 3, std::chrono::milliseconds{100}};

  double position_share = kNotAvailable;  ///< -1 .. 1 of full spool travel.
  std::uint8_t state = 15;                ///< ValveState.
  double position_m = kNotAvailable;      ///< Position of the spool, m.

  static constexpr auto parameters() {
    using M = AuxiliaryValveMeasuredPosition;
    return std::array{
        vehicle::number("spool position", 0, {1}, 16, kPositionShare, &M::position_share),
        vehicle::code("state", 0, {3, 1}, 4, &M::state, kValveStates),
        vehicle::number("spool travel", 0, {4}, 16, kPosition, &M::position_m),
    };
  }
};

/// The valve whose group of that kind (its valve 0's number) `pgn` is; nothing when none is.
template <class Message>
[[nodiscard]] constexpr std::optional<unsigned> valve_of(std::uint32_t pgn) {
  const std::uint32_t valve = pgn - Message::kGroup.pgn;
  return valve < kAuxiliaryValves ? std::optional<unsigned>(valve) : std::nullopt;
}

/// Valve `valve`'s message, 0 .. 15.
template <class Message>
[[nodiscard]] can::Frame encode(unsigned valve, const Message& message, std::uint8_t source) {
  Group group = Message::kGroup;
  group.pgn += valve;
  return vehicle::encode(message, source, j1939::kGlobalAddress, group);
}

/// Malformed unless the frame is a message of that kind and valve with eight bytes.
template <class Message>
[[nodiscard]] Decoded<Message> decode(unsigned valve, const can::Frame& frame) {
  return vehicle::decode<Message>(frame, Message::kGroup.pgn + valve);
}

/// The auxiliary valves' messages, for valves first_valve .. first_valve + valves - 1, as a device
/// called `sender` with that address sends them (commands: sent to it by any node, source FE).
[[nodiscard]] std::vector<can::OwnedMessage> message_layouts(unsigned first_valve, unsigned valves,
                                                             std::uint8_t address,
                                                             const std::string& sender);

}  // namespace rigwire::protocols::iso11783
