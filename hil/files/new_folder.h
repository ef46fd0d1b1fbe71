// Makes an empty folder.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigwire::hil {

/// Makes `folder`, and those above it. Throws drivers::EndpointError when it cannot be made, is no
/// folder, or is not empty; `what` names the option that asked for it.
void make_new_folder(std::string_view what, const std::filesystem::path& folder);

}  // namespace rigwire::hil
