// The commands of a run, as plain structures. Callers in the same process and clients of the
// control server fill them; their keys are read by the same visitor as a rig's file, so that errors
// are reported in the same words.
//
//   {verb: run_until, time: 2.5 s}
//   {verb: speed, factor: 4, at: 10 s}
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/problems.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct StateCommand {
  static constexpr fields::Named kNamed{"state", "The run, and whether it is paused."};
};
struct PauseCommand {
  static constexpr fields::Named kNamed{"pause", "Pauses simulated time."};
};
struct ResumeCommand {
  static constexpr fields::Named kNamed{"resume", "Resumes simulated time."};
};
struct RunUntilCommand {
  static constexpr fields::Named kNamed{"run_until",
                                        "Runs to an instant and pauses there; answers then."};

  Duration time{0};  ///< From the start of the run.
};
struct SeekCommand {
  static constexpr fields::Named kNamed{
      "seek",
      "In a replay: moves to an instant before or after now, as fast as possible, and goes on "
      "from there, paused if it was paused."};

  Duration time{0};  ///< From the start of the run.
};
struct StepCommand {
  static constexpr fields::Named kNamed{"step", "Runs for a while and pauses again; answers then."};

  Duration length = std::chrono::milliseconds{1};
};
struct SpeedCommand {
  static constexpr fields::Named kNamed{"speed", "Changes the pace, where the clock has one."};

  double factor = 1.0;  ///< Simulated seconds per second of wall time.
};
struct ReadCommand {
  static constexpr fields::Named kNamed{
      "read", "The machine's true state, the devices with their clients, the faults that act."};
};
struct WaitCommand {
  static constexpr fields::Named kNamed{
      "wait",
      "Runs until a quantity of the machine reaches a value; answers then, and pauses if it "
      "was paused before."};

  std::string quantity;  ///< Name of the quantity, as `read` lists it.
  bool above = true;     ///< True: wait for a value above `value`; false: below.
  double value = 0.0;    ///< In the quantity's unit.
  Duration limit = std::chrono::seconds{10};  ///< Simulated time; then the answer is a refusal.
};
struct FaultAddCommand {
  static constexpr fields::Named kNamed{
      "fault_add", "Adds a fault of a kind that its target can have; fault_list lists the kinds."};

  std::string on;     ///< Name of a device, "bus NAME" or "modbus NAME".
  std::string fault;  ///< Its keys as in a rig's file: "{type: jamming, for: 5 s}".
  /// No key of the request: `fault` once it is parsed; empty: not yet.
  std::optional<Value> keys{};
};
struct FaultClearCommand {
  static constexpr fields::Named kNamed{"fault_clear", "A fault ends, or will not begin."};

  std::uint32_t id = 1;  ///< Number that fault_add and fault_list report.
};
struct FaultListCommand {
  static constexpr fields::Named kNamed{"fault_list",
                                        "What can go wrong where, and every fault of this run."};
};
struct EventsCommand {
  static constexpr fields::Named kNamed{
      "events", "What happened: faults, slips, contacts, clients, refusals, with their instants."};

  std::uint64_t since = 0;  ///< Number of the last one that is known.
  bool wait = false;        ///< The answer comes when there is a newer one.
};
struct RecordCommand {
  static constexpr fields::Named kNamed{"record", "A recording of this run begins, or ends."};

  std::string folder;             ///< Where it begins.
  std::vector<std::string> only;  ///< Names of wires, or "truth"; empty: everything.
  bool stop = false;              ///< The current recording ends.
  bool confined = false;          ///< No key: the client may write into one folder only.
};
struct SetCommand {
  static constexpr fields::Named kNamed{
      "set",
      "Overrides set points of the machine, or releases them; sets rain, snow or fog; or changes "
      "settings of a device, as its own configuration software would."};

  std::string on = "machine";  ///< Or "air", or a device.
  std::string set;             ///< "{boom: 0.5, swing: null}"; null releases. "{rate: 5 Hz}"
  /// No key: `set` once it is parsed; empty: not yet.
  std::optional<Value> keys{};
};
struct StopCommand {
  static constexpr fields::Named kNamed{"stop", "The run ends as at the end of its duration."};
};

using Command = std::variant<StateCommand, PauseCommand, ResumeCommand, RunUntilCommand,
                             SeekCommand, StepCommand, SpeedCommand, ReadCommand, WaitCommand,
                             FaultAddCommand, FaultClearCommand, FaultListCommand, EventsCommand,
                             RecordCommand, SetCommand, StopCommand>;

inline void visit(fields::Visitor&, StateCommand&) {}
inline void visit(fields::Visitor&, PauseCommand&) {}
inline void visit(fields::Visitor&, ResumeCommand&) {}
void visit(fields::Visitor& v, RunUntilCommand& p);
void visit(fields::Visitor& v, SeekCommand& p);
void visit(fields::Visitor& v, StepCommand& p);
void visit(fields::Visitor& v, SpeedCommand& p);
inline void visit(fields::Visitor&, ReadCommand&) {}
void visit(fields::Visitor& v, WaitCommand& p);
void visit(fields::Visitor& v, FaultAddCommand& p);
void visit(fields::Visitor& v, FaultClearCommand& p);
inline void visit(fields::Visitor&, FaultListCommand&) {}
void visit(fields::Visitor& v, EventsCommand& p);
void visit(fields::Visitor& v, RecordCommand& p);
void visit(fields::Visitor& v, SetCommand& p);
inline void visit(fields::Visitor&, StopCommand&) {}

/// A command, and when it is executed.
struct Request {
  Command command;
  Duration at{0};  ///< From the start of the run; an instant in the past means now.
};
void visit(fields::Visitor& v, Request& p);

/// Keys whose value is an object written as text; they may also be written as an object.
inline constexpr std::array<std::string_view, 2> kFoldedKeys{"fault", "set"};

/// JSON text of a document that is equal to it.
[[nodiscard]] std::string json_text(const Value& document);

/// Maximum length in bytes of a key or value of a request, but for a `fault` or `set` that is
/// written as a text: the maximum path length on Linux (PATH_MAX).
inline constexpr std::size_t kMaxRequestWord = 4096;

/// Reads a request from text, JSON or YAML, whatever its origin. `name` names the text in messages;
/// `verb`, unless empty, replaces the verb that the text gives. Also parses what `fault` and `set`
/// hold. On an error returns nullopt and appends to `problems`.
[[nodiscard]] std::optional<Request> read_request(const std::string& text, const std::string& name,
                                                  Problems& problems, std::string_view verb = {});

/// Result of parsing a request: the request, or what is wrong with it. It shares nothing with its
/// text and can be passed to another thread.
struct ParsedRequest {
  std::optional<Request> request;
  std::optional<Problem> wrong;  ///< The first finding; set exactly when there is no request.
};
/// Parses a request like read_request(), for Desk::carry_out_parsed() on another thread. May be
/// called from any thread.
[[nodiscard]] ParsedRequest parse_command(const std::string& text, const std::string& name,
                                          std::string_view verb = {});

}  // namespace rigwire::hil
