// State of a pair's contact points kept from one step to the next, and the rules that prevent it
// from adding energy.
//
// Points appear, vanish and merge as bodies turn. A point found again near its old place keeps its
// friction, with the directions turned with the normal; each place belongs to one point only. An
// overlap at a pair's first contact exerts no force: it counts as no overlap until the pair has
// left it, so that the body can move out but not farther in. The springs of a pair never store more
// at the start of a step than at the end of the previous one (plus a tenth of a millimetre's
// worth): where they would, all are softened in proportion.
//
// A step begins with a PairMemory::Step: remember() for each point, then start() for all; after the
// solve settling(), and settled() for each. Or part().
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "sim/contact/contact_point.h"
#include "sim/contact/manifold.h"

namespace rigwire::sim {

class PairMemory {
 public:
  /// A contact point of the last step.
  struct Place {
    Eigen::Vector3d p_L = Eigen::Vector3d::Zero();  ///< On the body's link.
    ContactFriction friction;
    double dent_m = 0.0;
    double sunk_m = 0.0;
    Eigen::Vector3d sunk_at_W = Eigen::Vector3d::Zero();  ///< Where the terrain is pressed in.
  };

  /// Returns whether there was contact in the last step; after Step::start(), in this one.
  [[nodiscard]] bool met() const { return met_; }
  /// Overlap without force.
  [[nodiscard]] double rest_m() const { return rest_m_; }
  /// Returns the energy in the springs at the end of the last step.
  [[nodiscard]] double spring_j() const { return spring_j_; }
  [[nodiscard]] double pressed_m() const { return pressed_m_; }
  /// Whether a point at p_L is within `reach_m` of one of the step before.
  [[nodiscard]] bool knows(const Eigen::Vector3d& p_L, double reach_m) const;

  /// Ends the contact.
  void part();

  /// The points of one step, while they are found.
  class Step {
   public:
    explicit Step(PairMemory& pair) : pair_(&pair) {}

    /// Takes the next point, at p_L of its link, whose normal is set. Gives it the friction of the
    /// nearest place of the last step, and the directions across. Returns that place; null: the
    /// point is new. Precondition: kManifoldPoints at most.
    const Place* remember(const Eigen::Vector3d& p_L, ContactPoint& point);
    /// Returns the place of the point taken last.
    [[nodiscard]] Place& latest() { return now_[taken_ - 1]; }
    /// Ends the collection: all are taken, as `points`. Overlap beyond the dents counts from the
    /// pair's rest_m(). Softens the springs, `stiffness_npm` each, so far that they add no energy.
    void start(std::span<ContactPoint> points, double stiffness_npm);

   private:
    PairMemory* pair_;
    std::array<Place, kManifoldPoints> now_;
    std::array<bool, kManifoldPoints> used_{};
    std::size_t taken_ = 0;
  };

  void settling() { spring_j_ = pressed_m_ = 0.0; }
  /// Stores point i, in the order of remember(), with its overlap `depth_m` at the end of the step.
  /// Returns the energy in its spring, J.
  double settled(std::size_t i, const ContactPoint& point, double depth_m);
  /// Returns point i; its state is that of the last step until settled().
  [[nodiscard]] const Place& place(std::size_t i) const { return places_[i]; }

 private:
  bool met_ = false;
  double rest_m_ = 0.0;
  double spring_j_ = 0.0;
  double pressed_m_ = 0.0;
  std::array<Place, kManifoldPoints> places_;
  std::size_t remembered_ = 0;
};

}  // namespace rigwire::sim
