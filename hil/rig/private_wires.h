// A recorded rig that meets nobody while it is run once more (hil/control/verification.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/loopback_claims.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

/// The rig on wires of its own as an isolated run has them (hil/rig/isolated_rig.h), but for the
/// addresses of cameras, which they tell. It opens no web interface, no further port of a bus and
/// no truth tap. `remarks` is told what can be heard of that. Throws as isolating() and with() do.
[[nodiscard]] RigConfiguration made_private(const RigConfiguration& recorded,
                                            const std::filesystem::path& folder,
                                            drivers::LoopbackClaims& claims,
                                            std::vector<std::string>& remarks);

}  // namespace rigwire::hil
