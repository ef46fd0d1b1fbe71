// The suites behind bench/registry.h, one function each. JSON keys are in docs/accuracy/.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

namespace rigwire::bench {

nlohmann::json bench_rig(std::ostream& text);
nlohmann::json bench_pacing(std::ostream& text);
nlohmann::json bench_lidar(std::ostream& text);
nlohmann::json bench_lidar_peer(std::ostream& text);
nlohmann::json bench_weather(std::ostream& text);
nlohmann::json bench_camera(std::ostream& text);
nlohmann::json bench_excavator(std::ostream& text);
nlohmann::json bench_dynamics(std::ostream& text);
nlohmann::json bench_contact(std::ostream& text);
nlohmann::json bench_gnss(std::ostream& text);
nlohmann::json bench_encoding(std::ostream& text);
nlohmann::json bench_buses(std::ostream& text);
nlohmann::json bench_bridge(std::ostream& text);
nlohmann::json bench_dashboard(std::ostream& text);

/// Runs of `bridge` that go two at a time, before it is called; a tenth as many, and two at least,
/// go one by one. A thousand unless said.
void set_bridge_runs(int runs);

}  // namespace rigwire::bench
