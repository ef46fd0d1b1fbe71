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

/// Sets how many runs of `bridge` go two at a time; call it before bench_bridge(). A tenth as many,
/// and at least two, go one by one. Default: 1000.
void set_bridge_runs(int runs);

}  // namespace rigwire::bench
