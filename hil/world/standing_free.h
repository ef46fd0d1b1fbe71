// Checks that a machine starts in a possible place: on the terrain, and with no part of it inside
// the ground, an obstacle or a loose thing. A part that starts inside would be thrown out by forces
// that do not occur on a real machine.
//
// Checked are the points that the machine itself names (sim/machine.h) and the surfaces of its
// shapes, boxes every 0.25 m (at most 41 points along an edge) and meshes at their vertices;
// against loose things boxes as a whole, since a crate may lie between the points. The shapes of
// links that stand on the ground, as wheels and drums do, are checked against loose things alone.
// Objects of the scene that are not solid are not checked.
#pragma once

#include "hil/world/machine.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// Depth at which a machine is refused: a rough floor and a rounded lip cause less.
inline constexpr double kDeepestStart_m = 0.02;

/// Throws fields::Refused naming `machine.position` when that is not on the terrain.
void require_on_terrain(const MachineConfiguration& configuration, const sim::HeightField& terrain);

/// Throws fields::Refused naming `machine` and why it slides or tips over, or the part that is
/// deepest inside something, and how deep. `machine` is the configured one, at its start. Throws as
/// load_mesh() for a shape's file.
void require_standing_free(const MachineConfiguration& configuration, const sim::Machine& machine,
                           const sim::Ground& ground);

}  // namespace rigwire::hil
