// A user's own valve driver: its Modbus registers from a YAML file, without C++.
//
// docs/your-own-valve.md walks through one; configs/valves/ has examples. Every key and its range
// are in emulators/valve_driver/valve_map.cpp (`rigwire describe --valve-map FILE` prints the map's
// table).
#pragma once

#include <string>

#include "emulators/valve_driver/valve_map.h"

namespace rigwire::hil {

/// Throws ConfigurationError with every finding, each with file, line and column: what the reader
/// finds (unknown keys and signals with the nearest one, wrong kinds, ranges), registers that
/// overlap, units that do not belong to their signal, what cannot be written, texts that do not
/// fit; and a map that nothing enables.
[[nodiscard]] emulators::ValveMap load_valve_map(const std::string& file);

/// Parses `text` like load_valve_map(); `name` is its name in messages.
[[nodiscard]] emulators::ValveMap parse_valve_map(const std::string& text, const std::string& name);

}  // namespace rigwire::hil
