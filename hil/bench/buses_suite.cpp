#include <fmt/format.h>

#include "hil/bench/can_bus_bench.h"
#include "hil/bench/can_hop_bench.h"
#include "hil/bench/can_overload_bench.h"
#include "hil/bench/gs_usb_bench.h"
#include "hil/bench/modbus_bench.h"
#include "hil/bench/suites.h"

namespace rigwire::hil {
namespace {

constexpr std::uint64_t kModelFrames = 400'000;
constexpr int kOverload_s = 60;

nlohmann::json model_table(std::ostream& text) {
  const CanBusCost cost = measure_can_bus(kModelFrames);
  text << fmt::format(
      "CAN bus model, 1 Mbit/s saturated by ten nodes, {} frames:\n"
      "  {:.0f} ns per frame, the wire carries {:.0f} frames/s: {:.2f} % of a core\n"
      "  {:.0f} ns per attempt that nobody acknowledges\n"
      "  arrival against the exact bit schedule: at most {:.3f} ns off\n\n",
      cost.frames, cost.frame_ns, cost.wire_frames_per_s, 100.0 * cost.core_share,
      cost.failed_attempt_ns, cost.worst_arrival_error_ns);
  return {{"frames", cost.frames},
          {"frame_ns", cost.frame_ns},
          {"wire_frames_per_s", cost.wire_frames_per_s},
          {"core_share", cost.core_share},
          {"failed_attempt_ns", cost.failed_attempt_ns},
          {"worst_arrival_error_ns", cost.worst_arrival_error_ns}};
}

nlohmann::json overload_table(std::ostream& text) {
  const CanOverload overload = measure_can_overload(kOverload_s);
  text << fmt::format(
      "{} s of {:.0f} % offered to 250 kbit/s, bus load at the end {:.1f} %\n"
      "{:>10} {:>12} {:>12} {:>8} {:>16}\n",
      kOverload_s, 100.0 * overload.offered_load, 100.0 * overload.bus_load, "identifier",
      "offered/s", "sent/s", "lost", "longest wait ms");
  nlohmann::json json = {{"seconds", kOverload_s},
                         {"offered_load", overload.offered_load},
                         {"bus_load", overload.bus_load}};
  for (const CanOverloadNode& node : overload.nodes) {
    text << fmt::format("{:>10X} {:>12.1f} {:>12.1f} {:>7.1f}% {:>16.3f}\n", node.id,
                        node.offered_per_s, node.sent_per_s, 100.0 * node.lost_share,
                        node.longest_wait_ms);
    json["nodes"].push_back({{"id", node.id},
                             {"offered_per_s", node.offered_per_s},
                             {"sent_per_s", node.sent_per_s},
                             {"lost_share", node.lost_share},
                             {"longest_wait_ms", node.longest_wait_ms}});
  }
  text << "\n";
  return json;
}

nlohmann::json hop_table(std::ostream& text) {
  text << fmt::format("{:<44} {:>10} {:>12} {:>12} {:>10}\n", "last hop, one frame", "device ns",
                      "frames/s", "wire's limit", "of a core");
  nlohmann::json json = nlohmann::json::array();
  const auto row = [&](const std::string& hop, double device_ns, double per_second, double limit,
                       double share, std::uint64_t lost) {
    text << fmt::format("{:<44} {:>10.0f} {:>12.0f} {:>12.0f} {:>9.2f}%\n", hop, device_ns,
                        per_second, limit, 100.0 * share);
    json.push_back({{"hop", hop},
                    {"device_ns", device_ns},
                    {"frames_per_s", per_second},
                    {"wire_limit_per_s", limit},
                    {"core_share", share},
                    {"lost", lost}});
  };
  for (const CanHopCost& hop : measure_can_hops()) {
    row(hop.hop, hop.device_ns, hop.per_second, hop.wire_limit_per_second, hop.share_of_core(),
        hop.sent - hop.received);
  }
  for (const GsUsbCost& cost : measure_gs_usb()) {
    row("gs_usb " + cost.way + ", " + cost.frame, cost.nanoseconds, cost.per_second,
        cost.wire_limit_per_second, cost.core_share, cost.wrong);
  }
  text << "\n";
  return json;
}

}  // namespace

nlohmann::json bench_buses(std::ostream& text) {
  nlohmann::json json;
  json["can_model"] = model_table(text);
  json["can_overload"] = overload_table(text);
  json["can_hops"] = hop_table(text);
  json["modbus"] = bench_modbus(text);
  return json;
}

}  // namespace rigwire::hil
