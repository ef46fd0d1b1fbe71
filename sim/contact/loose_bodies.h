// Loose rocks and crates: rigid bodies that fall, slide, roll, stack and come to rest on terrain,
// on fixed obstacles and on each other, and that machines push and lift.
//
// Each step is linearly implicit, like a machine's own (contact_set.h, contact_point.h): one system
// gives the velocities of all bodies that touch each other, with contacts as one-sided springs with
// bristles, and the active set found by passes. Groups that do not touch are solved separately.
//
// Steps are at most a millisecond long, whatever the machine's step.
//
// Rest: a body whose points have been slower than 5 mm/s for half a second rests; it stays where it
// is, to the bit, until it is pushed by a machine, hit by another body that moves, or the terrain
// under it changes. Bodies at rest cost nothing.
//
// The sum of kinetic, potential and spring energy rises only by the work of machines: backward
// Euler loses energy, about h g v m in free fall.
//
// Soil brakes rolling bodies: while a body touches something, a torque of rolling_resistance times
// its weight at its maximum radius opposes its rotation, so that a nearly round rock comes to rest.
//
// Deterministic; advance() allocates nothing once as many bodies have moved together as ever will.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/contact/movers.h"
#include "sim/link_motion.h"

namespace rigwire::sim {

struct LooseBody {
  std::string name;
  ConvexShape shape;  ///< About the centre of mass, along the principal axes.
  double mass_kg = 100.0;
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Constant(10.0);
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  double friction = 0.6;  ///< Friction of its surface; the smaller of two surfaces counts.
  double rolling_resistance = 0.0;  ///< Coefficient.
  double stiffness_npm = 5e6;       ///< Stiffness of one point of contact.
};

class LooseBodies final : public Movers {
 public:
  /// `ground` must outlive it. Throws std::invalid_argument that names the body, what of it is out
  /// of range or not a number, what was found and what is allowed.
  LooseBodies(std::vector<LooseBody> bodies, const Ground& ground);

  [[nodiscard]] std::span<const Mover> movers() const override { return movers_; }
  [[nodiscard]] std::string_view name(std::size_t mover) const override {
    return bodies_[mover].name;
  }
  void push(std::size_t mover, const Eigen::Vector3d& p_W,
            const Eigen::Vector3d& impulse_W) override;
  double advance(double h) override;
  /// Before the start: lets all bodies come to rest, for `longest_s` at most. Their poses then are
  /// their initial poses.
  void settle(double longest_s);
  /// Checks again the bodies that rest within these bounds, seen from above.
  void ground_changed(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m);

  [[nodiscard]] std::size_t size() const { return bodies_.size(); }
  /// Motion of each body's frame; accelerations are 0.
  [[nodiscard]] LinkMotion motion(std::size_t body) const;
  /// Returns whether it is more than a centimetre from its initial position.
  [[nodiscard]] bool moved(std::size_t body) const;
  /// Returns the kinetic and potential energy of all bodies, measured from z = 0.
  [[nodiscard]] double energy_j() const;
  [[nodiscard]] const ContactReport& report() const { return contact_.report(); }

  double gravity_mps2 = 9.80665;

 private:
  struct State {
    Eigen::Vector3d impulse_W = Eigen::Vector3d::Zero();  ///< By machines, over one advance().
    Eigen::Vector3d turn_W = Eigen::Vector3d::Zero();
    double calm_s = 0.0;
    std::uint32_t island = 0;  ///< Lowest index among the bodies connected to it by contacts.
    std::uint32_t place = 0;   ///< In the island's system.
    bool touches = false;
  };

  double step(double h);
  void wake(std::size_t body);
  void place(std::size_t body);
  void be_free(std::size_t body);
  [[nodiscard]] std::uint32_t island_of(std::uint32_t body) const;
  void join_islands();
  [[nodiscard]] bool is_of(const ContactPoint& point, std::uint32_t island) const;
  void assemble(double h, std::uint32_t island, std::size_t size);
  template <typename Law>
  void assemble(double h, std::uint32_t island, std::size_t size, Law&& law_of);
  void solve(double h, std::uint32_t island);
  void find_mobilities(double h, std::uint32_t island, std::size_t size);
  [[nodiscard]] bool factorise(std::size_t size);
  void substitute(std::size_t size);
  [[nodiscard]] std::array<double, 3> along(const ContactPoint& point) const;

  std::vector<LooseBody> bodies_;
  std::vector<Mover> movers_;
  std::vector<State> states_;
  std::vector<Eigen::Vector3d> start_m_;
  std::vector<ContactLink> links_;
  ContactSet contact_;
  /// Velocities along all six directions of each body: at the start of the step, and as found.
  std::vector<std::array<double, 6>> from_;
  std::vector<std::array<double, 6>> found_;
  std::vector<std::uint32_t> members_;  ///< Bodies of the island that is being solved.
  std::vector<double> matrix_;          ///< Row by row, its lower half.
  std::vector<double> right_;
  std::size_t awake_ = 0;
  double span_s_ = 0.0;  ///< Length of the current advance().
};

}  // namespace rigwire::sim
