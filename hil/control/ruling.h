// Result of a control command, before the current time is added, and the JSON of the parts of a run
// (docs/control.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "hil/configuration/fault_window.h"
#include "hil/configuration/problems.h"
#include "hil/control/reply.h"
#include "hil/record/run_events.h"
#include "hil/rig/rig_faults.h"
#include "hil/rig/rig_status.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// A Reply without `ok`, `time_ns` and `paused`.
struct Ruling {
  Reply::Outcome outcome = Reply::Outcome::done;
  nlohmann::ordered_json told;
};

/// `why`: what, path, found, allowed.
[[nodiscard]] inline Ruling wrong(nlohmann::ordered_json why) {
  return {Reply::Outcome::wrong, std::move(why)};
}
/// Reports the first of the problems.
[[nodiscard]] Ruling wrong(const Problems& problems);
[[nodiscard]] inline Ruling refused(nlohmann::ordered_json why) {
  return {Reply::Outcome::refused, std::move(why)};
}

/// Time since the start of the run.
[[nodiscard]] inline std::int64_t nanoseconds(SimTime time) {
  return (time - kStart).count();
}
[[nodiscard]] std::string seconds_text(SimTime time);

[[nodiscard]] nlohmann::ordered_json json_of(const DeviceStatus& device);
[[nodiscard]] nlohmann::ordered_json json_of(const BusStatus& bus);
[[nodiscard]] nlohmann::ordered_json json_of(const FaultWindow& fault);
[[nodiscard]] nlohmann::ordered_json json_of(const RigFaults::Numbered& fault);
[[nodiscard]] nlohmann::ordered_json json_of(const RunEvent& event);
// Reason of a refusal.
[[nodiscard]] nlohmann::ordered_json json_of(const NoSuchFault& error);
// Shortens long paths and values.
[[nodiscard]] nlohmann::ordered_json json_of(const Problem& problem);

}  // namespace rigwire::hil
