#include "hil/control/ruling.h"

#include <array>
#include <string_view>
#include <utility>

#include "fields/rules.h"
#include "hil/configuration/plain_text.h"
#include "hil/record/report.h"

namespace rigwire::hil {

using Json = nlohmann::ordered_json;

Ruling wrong(const Problems& problems) {
  return wrong(json_of(problems.sorted().front()));
}

std::string seconds_text(SimTime time) {
  return fields::print_duration(nanoseconds(time));
}

Json json_of(const DeviceStatus& device) {
  Json json{{"wire", device.wire},
            {"frames", device.frames},
            {"bytes", device.bytes},
            {"dropped", device.dropped},
            {"nominal_rate_hz", device.nominal_rate_hz},
            {"lateness_p50_us", 1e6 * to_seconds(device.lateness_p50)},
            {"lateness_p99_us", 1e6 * to_seconds(device.lateness_p99)},
            {"lateness_max_us", 1e6 * to_seconds(device.lateness_max)},
            {"lateness_us", lateness_json(device.lateness)},
            {"client_present", device.client_present},
            {"readers", device.readers},
            {"last_request", nullptr}};
  if (device.last_request) {
    json["last_request"] = {{"time_ns", nanoseconds(device.last_request->at)},
                            {"text", printable(device.last_request->text)}};
  }
  return json;
}

Json json_of(const BusStatus& bus) {
  // By protocols::can::ErrorState.
  constexpr std::array<std::string_view, 4> kStates{"active", "warning", "passive", "bus-off"};
  Json nodes = Json::array();
  for (const emulators::CanNodeStatus& node : bus.nodes) {
    nodes.push_back({{"name", printable(std::string(node.name))},
                     {"state", kStates[static_cast<std::size_t>(node.controller.state)]},
                     {"transmit_errors", node.controller.transmit_errors},
                     {"receive_errors", node.controller.receive_errors},
                     {"sent", node.counters.sent},
                     {"received", node.counters.received},
                     {"overflowed", node.counters.overflowed},
                     {"retransmissions", node.counters.retransmissions},
                     {"bus_offs", node.counters.bus_offs}});
  }
  return {{"load", bus.load},
          {"frames", bus.frames},
          {"error_frames", bus.error_frames},
          {"nodes", std::move(nodes)}};
}

Json json_of(const FaultWindow& fault) {
  const auto instant = [](SimTime time) {
    return time == kNever ? Json(nullptr) : Json(nanoseconds(time));
  };
  Json json{{"where", fault.where},
            {"type", fault.type},
            {"begin_ns", instant(fault.begin)},
            {"end_ns", instant(fault.end)}};
  if (!fault.waits_for.empty()) {
    json["waits_for"] = printable(fault.waits_for);
  }
  return json;
}

Json json_of(const RigFaults::Numbered& fault) {
  Json json{{"id", fault.id}};
  json.update(json_of(fault.window));
  return json;
}

Json json_of(const NoSuchFault& error) {
  return {{"what", error.what()},
          {"path", error.path},
          {"found", shortened(error.found)},
          {"allowed", error.allowed}};
}

Json json_of(const Problem& problem) {
  Problem brief = problem;  // Without `found` and `allowed`, which have keys of their own.
  brief.found.clear();
  brief.allowed.clear();
  Json why{{"what", brief.line()}};
  for (const auto& [key, words] : {std::pair{"path", shortened(problem.path)},
                                   {"found", shortened(problem.found)},
                                   {"allowed", problem.allowed}}) {
    if (!words.empty()) {
      why[key] = printable(words);
    }
  }
  return why;
}

Json json_of(const RunEvent& event) {
  return {{"number", event.number},
          {"time_ns", nanoseconds(event.at)},
          {"kind", kEventKinds[static_cast<std::size_t>(event.kind)]},
          {"level", kLogLevels[static_cast<std::size_t>(event.level)]},
          {"where", printable(event.where)},
          {"text", printable(event.text)}};
}

}  // namespace rigwire::hil
