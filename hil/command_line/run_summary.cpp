#include "hil/command_line/run_summary.h"

#include <fmt/format.h>

#include <string_view>

#include "hil/command_line/text_table.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {
namespace {

constexpr const char* kYellow = "33";  // SGR parameters (ECMA-48, 8.3.117)
constexpr const char* kRed = "31";

std::string request_text(const DeviceReport& device) {
  if (!device.last_request) {
    return device.statistics.last_client_activity ? "nothing understood" : "nothing";
  }
  return fmt::format("{} at {:.3f} s", printable(device.last_request->text),
                     to_seconds(device.last_request->at));
}

}  // namespace

std::vector<std::string> draw_summary(const RunReport& report, bool colour) {
  const RunOutcome& outcome = report.outcome;
  const double simulated_s = to_seconds(outcome.reached);
  std::vector<std::string> lines;
  lines.push_back(fmt::format("ran {:.3f} s in {:.3f} s, real-time factor {:.2f}", simulated_s,
                              outcome.wall_s,
                              outcome.wall_s > 0.0 ? simulated_s / outcome.wall_s : 0.0));
  lines.push_back(painted(
      fmt::format("clock slips: {}, {:.3f} s together", outcome.slips, to_seconds(outcome.slipped)),
      outcome.slips > 0 ? kYellow : nullptr, colour));
  if (outcome.fault) {
    lines.push_back(painted("ended early: " + printable(*outcome.fault), kRed, colour));
  }
  TextTable table({{"device"},
                   {"frames", true},
                   {"bytes", true},
                   {"drops", true},
                   {"latest us", true},
                   {"client asked last"}});
  for (const DeviceReport& device : report.devices) {
    const std::uint64_t dropped = device.statistics.dropped;
    table.add({{printable(device.name)},
               {std::to_string(device.frames)},
               {std::to_string(device.statistics.bytes)},
               {std::to_string(dropped), dropped > 0 ? kRed : nullptr},
               {fmt::format("{:.0f}", to_seconds(device.statistics.lateness.max()) * 1e6)},
               {request_text(device)}});
  }
  for (std::string& line : table.lines(0, colour)) {
    lines.push_back(std::move(line));
  }
  for (const FaultWindow& fault : report.faults) {
    const bool cut = fault.end > outcome.reached;
    lines.push_back(fmt::format("fault acted: {} {}, {:.3f} .. {:.3f} s{}", printable(fault.where),
                                printable(fault.type), to_seconds(fault.begin),
                                to_seconds(cut ? outcome.reached : fault.end),
                                cut ? ", to the end of the run" : ""));
  }
  return lines;
}

}  // namespace rigwire::hil
