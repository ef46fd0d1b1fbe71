#include "hil/command_line/status_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigwire::hil {
namespace {

constexpr double kRateTolerance = 0.1;

std::string paint(const std::string& text, const char* code, bool colour) {
  return colour ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : text;
}

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
  if (device.since_client_activity) {
    return fmt::format("{:.1f} s ago", to_seconds(*device.since_client_activity));
  }
  return device.client_present ? "listens" : "none";
}

}  // namespace

std::string draw_status_table(const RigStatus& before, const RigStatus& now,
                              const std::vector<StateQuantity>& machine, bool colour) {
  const double simulated_s = to_seconds(now.now - before.now);
  const double wall_s = now.wall_s - before.wall_s;
  std::size_t wire_width = 4;
  for (const auto& device : now.devices) {
    wire_width = std::max(wire_width, device.wire.size());
  }

  std::string text = fmt::format("t = {:9.3f} s   real-time factor {:.2f}", to_seconds(now.now),
                                 wall_s > 0.0 ? simulated_s / wall_s : 0.0);
  if (now.slipped > Duration{0}) {
    text += paint(fmt::format("   clock slipped {:.3f} s", to_seconds(now.slipped)), "33", colour);
  }
  text += "\n";
  text += paint(fmt::format("{:<12} {:<{}} {:>8} {:>8} {:>11} {:>23} {:>6}  {}", "device", "wire",
                            wire_width, "frames/s", "nominal", "bytes", "late p50/p99/max us",
                            "drops", "client"),
                "1", colour) +
          "\n";
  for (std::size_t i = 0; i < now.devices.size(); ++i) {
    const DeviceStatus& device = now.devices[i];
    const DeviceStatus empty;
    const DeviceStatus& earlier = i < before.devices.size() ? before.devices[i] : empty;
    const double per_s = simulated_s > 0.0 ? 1.0 / simulated_s : 0.0;
    const double rate = static_cast<double>(device.frames - earlier.frames) * per_s;
    const bool off_rate =
        device.nominal_rate_hz > 0.0 && std::abs(rate - device.nominal_rate_hz) >
                                            std::max(1.0, kRateTolerance * device.nominal_rate_hz);
    const auto lateness =
        fmt::format("{}/{}/{}", microseconds(device.lateness_p50),
                    microseconds(device.lateness_p99), microseconds(device.lateness_max));
    text += fmt::format(
        "{:<12} {:<{}} {} {:>8} {:>11} {:>23} {}  {}\n", device.name, device.wire, wire_width,
        paint(fmt::format("{:>8.1f}", rate), "33", colour && off_rate),
        device.nominal_rate_hz > 0.0 ? fmt::format("{:.1f}", device.nominal_rate_hz) : "on demand",
        byte_rate(static_cast<double>(device.bytes - earlier.bytes) * per_s), lateness,
        paint(fmt::format("{:>6}", device.dropped), "31", colour && device.dropped > 0),
        client_text(device));
  }
  std::string line = "machine     ";
  for (std::size_t i = 0; i < std::min(machine.size(), now.machine.size()); ++i) {
    line += fmt::format(" {} {:.1f} {} ", machine[i].name, now.machine[i], machine[i].unit);
  }
  return text + line + "\n";
}

}  // namespace rigwire::hil
