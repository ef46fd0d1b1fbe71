// Private wires for a recorded rig that is run again (hil/control/verification.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/loopback_claims.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

/// Returns the rig on private wires, as in an isolated run (hil/rig/isolated_rig.h), but for the
/// addresses of cameras, which they report. It opens no web interface, no further port of a bus and
/// no truth tap. Appends what clients could notice of that to `remarks`. Throws as isolating() and
/// with() do.
[[nodiscard]] RigConfiguration made_private(const RigConfiguration& recorded,
                                            const std::filesystem::path& folder,
                                            drivers::LoopbackClaims& claims,
                                            std::vector<std::string>& remarks);

}  // namespace rigwire::hil
