// What only the build knows: version, and where the source tree lies. One file is compiled with it,
// so that the objects of all others are the same in every copy of the tree.
#pragma once

#include <string>

namespace rigwire::hil {

/// Returns the version, for example "0.1.0".
[[nodiscard]] std::string version();

/// Return the folders of the source tree that serve a program that is not installed.
[[nodiscard]] std::string source_configs();
[[nodiscard]] std::string source_page();

}  // namespace rigwire::hil
