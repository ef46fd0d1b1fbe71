// Tables of the suite "lidar": what lidars cost in a large forest, what moving bodies cost and how
// exactly they are seen, and whether rays get through closed surfaces.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

namespace rigwire::bench {

void lidar_load_tables(std::ostream& text, nlohmann::json& json);

}  // namespace rigwire::bench
