// A rig that meets nobody: a copy of one whose wires are its own, to be run beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

/// Puts every pty and every file that a device saves into `folder`, has the system choose every TCP
/// port that stands in no byte on a wire, opens no web interface, no further port of a bus and no
/// truth tap. What is the same on the wires: addresses and ports of datagrams, and a camera's own
/// address. Files that devices had saved are copied. `remarks` is told what is otherwise than in
/// the rig, and can be heard.
void make_private(RigConfiguration& rig, const std::filesystem::path& folder,
                  std::vector<std::string>& remarks);

}  // namespace rigwire::hil
