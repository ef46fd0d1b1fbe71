// A bucket in diggable terrain: what the ground does to it, what it takes, carries and drops.
//
// For each step of the arm: load() says which forces act over the step, the arm moves, advance()
// moves the soil by the way that the bucket went.
//
// Forces. The lip is the straight edge through the teeth. Forward (where the opening looks) the
// soil resists with the force P of the fundamental earthmoving equation
// (sim/ground/earthmoving.h) at the lip's depth below the surface ahead of it, with the bucket's
// content as surcharge, plus the teeth's own resistance; downward with the teeth's; sideways with
// P of the side plates. Each acts against the lip's speed along its direction only, between 0 and
// its limit: it rises over ramp_speed_mps, is zero at rest and when the lip is withdrawn, and never
// pushes. Rock under the soil and hard ground push the lip up (penalty, never pull), with friction;
// obstacles are the excavator's own matter (sim/contact). All enter the arm's implicit solve and
// are clamped after it (bucket_load.h); directions and limits depend on the pose alone, so that
// nothing chatters.
//
// Soil. What the lip cuts goes into the bucket; what passes the heaped capacity is pushed ahead.
// What the bucket cannot hold at its pitch runs out over its lower lip, all of it within a few
// times outflow_time_s; while the lip is in the ground the soil ahead keeps it in. Soil falls
// straight down and lands at once, on the terrain, or into what the caller's FallObstacle knows (a
// truck's box): then it is counted as dumped elsewhere. Volumes are whole units of the terrain:
// terrain + bucket + elsewhere never changes.
//
// Deterministic; nothing after construction allocates or throws. Limits: docs/machines/digging.md.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/excavator/bucket_load.h"
#include "sim/excavator/bucket_soil_parameters.h"
#include "sim/link_motion.h"

namespace rigwire::sim {

/// How much soil a bucket can hold at each pitch. Soil stays in the shell as far as it lies below a
/// slope at its angle of repose that rises from either lip, and is carried by the shell rather than
/// hanging over the opening. The share is worked out once, for each degree of pitch, by counting
/// points of the bucket's cross-section (within 1 % of the struck capacity), and interpolated.
class BucketCapacity {
 public:
  BucketCapacity(const BucketSoilParameters& parameters, double bucket_tip_m);

  /// Opening level and up: the struck capacity plus a roof at the angle of repose.
  [[nodiscard]] double heaped_m3() const { return heaped_m3_; }
  [[nodiscard]] double opening_length_m() const { return opening_m_; }
  /// Depth of the shell below the opening.
  [[nodiscard]] double depth_m() const { return depth_m_; }

  /// `pitch_rad`: of the bucket's x above the horizontal, along the arm; +-pi holds most. Any
  /// angle.
  [[nodiscard]] double held_m3(double pitch_rad) const;

 private:
  [[nodiscard]] double counted_m3(const BucketSoilParameters& parameters, double pitch_rad) const;

  double opening_m_;
  double depth_m_;
  double heaped_m3_;
  std::vector<double> held_m3_;  ///< From -180 degrees on, one for each.
};

/// Something over the terrain that falling soil ends in.
class FallObstacle {
 public:
  virtual ~FallObstacle() = default;
  /// Whether soil that falls from that point ends above the terrain's height there.
  [[nodiscard]] virtual bool catches(const Eigen::Vector3d& from_W, double terrain_m) const = 0;
};

/// The ground's forces over one step: `force_W` at `point_W`, with the resistances.
struct BucketGroundLoad {
  Eigen::Vector3d force_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  std::array<TipResistance, kTipResistances> resistances;
  std::size_t count = 0;
};

class BucketSoil {
 public:
  /// `terrain` must outlive it. Throws std::invalid_argument as validate does.
  BucketSoil(const BucketSoilParameters& parameters, double bucket_tip_m, double gravity_mps2,
             DiggableTerrain& terrain, const LinkMotion& bucket);

  /// Forces over the next step of h seconds, from the bucket's motion at its start.
  [[nodiscard]] BucketGroundLoad load(double h, const LinkMotion& bucket);

  /// The bucket has moved there within h seconds. A motion that is not finite changes nothing.
  void advance(double h, const LinkMotion& bucket);
  /// It is there now, and was nowhere in between.
  void place(const LinkMotion& bucket);

  /// Asked where falling soil ends; null: always on the terrain. Must outlive the bucket.
  void set_fall_obstacle(const FallObstacle* obstacle) { obstacle_ = obstacle; }

  /// Adds that much soil (m3, kg) to the bucket without digging it: for tests and set-up. It is
  /// subtracted from `elsewhere`.
  void fill(double volume_m3, double mass_kg);

  [[nodiscard]] double volume_m3() const;
  [[nodiscard]] double mass_kg() const { return mass_kg_; }
  /// Soil in the bucket and elsewhere, in the terrain's units.
  [[nodiscard]] std::int64_t units() const { return units_; }
  [[nodiscard]] std::int64_t elsewhere_units() const { return elsewhere_; }
  [[nodiscard]] double elsewhere_m3() const;

  [[nodiscard]] const BucketCapacity& capacity() const { return capacity_; }
  /// Depth of the lip below the surface ahead, mean over its width; 0 above ground.
  [[nodiscard]] double depth_m() const { return depth_m_; }
  /// Maximum force of the soil against the lip's forward motion, at the last load().
  [[nodiscard]] double resistance_limit_n() const { return limit_n_; }

 private:
  struct ForceRange {
    double least_n = 0.0;
    double greatest_n = 0.0;
  };
  struct Lip {
    CuttingEdge edge;
    Eigen::Vector3d middle_W;
    Eigen::Vector3d left_W;     ///< Horizontal unit along the edge.
    Eigen::Vector3d forward_W;  ///< Horizontal unit vector, out of the opening.
    Eigen::Vector3d blade_W;    ///< Unit, along the floor out over the teeth.
    Eigen::Vector3d rear_W;     ///< Middle of the rear lip.
  };

  [[nodiscard]] Lip lip_of(const Eigen::Isometry3d& X_WB) const;
  [[nodiscard]] double depth_ahead_m(const Lip& lip) const;
  /// Depth of the deeper corner below the terrain's floor (rock, hard ground); 0 above it.
  [[nodiscard]] double hard_depth_m(const Lip& lip) const;
  [[nodiscard]] double cutting_limit_n(const Lip& lip, const SoilParameters& soil) const;
  [[nodiscard]] double side_limit_n(const SoilParameters& soil) const;
  [[nodiscard]] double edge_limit_n() const {
    return parameters_.edge_resistance_pa * depth_m_ * parameters_.width_m;
  }
  /// Adds a force along the direction at the lip that falls with the speed along it and stays
  /// within the range.
  void resist(const Eigen::Vector3d& direction_W, ForceRange range, double at_rest_n,
              double gain_nspm, BucketGroundLoad& load) const;
  /// Takes units out of the bucket.
  void release(std::int64_t units);
  void spill(const Lip& lip, std::int64_t units);
  void drop(const Eigen::Vector3d& from_W, std::int64_t units);

  BucketSoilParameters parameters_;
  BucketCapacity capacity_;
  double tip_m_;
  double gravity_mps2_;
  DiggableTerrain& terrain_;
  const FallObstacle* obstacle_ = nullptr;
  std::int64_t heaped_units_;

  Lip lip_;
  std::int64_t units_ = 0;
  double mass_kg_ = 0.0;
  std::int64_t elsewhere_ = 0;
  double depth_m_ = 0.0;
  double limit_n_ = 0.0;
};

}  // namespace rigwire::sim
