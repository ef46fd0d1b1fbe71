// A user's own device on CAN as tables in Markdown, as docs/your-own-can-device.md shows them.
#pragma once

#include <string>

#include "hil/files/dbc_node_file.h"

namespace rigwire::hil {

/// Its messages and signals.
[[nodiscard]] std::string markdown_table(const DbcNodeDescription& device);

}  // namespace rigwire::hil
