#include "hil/command_line/status_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "hil/command_line/text_table.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {
namespace {

constexpr double kRateTolerance = 0.1;
constexpr const char* kYellow = "33";  // SGR parameters (ECMA-48, 8.3.117)
constexpr const char* kRed = "31";

std::string byte_rate(double bytes_per_s) {
  if (bytes_per_s >= 1e6) {
    return fmt::format("{:.2f} MB/s", bytes_per_s * 1e-6);
  }
  if (bytes_per_s >= 1e4) {
    return fmt::format("{:.1f} kB/s", bytes_per_s * 1e-3);
  }
  return fmt::format("{:.0f} B/s", bytes_per_s);
}

std::string microseconds(Duration span) {
  return fmt::format("{:.0f}", to_seconds(span) * 1e6);
}

std::string client_text(const DeviceStatus& device) {
  if (device.readers > 1) {
    return fmt::format("{} readers", device.readers);  // each gets a part of the bytes
  }
  std::string text = device.client_present ? "listens" : "none";
  if (device.since_client_activity) {
    text = fmt::format("{:.1f} s ago", to_seconds(*device.since_client_activity));
  }
  return device.last_request ? text + ", " + printable(device.last_request->text) : text;
}

std::vector<Cell> device_row(const DeviceStatus& earlier, const DeviceStatus& device,
                             double simulated_s) {
  const double per_s = simulated_s > 0.0 ? 1.0 / simulated_s : 0.0;
  const double rate = static_cast<double>(device.frames - earlier.frames) * per_s;
  const bool off_rate =
      device.nominal_rate_hz > 0.0 && std::abs(rate - device.nominal_rate_hz) >
                                          std::max(1.0, kRateTolerance * device.nominal_rate_hz);
  return {
      {printable(device.name)},
      {printable(device.wire)},
      {fmt::format("{:.1f}", rate), off_rate ? kYellow : nullptr},
      {device.nominal_rate_hz > 0.0 ? fmt::format("{:.1f}", device.nominal_rate_hz) : "on demand"},
      {byte_rate(static_cast<double>(device.bytes - earlier.bytes) * per_s)},
      {fmt::format("{}/{}/{}", microseconds(device.lateness_p50), microseconds(device.lateness_p99),
                   microseconds(device.lateness_max))},
      {std::to_string(device.dropped), device.dropped > 0 ? kRed : nullptr},
      {client_text(device)}};
}

}  // namespace

std::vector<std::string> draw_status_table(const RigStatus& before, const RigStatus& now,
                                           const std::vector<StateQuantity>& machine,
                                           const TableLook& look) {
  const auto fitting = [&](const std::string& text, const char* colour = nullptr) {
    return painted(look.columns == 0 ? text : clipped(text, look.columns), colour, look.colour);
  };
  const double simulated_s = to_seconds(now.now - before.now);
  const double wall_s = now.wall_s - before.wall_s;
  std::vector<std::string> lines;
  const std::string clock =
      fmt::format("t = {:9.3f} s   real-time factor {:.2f}", to_seconds(now.now),
                  wall_s > 0.0 ? simulated_s / wall_s : 0.0);
  lines.push_back(fitting(clock));
  if (now.slipped > Duration{0}) {
    lines.push_back(
        fitting(fmt::format("clock slipped {:.3f} s", to_seconds(now.slipped)), kYellow));
  }
  TextTable table({{"device", false, 0, 12},
                   {"wire", false, 0, 24},
                   {"frames/s", true},
                   {"nominal", true, 1},
                   {"bytes", true, 2},
                   {"late p50/p99/max us", true, 3},
                   {"drops", true},
                   {"client", false, 0, 9}});
  for (std::size_t i = 0; i < now.devices.size(); ++i) {
    const DeviceStatus empty;
    table.add(device_row(i < before.devices.size() ? before.devices[i] : empty, now.devices[i],
                         simulated_s));
  }
  for (std::string& line : table.lines(look.columns, look.colour)) {
    lines.push_back(std::move(line));
  }
  for (const FaultWindow& fault : now.faults) {
    const std::string end = fault.end == kNever ? std::string("the end")
                                                : fmt::format("{:.3f} s", to_seconds(fault.end));
    lines.push_back(fitting(
        fmt::format("fault: {} {}, until {}", printable(fault.where), printable(fault.type), end),
        kYellow));
  }
  std::string state = "machine";
  for (std::size_t i = 0; i < std::min(machine.size(), now.machine.size()); ++i) {
    state += fmt::format("  {} {:.1f} {}", machine[i].name, now.machine[i], machine[i].unit);
  }
  lines.push_back(fitting(printable(state)));
  if (look.lines != 0 && lines.size() > look.lines) {
    const std::size_t missing = lines.size() - (look.lines - 1);
    lines.resize(look.lines - 1);
    lines.push_back(fitting(fmt::format("+{} more", missing)));
  }
  return lines;
}

namespace {

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
