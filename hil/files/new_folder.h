// A folder that whoever asks for it finds empty.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigwire::hil {

/// Makes `folder`, and what is above it. Throws drivers::EndpointError where it cannot be made, is
/// no folder, or has something in it; `what` names the option that asked for it.
void make_new_folder(std::string_view what, const std::filesystem::path& folder);

}  // namespace rigwire::hil
