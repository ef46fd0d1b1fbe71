// Where a sensor sits on the machine.
#pragma once

#include <string>

#include "fields/rules.h"
#include "hil/world/shapes.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// Where a sensor sits: pose of its frame S in the frame of a link L of the machine (X_LS).
struct MountConfiguration {
  std::string link = "upper";
  Vector3 position_m;
  RollPitchYaw rotation;
};
void visit(fields::Visitor& v, MountConfiguration& p);

}  // namespace rigwire::hil
