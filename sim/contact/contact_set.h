// A machine's bodies against the solid things of its ground, step by step.
//
// The machine registers its bodies once, each a convex shape on one of its links. Links of one
// machine do not collide with each other; their end stops limit them. In every inner step:
//
//     begin()    poses at the step's start -> near bodies -> points with their laws
//     points()   the solver puts acting() of each into its equations, calls changes() in each pass
//     settle()   the step's end: bristles, yielding trunks, the energy balance
//
// Broad phase: the ground's bins are queried with boxes grown by half a metre, and again when the
// machine's fastest point may have moved that far. While they are empty a step costs one
// comparison. Narrow phase: closest.h with the axis kept from the previous step, and only once the
// body may have closed the distance last found; then manifold.h.
//
// The state that a pair keeps from step to step adds no energy: pair_memory.h.
//
// Strength of a body: crush_n per point, rising with the depth of its dent (the A and B of crash
// reconstruction: Campbell, SAE 740565; CRASH3, DOT-HS-805-732, there per width of the front).
// Beyond it the body is dented permanently (dents.h), and the work of denting is lost. A point that
// enters a contact where the body is not dented yet takes over the contact's dent, so that no
// spring is compressed further than the contact's others: ploughing on then costs only friction.
//
// Bodies contact the terrain with points of their surface against its heights, rolling bodies with
// their whole side (round_side.h): the deepest point and up to three more, as far apart as
// possible; those of the previous step have preference, so that a body lying on more than four
// comes to rest. Together they bear the pressure at which the soil fails (soil_bearing.h) over the
// area in which the terrain cuts the body; beyond it the soil is pressed in permanently at the
// point's place, and not where the point moves from there. Terrain that a body overlaps when first
// seen is pressed in already. Loose bodies are contacted like obstacles (movers.h).
//
// Strength of an obstacle: Obstacle::strength_nm, a moment about its foot. Where the sum of the
// points' horizontal forces times their heights would exceed it, the obstacle yields: it leans away
// from the push about its foot, at constant moment up to 0.1 rad, then at one that falls to zero at
// 0.4 rad; from there on it is down and has no contact (estimates). A falling tree
// turns about its foot like a rod until its trunk hits the ground. It is solid again, lying, as
// soon as no part of the machine is within a tenth of a metre of it.
//
// Deterministic; after construction begin(), settle() and all queries allocate nothing and throw
// nothing. dropped() counts pairs and points beyond the reserved capacity.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/contact/contact_point.h"
#include "sim/contact/contact_report.h"
#include "sim/contact/convex_shape.h"
#include "sim/contact/dents.h"
#include "sim/contact/movers.h"
#include "sim/contact/pair_memory.h"
#include "sim/contact/rolling_climb.h"
#include "sim/contact/round_side.h"
#include "sim/contact/soil_bearing.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {

inline constexpr std::size_t kMostContactPoints = 48;

/// One convex body of a machine.
struct ContactBody {
  std::string name;  ///< "bucket back".
  std::size_t link = 0;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  ConvexShape shape;
  /// Stiffness of one point; of a soft body, of all its points together.
  double stiffness_npm = 1.5e6;
  double damping_nspm = 3e4;
  double crush_n = 0.0;    ///< Force at which a point of contact is dented; 0: never.
  double crush_npm = 0.0;  ///< Rise of crush_n with the depth of the dent.
  bool rolls = false;      ///< A wheel: contacts only what it cannot roll over, see step_below_m.
  bool soft = false;       ///< Rubber: its overlap counts as compression.
  /// Contacts the terrain with points of its surface. Those of a box are spacing_m apart at most.
  bool meets_terrain = false;
  double spacing_m = 1.0;
  bool meets_obstacles = true;  ///< Contacts obstacles and loose bodies.
  /// Distance from the wheel's middle down along its link's z to the maximum height that it rolls
  /// over (Ground::rises_above); with rolls_over_balls, it rolls over balls of any height.
  double step_below_m = 0.0;
  bool rolls_over_balls = true;
  /// Replaces the two above for a drum, which is rigid (ContactSet::climb).
  RollingClimb climb = {};
  /// Friction of its surface; the smaller friction of the two surfaces counts. Infinite: the other
  /// surface's friction.
  double friction = std::numeric_limits<double>::infinity();
};

/// Returns the law of one of a pair's `points`: the body's stiffness in series with the other
/// body's `other_npm` (0: rigid).
[[nodiscard]] ContactLaw law_in_a_row(const ContactBody& body, double other_npm, double friction,
                                      std::size_t points = 1);

/// Pose and velocities of a link.
struct ContactLink {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_WL_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();
  bool rests = false;  ///< Cannot move: contacts only moving bodies.

  /// Returns the velocity of the link's point at p_W.
  [[nodiscard]] Eigen::Vector3d velocity_W(const Eigen::Vector3d& p_W) const {
    return v_WL_W + w_WL_W.cross(p_W - X_WL.translation());
  }
};

/// What supports a machine.
enum class Carried : std::uint8_t {
  /// The machine's model handles the wheels; bodies with meets_terrain contact all terrain.
  by_wheels,
  /// The model handles the ground below, too. Bodies contact only terrain in their way: steeper
  /// than 30 degrees against their link's z, 72 where they roll.
  by_model,
  /// Contact alone: rolling bodies also contact the terrain and what they could roll over.
  by_contact
};

class ContactSet {
 public:
  /// `links`: how many the bodies' indices may name. `ground` must outlive the set. `siblings`: the
  /// bodies are themselves the loose bodies on the ground, in the same order; each contacts those
  /// after it, and its solver has both sides. Null: a machine, which contacts and pushes all loose
  /// bodies.
  ContactSet(std::vector<ContactBody> bodies, std::size_t links, const Ground& ground,
             const Movers* siblings = nullptr);

  /// Whether anything solid can be within reach of a machine no point of which has moved faster
  /// than `fastest_mps` for h seconds. Where not, neither begin() nor settle() is due.
  /// Call it once in each step: what lies loose on the ground goes the step of before, whose pushes
  /// it has by now.
  [[nodiscard]] bool near(double h, double fastest_mps) {
    const double others_mps = move_others(h, fastest_mps);
    travelled_m_ += h * fastest_mps;
    return !pairs_.empty() || falling_ > 0 ||
           travelled_m_ > look_after_m_ - h * (fastest_mps + others_mps);
  }
  /// Precondition: near() said so in this step; links as many as at construction.
  void begin(double h, std::span<const ContactLink> links);

  /// The points of the last begin() for a shorter step of h seconds from the same poses.
  void shorten(double h);

  [[nodiscard]] std::span<ContactPoint> points() { return {points_.data(), points_.size()}; }
  [[nodiscard]] std::span<const ContactPoint> points() const {
    return {points_.data(), points_.size()};
  }
  /// Any point whose gap may close within this step.
  [[nodiscard]] bool touching() const { return !points_.empty(); }

  /// Ends the step: velocities along its three directions per point, in the order of points().
  template <class VelocitiesOf>
  void settle(double h, VelocitiesOf&& of) {
    double work = 0.0;
    for (ContactPoint& point : points_) {
      work += point.settle(h, of(point));
    }
    finish(h, work);
  }
  /// Sets the support from the next step on; by_wheels at the start.
  void carry(Carried by);
  /// Clears all forces: the machine was placed elsewhere.
  void forget();
  /// Removes the points, in a step with nothing near.
  void clear_points() {
    points_.clear();
    pair_of_.clear();
  }

  [[nodiscard]] const ContactReport& report() const { return report_; }
  [[nodiscard]] std::span<const ContactBody> bodies() const { return bodies_; }
  /// Sets what a rolling body can climb from now on.
  void climb(std::size_t body, const RollingClimb& climb) { bodies_[body].climb = climb; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::span<const Dent> dents() const { return dents_.dents(); }

  /// Returns the obstacles that have given way, in that order, for the scene.
  [[nodiscard]] std::span<const LeaningObstacle> leaning() const { return leaning_; }
  /// Repeats the search for near bodies: something was added.
  void look_anew() { travelled_m_ = kSlack_m; }
  /// Reports that an obstacle has moved since the last step, so that distant bodies may be near
  /// now.
  void moved(std::size_t obstacle);

 private:
  static constexpr double kSlack_m = 0.5;
  static constexpr double kReach_m = 0.02;
  /// Distance of the machine from a fallen obstacle that makes it solid again.
  static constexpr double kClear_m = 0.1;
  /// Obstacle index of the terrain in a pair.
  static constexpr std::uint32_t kTerrain = 0xFFFFFFFFU;

  struct Pair {
    std::uint32_t body = 0;
    std::uint32_t obstacle = 0;  ///< Index of an obstacle, then of movers after them; or kTerrain.
    bool idle = false;           ///< Both are at rest: nothing has changed.
    /// Lower bound of their distance while the mover's way is still way_m.
    double apart_m = -1e300;
    double way_m = 0.0;  ///< Mover::way_m at the last check.
    /// Separation axis found last, with or without contact.
    Eigen::Vector3d axis_W = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();  ///< axis_W in the link's frame.
    bool pushing = false;
    PairMemory memory;
    /// Energy in its springs with a loose body, J; at most the work that was put into them.
    double held_j = 0.0;
  };

  /// Properties of what a pair contacts, the same for all kinds.
  struct Met {
    double stiffness_npm = 0.0;  ///< Its own stiffness; 0: rigid.
    double friction = 0.6;
    double strength_nm = 1e300;
    Eigen::Vector3d foot_W = Eigen::Vector3d::Zero();
    const Mover* mover = nullptr;
    const SoilBearing* soil = nullptr;  ///< Set for terrain.
    double width_m = 0.0;               ///< Width of the patch in contact with terrain.
    double patch_m2 = 0.0;              ///< Area of that patch per point.
  };
  struct Touch {
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
    double gap_m = 0.0;
    std::uint8_t soil = 0;
  };
  struct NearTouch {
    Touch touch;
    bool kept = false;  ///< Was a point in the last step, too.
  };

  double move_others(double h, double fastest_mps);
  /// Adjusts springs and bristles of the pairs to the real motion of loose bodies in the last step,
  /// which settle() could only predict from the machine's push.
  void follow_others();
  [[nodiscard]] std::span<const Mover> others() const;
  [[nodiscard]] const Mover* mover_of(std::uint32_t obstacle) const;
  void look(std::span<const ContactLink> links);
  void pair_up(std::uint32_t body, std::uint32_t obstacle);
  [[nodiscard]] double above_terrain_m(const ContactBody& body, std::size_t index,
                                       const ContactLink& link);
  /// Returns whether a body contacts terrain with this normal.
  [[nodiscard]] bool meets(const ContactBody& body, const ContactLink& link,
                           const Eigen::Vector3d& normal_W, std::uint8_t soil) const;
  [[nodiscard]] bool rolls_over(const ContactBody& body, std::size_t obstacle,
                                const ContactLink& link) const;
  void meet(Pair& pair, double h, std::span<const ContactLink> links);
  void meet_terrain(Pair& pair, double h, std::span<const ContactLink> links);
  void add_points(Pair& pair, double h, const ContactLink& link, std::span<const Touch> touches,
                  const Met& met);
  [[nodiscard]] Eigen::Isometry3d pose_of(std::size_t obstacle) const;
  [[nodiscard]] double strength_of(std::size_t obstacle) const;
  /// Returns the point on the surface of its undented body.
  [[nodiscard]] Eigen::Vector3d surface_L(const ContactPoint& point) const;
  LeaningObstacle* lean_of(std::size_t obstacle);
  void sink(ContactPoint& point, const PairMemory::Place* before, const Met& met, double pressed_m,
            PairMemory::Place& now) const;
  void finish(double h, double work_j);
  void give_way(double h);
  void fall(double h);
  void lie(LeaningObstacle& lean);

  const Ground* ground_;
  const Movers* siblings_;
  Carried carried_ = Carried::by_wheels;
  std::vector<ContactBody> bodies_;
  std::size_t links_;
  std::vector<Pair> pairs_;
  std::vector<Pair> others_;  ///< Previous pairs, while new ones are collected.
  std::vector<std::uint32_t> found_;
  std::vector<NearTouch> touches_;    ///< Points of a body near the terrain.
  std::vector<SidePlace> places_;     ///< Places on the side of a rolling body.
  std::vector<SoilBearing> bearing_;  ///< One for each of the ground's soils.
  std::vector<ContactPoint> points_;
  std::vector<std::uint32_t> pair_of_;  ///< Pair of each point.
  std::vector<LeaningObstacle> leaning_;
  Dents dents_;
  std::size_t falling_ = 0;
  std::vector<ContactLink> at_;  ///< Links of the last begin().
  std::vector<double> moved_m_;  ///< Upper bound of each body's way since the last begin().
  /// Surface points of bodies that contact the terrain.
  std::vector<std::vector<Eigen::Vector3d>> surface_m_;
  /// Way after which near bodies are searched again.
  double look_after_m_ = 0.0;
  /// The machine's last step, which the loose bodies have yet to make.
  double others_due_s_ = 0.0;
  double settled_s_ = 0.0;   ///< Length of the last step that was settled.
  double others_mps_ = 0.0;  ///< Speed of the fastest loose body in its last step.
  double travelled_m_ = kSlack_m;
  double work_j_ = 0.0;
  double stored_j_ = 0.0;
  std::uint64_t dropped_ = 0;
  ContactReport report_;
};

}  // namespace rigwire::sim
