// One contact point between a machine's body and something solid, as a velocity solver sees it:
// three directions, in each a force linear in the velocity at the step's end, and limits.
//
// Along the normal, with overlap d (negative: a gap) and u the speed at which the bodies part,
//
//     F = k (d - h u) - c(d) u,    0 <= F <= greatest
//
// where `greatest` is the strength of the weaker of the two: beyond it the obstacle yields, the
// body is dented permanently, or the soil is pressed in. A dent counts as no overlap: spring and
// slider in series (Maxwell), so that the slider's travel is lost and the spring's deflection comes
// back. The law is implicit, so that no stiffness requires a smaller step. Gaps count, so that the
// force begins where the gap would close within the step (speculative). The damping c sets in over
// the first millimetre of overlap, so that the force is continuous in the depth. Tangentially there
// is a bristle in each of two directions (bristle.h), together within the friction cone. The solver
// puts acting() on both sides of its system and calls changes() with the velocities found until
// nothing changes (clamp last), then settle().
//
// Energy: the spring is stored, all else is lost; lost_j() never falls by more than the solver's
// order of step (docs/accuracy).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/contact/bristle.h"

namespace rigwire::sim {

/// Force law of one point of contact between two bodies.
struct ContactLaw {
  double stiffness_npm = 1e6;
  double damping_nspm = 1e4;
  double friction = 0.6;
  double greatest_n = 1e300;  ///< Force at which the weaker body yields.
  bool dents = false;         ///< The machine's body yields.
  bool sinks = false;         ///< The soil yields.
  /// Share of the overlap that is the machine's body's compression; the obstacle takes the rest.
  double body_share = 1.0;
  double bristle_npm = 5e5;  ///< Tangential stiffness.
};

/// Friction state that a point keeps from step to step.
struct ContactFriction {
  std::array<Bristle, 2> across;
  Eigen::Vector3d first_W = Eigen::Vector3d::Zero();  ///< Direction of across[0].
  std::array<double, 2> held_n{};
  bool sliding = false;
};

struct ContactPoint {
  std::size_t body = 0;      ///< Index of the machine's body (ContactSet).
  std::size_t link = 0;      ///< Index of the machine's link.
  std::size_t obstacle = 0;  ///< Index of the ground's obstacle, unless terrain or mover is set.
  bool terrain = false;
  /// Index of the loose body, if the point is on one (movers.h).
  std::optional<std::uint32_t> mover;
  /// Velocity of the other body without this push, and its velocity per impulse, along the three
  /// directions. 0 if the other body is fixed, or if both bodies are in the solver's system.
  std::array<double, 3> other_mps{};
  std::array<double, 3> other_1pkg{};
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_M = Eigen::Vector3d::Zero();  ///< p_W in the mover's frame.
  /// Unit vectors: normal, away from the obstacle, and two tangents.
  std::array<Eigen::Vector3d, 3> direction_W;
  double gap_m = 0.0;   ///< Gap beyond rest_m, dent_m and sunk_m.
  double rest_m = 0.0;  ///< Overlap without force: the pair already had it at first contact.
  double dent_m = 0.0;  ///< Depth to which the body is dented here.
  double sunk_m = 0.0;  ///< Depth to which the soil is pressed in here.
  ContactLaw law;
  ContactFriction friction;
  std::array<ImplicitForce, 3> force;
  std::array<double, 3> force_n{};  ///< Forces of the velocities found last.
  std::array<double, 3> start_mps{};
  std::array<double, 3> end_mps{};  ///< Relative to the other body.
  bool released = false;
  bool yielding = false;  ///< The normal force is at greatest_n.
  bool blocks = false;    ///< Holds up a machine whose model has no forces.
  int switches = 0;

  [[nodiscard]] BristleParameters bristle() const {
    return {law.bristle_npm, law.damping_nspm, 1.0};
  }

  /// Laws of a step of h seconds, from the velocities at its start along the three directions.
  void begin(double h, const std::array<double, 3>& start) {
    constexpr double kDampingFrom_m = 1e-3;
    const double depth = -gap_m;
    const double damping = law.damping_nspm * std::clamp(depth / kDampingFrom_m, 0.0, 1.0);
    force[0] = {law.stiffness_npm * depth, law.stiffness_npm * h + damping};
    for (std::size_t i = 0; i < 2; ++i) {
      force[i + 1] = friction.across[i].force(bristle(), h, 0.0);
    }
    // The motion of the other body is condensed into the law (movers.h).
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = 1.0 / (1.0 + h * force[i].gain * other_1pkg[i]);
      force[i] = {share * (force[i].offset + force[i].gain * other_mps[i]), share * force[i].gain};
    }
    start_mps = start;
    switches = 0;
    const double first = force[0].at(start[0]);
    released = first < 0.0;
    yielding = first > law.greatest_n;
    // First guess while sliding: last step's direction under this load.
    const double limit = law.friction * std::clamp(first, 0.0, law.greatest_n);
    const double held = std::hypot(friction.held_n[0], friction.held_n[1]);
    for (double& n : friction.held_n) {
      n *= held > 0.0 ? limit / held : 0.0;
    }
  }

  /// What holds along direction i in this pass.
  [[nodiscard]] ImplicitForce acting(std::size_t i) const {
    if (released) {
      return {};
    }
    if (i == 0) {
      return yielding ? ImplicitForce{law.greatest_n, 0.0} : force[0];
    }
    return friction.sliding ? ImplicitForce{friction.held_n[i - 1], 0.0} : force[i];
  }

  /// True when a force is at another limit than in the pass that found these velocities.
  [[nodiscard]] bool changes(const std::array<double, 3>& found) {
    constexpr int kSwitchesMax = 6;
    const double free = force[0].at(found[0]);
    bool changed = false;
    if (((free < 0.0) != released || (free > law.greatest_n) != yielding) &&
        switches < kSwitchesMax) {
      ++switches;
      released = free < 0.0;
      yielding = free > law.greatest_n;
      changed = true;
    }
    force_n[0] = released ? 0.0 : std::clamp(free, 0.0, law.greatest_n);
    if (released) {
      force_n[1] = force_n[2] = 0.0;
      return changed;
    }
    // Coulomb's cone on the trial force of both bristles, clamped last.
    const double limit = law.friction * force_n[0];
    const double first = force[1].at(found[1]);
    const double second = force[2].at(found[2]);
    const double trial = std::hypot(first, second);
    if (trial <= limit) {
      changed = changed || friction.sliding;
      friction.sliding = false;
      force_n[1] = first;
      force_n[2] = second;
      return changed;
    }
    const std::array<double, 2> held{limit * first / trial, limit * second / trial};
    if (!friction.sliding || std::abs(held[0] - friction.held_n[0]) > 1e-2 * limit ||
        std::abs(held[1] - friction.held_n[1]) > 1e-2 * limit) {
      friction.sliding = true;
      friction.held_n = held;
      changed = true;
    }
    force_n[1] = friction.held_n[0];
    force_n[2] = friction.held_n[1];
    return changed;
  }

  /// Ends the step with the velocities found. Returns the work that the point has done over the
  /// step on the machine and on the other body, J.
  double settle(double h, const std::array<double, 3>& found) {
    double work = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      force_n[i] = acting(i).at(found[i]);
      // The other has gone by the opposite impulse.
      const double other = other_mps[i] - h * other_1pkg[i] * force_n[i];
      end_mps[i] = found[i] - other;
      work += h * force_n[i] * 0.5 * (start_mps[i] + found[i] - other_mps[i] - other);
    }
    if (released) {
      friction = {.across = {}, .first_W = friction.first_W, .held_n = {}, .sliding = false};
      return work;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      friction.across[i].slide(bristle(), h, 0.0, end_mps[i + 1]);
    }
    yield_as_bent(friction.across, bristle(), law.friction * std::max(0.0, force_n[0]));
    return work;
  }

  /// Bends the bristles by `ahead_m` along the three directions: how far the other body has moved
  /// beyond the travel that settle() has assumed.
  void follow(const std::array<double, 3>& ahead_m) {
    if (released) {
      return;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      friction.across[i].slide(bristle(), 1.0, 0.0, -ahead_m[i + 1]);
    }
    yield_as_bent(friction.across, bristle(), law.friction * std::max(0.0, force_n[0]));
  }

  /// Ends the step at an overlap: what the spring does not bear is bent or pressed in for good.
  /// What is left.
  double bend(double depth_m) {
    const double excess = depth_m - law.greatest_n / law.stiffness_npm;
    if (!(law.dents || law.sinks) || !(excess > 0.0)) {
      return depth_m;
    }
    (law.dents ? dent_m : sunk_m) += excess;
    return depth_m - excess;
  }
  /// The part of the work of settle() that the normal force has done.
  [[nodiscard]] double normal_work_j(double h) const {
    return 0.5 * h * force_n[0] * (start_mps[0] - other_mps[0] + end_mps[0]);
  }
  /// The overlap that a step of h seconds has ended with, what was bent or pressed in taken off.
  [[nodiscard]] double left_m(double h) const {
    const double depth = -gap_m - h * end_mps[0];
    return law.dents || law.sinks ? std::min(depth, law.greatest_n / law.stiffness_npm) : depth;
  }
  /// In the spring, at an overlap.
  [[nodiscard]] double spring_j(double depth_m) const {
    const double overlap = std::min(std::max(0.0, depth_m), law.greatest_n / law.stiffness_npm);
    return 0.5 * law.stiffness_npm * overlap * overlap;
  }
  /// On the machine, as found.
  [[nodiscard]] Eigen::Vector3d sum_W() const {
    return force_n[0] * direction_W[0] + force_n[1] * direction_W[1] + force_n[2] * direction_W[2];
  }
  /// In the bristles.
  [[nodiscard]] double bent_j() const {
    double sum = 0.0;
    for (const Bristle& bristle_across : friction.across) {
      sum += 0.5 * law.bristle_npm * bristle_across.deflection() * bristle_across.deflection();
    }
    return sum;
  }
};

}  // namespace rigwire::sim
