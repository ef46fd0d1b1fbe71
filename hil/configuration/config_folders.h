// The folders in which rigs, machines and scenes are looked for by name.
#pragma once

#include <filesystem>
#include <vector>

namespace rigwire::hil {

/// Folders that hold rigs/, machines/ and scenes/, the first match winning: that of the environment
/// variable RIGWIRE_CONFIGS, ../share/rigwire/configs beside the program, as it is installed, the
/// source tree that it was built from. Throws ConfigurationError where the variable cannot be
/// shown.
[[nodiscard]] std::vector<std::filesystem::path> config_folders();

}  // namespace rigwire::hil
