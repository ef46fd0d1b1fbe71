// Whether a machine starts where it can stand: on the terrain, and with no part of it inside the
// ground, an obstacle or something that lies loose. What starts inside is thrown out by forces that
// no real machine meets.
//
// Looked at are the points that the machine itself names (sim/machine.h) and the surfaces of its
// shapes, boxes every 0.25 m and meshes at their vertices; against what lies loose boxes as a
// whole, since a crate may lie between the points. The shapes of links that stand on the ground, as
// wheels and drums do, are looked at against what lies loose alone. Objects of the scene that are
// not solid are not looked at.
#pragma once

#include "hil/world/machine.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// Depth from which on a machine is refused: what a rough floor and a rounded lip leave.
inline constexpr double kDeepestStart_m = 0.02;

/// Throws fields::Refused naming `machine.position` when that is not on the terrain.
void require_on_terrain(const MachineConfiguration& configuration, const sim::HeightField& terrain);

/// Throws fields::Refused naming `machine` and why it slides or tips over, or the part that is
/// deepest inside something, and how deep. `machine` is the configured one, at its start. Throws as
/// load_mesh() for a shape's file.
void require_standing_free(const MachineConfiguration& configuration, const sim::Machine& machine,
                           const sim::Ground& ground);

}  // namespace rigwire::hil
