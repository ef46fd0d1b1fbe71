#include <fmt/format.h>

#include "bench/can_bus_bench.h"
#include "bench/can_hop_bench.h"
#include "bench/can_overload_bench.h"
#include "bench/gs_usb_bench.h"
#include "bench/modbus_bench.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
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
  text << fmt::format("{} s of {:.0f} % offered to 250 kbit/s, bus load at the end {:.1f} %\n",
                      kOverload_s, 100.0 * overload.offered_load, 100.0 * overload.bus_load);
  const Table table(text, {{"identifier", ">10"},
                           {"offered/s", ">12"},
                           {"sent/s", ">12"},
                           {"lost", ">8"},
                           {"longest wait ms", ">16"}});
  table.head();
  nlohmann::json json = {{"seconds", kOverload_s},
                         {"offered_load", overload.offered_load},
                         {"bus_load", overload.bus_load}};
  for (const CanOverloadNode& node : overload.nodes) {
    json["nodes"].push_back(table.row({cell("id", node.id, fmt::format("{:X}", node.id)),
                                       number("offered_per_s", node.offered_per_s, "{:.1f}"),
                                       number("sent_per_s", node.sent_per_s, "{:.1f}"),
                                       number("lost_share", node.lost_share, "{:.1f}%", 100.0),
                                       number("longest_wait_ms", node.longest_wait_ms, "{:.3f}")}));
  }
  text << "\n";
  return json;
}

nlohmann::json hop_table(std::ostream& text) {
  const Table table(text, {{"last hop, one frame", "<44"},
                           {"device ns", ">10"},
                           {"frames/s", ">12"},
                           {"wire's limit", ">12"},
                           {"of a core", ">10"}});
  table.head();
  nlohmann::json json = nlohmann::json::array();
  const auto row = [&](const std::string& hop, double device_ns, double per_second, double limit,
                       double share, std::uint64_t lost) {
    json.push_back(table.row(
        {word("hop", hop), number("device_ns", device_ns, "{:.0f}"),
         number("frames_per_s", per_second, "{:.0f}"), number("wire_limit_per_s", limit, "{:.0f}"),
         number("core_share", share, "{:.2f}%", 100.0), stored("lost", lost)}));
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

nlohmann::json modbus_lines(std::ostream& text) {
  const ModbusBench bench = measure_modbus({});
  text << fmt::format(
      "Modbus TCP on loopback, client and server on one processor: {:.0f} transactions/s one at a "
      "time, {:.0f}/s in batches of 16\n"
      "latency p50 {:.1f} us, p99 {:.1f} us; bare echo {:.1f} us, {:.1f} us; ratio {:.2f}, {:.2f}\n"
      "server alone {:.0f} ns per request; wrong answers {}\n",
      bench.per_second, bench.pipelined_per_second, bench.modbus.p50_us, bench.modbus.p99_us,
      bench.echo.p50_us, bench.echo.p99_us, bench.ratio_p50, bench.ratio_p99,
      bench.nanoseconds_alone, bench.wrong_answers);
  return {{"transactions_per_second", bench.per_second},
          {"pipelined_per_second", bench.pipelined_per_second},
          {"p50_us", bench.modbus.p50_us},
          {"p99_us", bench.modbus.p99_us},
          {"echo_p50_us", bench.echo.p50_us},
          {"echo_p99_us", bench.echo.p99_us},
          {"ratio_p50", bench.ratio_p50},
          {"ratio_p99", bench.ratio_p99},
          {"ns_alone", bench.nanoseconds_alone},
          {"wrong_answers", bench.wrong_answers}};
}

}  // namespace

nlohmann::json bench_buses(std::ostream& text) {
  nlohmann::json json;
  json["can_model"] = model_table(text);
  json["can_overload"] = overload_table(text);
  json["can_hops"] = hop_table(text);
  json["modbus"] = modbus_lines(text);
  return json;
}

}  // namespace rigwire::bench
