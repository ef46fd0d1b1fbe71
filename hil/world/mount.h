// Where a sensor sits on the machine.
#pragma once

#include <string>

#include "fields/visitor.h"
#include "hil/world/shapes.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// Where a sensor sits: pose of its frame S in the frame of a link L of the machine (X_LS).
struct MountConfiguration {
  std::string link = "upper";
  Vector3 position_m;
  RollPitchYaw rotation;
};

inline void visit(fields::Visitor& v, MountConfiguration& p) {
  v.text("link", p.link, "Link of the machine that carries it.");
  v.vector3("position", p.position_m, fields::in("m"),
            "In the link's frame: x forward, y left, z up.");
  v.section("rotation", p.rotation, "Of the sensor's axes against the link's.");
}

}  // namespace rigwire::hil
