// Which driver of the kernel sits on a serial line.
#pragma once

#include <string>

namespace rigwire::drivers {

/// Whether the kernel's slcan driver is attached to this terminal, as slcand attaches it. False
/// when the terminal cannot be opened.
[[nodiscard]] bool slcan_attached(const std::string& terminal);

}  // namespace rigwire::drivers
