// The suite iso11783-valves checks a block of auxiliary valves on an ISO 11783 bus by what its
// messages report, and, where a machine may move, by how it obeys commands. The suite is a node, as
// that of j1939 is, and sends commands with priority 3 every 100 ms.
//
// Documents: ISO 11783-7 (auxiliary valve command, estimated and measured flow, as isobus.net lists
// their parameters), ISO 11783-5 (NAME), ISO 11783-12 (functionalities, as AgIsoStack++ has them),
// SAE J1939-73 (DM1). These texts were not available: docs/devices/iso-valves.md says what is
// certain. What rests on this project's reading alone is a "should": the place of the exit/reason
// code, and whose commands count. Chapters are groups by their letters.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conform/bounds.h"
#include "conform/j1939/j1939_trial.h"
#include "conform/suite_options.h"

namespace rigwire::conform {

/// What a block of valves claims.
struct IsoValveClaims {
  std::uint8_t address = 0x80;
  unsigned first_valve = 0;              ///< Number of its first auxiliary valve, 0 .. 15.
  unsigned valves = 1;                   ///< Numbered one after the other, 15 the last.
  std::optional<std::uint8_t> function;  ///< In the NAME; nothing: not claimed.
  bool measured_flow = true;             ///< It sends measured flow.
  std::chrono::milliseconds command_timeout{
      0};                                   ///< Without commands until neutral; 0: not claimed.
  std::chrono::milliseconds patience{500};  ///< Timeout of an answer.
};

/// The block under test.
struct IsoValveDevice {
  std::function<std::unique_ptr<CanLine>()> open;  ///< May throw Unreachable.
  IsoValveClaims claims;
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();
};

struct IsoValveCase {
  CaseIdentity identity;
  /// What the block does not claim of what the case needs; empty: nothing.
  std::string (*missing)(const IsoValveClaims& claims) = nullptr;
  void (*run)(J1939Trial& trial, const IsoValveClaims& claims) = nullptr;
};
[[nodiscard]] std::vector<IsoValveCase> iso_valve_cases();

/// Throws Unreachable when the bus cannot be opened.
[[nodiscard]] SuiteResult run_iso_valve_suite(const IsoValveDevice& device,
                                              const SuiteOptions& options);

/// Returns the claims of the first node that sends estimated flow: its address, valves and
/// function. The command timeout is not tested, as that would take commands. Throws Unreachable,
/// also if no node sends estimated flow within 2 s.
[[nodiscard]] IsoValveClaims survey_iso_valves(const IsoValveDevice& device);

}  // namespace rigwire::conform
