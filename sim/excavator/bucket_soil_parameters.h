// The bucket as a digging tool: its opening, what it holds, how the ground resists it.
#pragma once

#include "fields/rules.h"
#include "sim/ground/diggable_terrain.h"

namespace rigwire::sim {

/// In the bucket's frame B (origin in the bucket pin, x to the teeth, shell on the side of z > 0):
/// the opening is the plane z = 0 from rear_lip_m to the teeth, the shell half an ellipse below it
/// whose depth follows from the capacity. Every number is an estimate for an 18 t machine.
struct BucketSoilParameters {
  double width_m = 1.10;
  double rear_lip_m = 0.25;          ///< From the pin to the beginning of the opening.
  double struck_capacity_m3 = 0.55;  ///< Level with the opening.
  double heap_repose_rad = 0.6458;   ///< Steepest slope of the soil on top; sets the heap.
  double lip_angle_rad = 0.60;       ///< Between the floor at the teeth and the bucket's x.
  double edge_resistance_pa = 2e4;   ///< Resistance of the teeth: force over width times depth.
  double ramp_speed_mps = 2e-4;  ///< Speed of the edge from which the soil's resistance is full.
  double outflow_time_s = 0.35;  ///< Time in which all but 1/e of the soil that cannot stay leaves.
  double pour_radius_m = 0.40;   ///< Radius of the cone in which soil is deposited.
  double hard_stiffness_npm = 2e7;  ///< Teeth on rock.
  double hard_damping_nspm = 1e5;
  double hard_friction = 0.5;

  friend bool operator==(const BucketSoilParameters&, const BucketSoilParameters&) = default;
};

void visit(fields::Visitor& v, BucketSoilParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
/// `bucket_tip_m` is the distance from the pin to the teeth.
void validate(const BucketSoilParameters& parameters, double bucket_tip_m);

/// Everything that digging needs besides the machine.
struct DiggingParameters {
  BucketSoilParameters bucket;
  DiggableTerrainParameters terrain;

  friend bool operator==(const DiggingParameters&, const DiggingParameters&) = default;
};
void visit(fields::Visitor& v, DiggingParameters& p);

}  // namespace rigwire::sim
