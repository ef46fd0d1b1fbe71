// A recording as a rig: each wire is played by a device of the type replay (hil/devices/replay.h),
// where it was, at the recorded instants.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

struct ReplayedPiece {
  Duration from{0};
  Duration to{0};  ///< 0: the end.
  double speed = 1.0;
  bool loop = false;
};

struct ReplayedRig {
  RigConfiguration configuration;
  Duration length{0};  ///< Length of the piece at its speed; of one round with `loop`.
  std::vector<std::string> remarks;  ///< Wires that cannot be played, a line each.
};

/// Throws std::invalid_argument where the folder is no recording, the piece holds nothing, or no
/// wire of it can be played.
[[nodiscard]] ReplayedRig replayed_rig(const std::filesystem::path& folder,
                                       const ReplayedPiece& piece);

}  // namespace rigwire::hil
