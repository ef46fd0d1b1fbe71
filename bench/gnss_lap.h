// One lap of a track with every satellite receiver of a rig: what the paper's figure 2 shows.
#pragma once

#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::bench {

struct LapEpoch {
  double along_m = 0.0;
  int satellites = 0;                ///< Used.
  double horizontal_dilution = 0.0;  ///< NaN when not available, as the following.
  double vertical_dilution = 0.0;
  double position_dilution = 0.0;
  double horizontal_error_m = 0.0;
  double vertical_error_m = 0.0;
};

struct Lap {
  std::string device;  ///< Name in the rig.
  std::string type;    ///< "ublox-neo-7p".
  std::vector<LapEpoch> epochs;
};

/// The first closed track of the rig's scene, an epoch every `spacing_m`; a u-blox receiver by the
/// paper's models, whose figure 2 this is after. Throws
/// std::invalid_argument when the scene has no closed track, the rig no receiver, or a number is
/// not positive.
[[nodiscard]] std::vector<Lap> drive_lap(const hil::RigConfiguration& rig, double speed_mps,
                                         double spacing_m);

/// Minimum and maximum of the epochs that have a value.
struct LapRange {
  struct Span {
    double least = 0.0;
    double greatest = 0.0;
  };
  Span satellites;
  Span horizontal;  ///< Dilutions.
  Span vertical;
  Span position;
};
[[nodiscard]] LapRange lap_range(const Lap& lap);

/// Where along the lap a building (box of the scene) is nearest, for those within `reach_m`.
struct PassedBuilding {
  std::string name;
  double along_m = 0.0;
  double distance_m = 0.0;  ///< From the centre line to its nearest corner.
  double height_m = 0.0;
};
[[nodiscard]] std::vector<PassedBuilding> passed_buildings(const hil::RigConfiguration& rig,
                                                           double reach_m);

}  // namespace rigwire::bench
