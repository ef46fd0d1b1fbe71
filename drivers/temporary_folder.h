// New folders for what lasts no longer than the program.
#pragma once

#include <filesystem>
#include <string>

namespace rigwire::drivers {

/// Makes a folder that only this user can open, "/tmp/rigwire-NAME-x7Gk2a", below the folder that
/// TMPDIR names, else /tmp. `what` is for people: "a folder for the rig's wires". Throws
/// EndpointError with it, the folder that was tried and the remedy.
[[nodiscard]] std::filesystem::path make_temporary_folder(const std::string& what,
                                                          const std::string& name);

}  // namespace rigwire::drivers
