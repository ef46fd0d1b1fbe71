// A machine's bodies against the solid things of its ground, step by step.
//
// The machine names its bodies once, each a convex shape on one of its links; the links of one
// machine do not meet each other (their end stops do). In every inner step:
//
//     begin()    poses at the step's start -> who is near -> points with their laws
//     points()   the solver puts acting() of each into its equations, asks changes() in each pass
//     settle()   the step's end: bristles, trunks that give way, the account of energy
//
// Broad phase: the ground's bins, asked with boxes grown by half a metre, and asked again when the
// fastest point of the machine can have come that far. While nothing is in there a step costs one
// comparison. Narrow phase: closest.h with the axis kept from the step before, and not before the
// body can have come as near as it was far; manifold.h.
//
// What a pair keeps from step to step, so that it adds no energy: pair_memory.h.
//
// What a body bears: crush_n of one point, rising with the depth of its dent (the A and B of crash
// reconstruction: Campbell, SAE 740565; CRASH3, DOT-HS-805-732, there per width of the front).
// Beyond it the body is bent in for good (dents.h), and what that took is lost. A point that comes
// into a contact where the body is not bent yet takes the dent with it, so that no spring is
// pressed further than the contact's others: ploughing on costs what friction does.
//
// Bodies meet the terrain by points of their surface against its heights, what rolls by its whole
// side (round_side.h): the deepest, and up to three more, as far apart as they are; those of the
// step before have the preference, so that what lies on more than four comes to rest. Together they
// bear the pressure under which the soil fails (soil_bearing.h) over the area in which the terrain
// cuts the body; beyond it the soil is pressed in for good where the point is, and not where it
// goes from there. What a body is in when first seen is pressed in already. What lies loose is met
// like obstacles (movers.h).
//
// What an obstacle bears: Obstacle::strength_nm, a moment about its foot. Where the sum of the
// points' horizontal forces times their heights would pass it, the obstacle gives way: it leans
// away from the push about its foot, at constant moment up to 0.1 rad, at one that falls to nothing
// at 0.4 rad; from there on it is down and met no more (contact.md 7; estimates). A tree that is
// down falls as a rod does that turns about its foot, until its trunk meets the ground. There it is
// met again, lying, as soon as nothing of the machine is in it or as near as a tenth of a metre.
//
// Deterministic; after construction begin(), settle() and all queries allocate nothing and throw
// nothing. Pairs and points beyond the room reserved are counted in dropped().
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
  double stiffness_npm = 1.5e6;  ///< Of one point; of a soft body's, of all.
  double damping_nspm = 3e4;
  double crush_n = 0.0;    ///< Force at which a point of contact bends it in; 0: never.
  double crush_npm = 0.0;  ///< By how much more, by the depth of the dent.
  bool rolls = false;      ///< A wheel: meets only what it cannot roll over, see step_below_m.
  bool soft = false;       ///< Rubber: how far it is in is how far it is pressed, no overlap.
  /// Points of its surface meet the terrain's heights: of boxes so far apart at most.
  bool meets_terrain = false;
  double spacing_m = 1.0;
  bool meets_obstacles = true;  ///< And what lies loose.
  /// A wheel cannot roll over what rises above the point so far below its middle, along its link's
  /// z (Ground::rises_above), balls excepted or not.
  double step_below_m = 0.0;
  bool rolls_over_balls = true;
  /// A drum, which is rigid, has this in place of the two above (ContactSet::climb).
  RollingClimb climb = {};
  /// Of its surface; of two that rub the smaller counts. Infinite: that of what it meets.
  double friction = std::numeric_limits<double>::infinity();
};

/// Of a body's point, one of so many of its pair, in a row with that of what it meets: `other_npm`
/// of itself, 0: rigid.
[[nodiscard]] ContactLaw law_in_a_row(const ContactBody& body, double other_npm, double friction,
                                      std::size_t points = 1);

/// Where a link is and how it moves.
struct ContactLink {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_WL_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();
  bool rests = false;  ///< Cannot move: meets only what does.

  /// Of a point of the link at p_W.
  [[nodiscard]] Eigen::Vector3d velocity_W(const Eigen::Vector3d& p_W) const {
    return v_WL_W + w_WL_W.cross(p_W - X_WL.translation());
  }
};

/// Who holds a machine up.
enum class Carried : std::uint8_t {
  by_wheels,  ///< What rolls is its own model's; the bodies that may meet the terrain.
  by_model,   ///< So is what it stands on: of the terrain bodies meet what is in their way, more
              ///< than 30 degrees against their link's z, 72 where they roll.
  by_contact  ///< Nobody else: what rolls meets what it could roll over, too, and the terrain.
};

class ContactSet {
 public:
  /// `links`: how many the bodies' indices may name. `ground` must outlive the set. `siblings`: the
  /// bodies are themselves what lies loose on the ground, in the same order; each meets those after
  /// it, and its solver has both sides. Null: a machine, that meets all of them and pushes them.
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
  /// From the next step on; at first by_wheels.
  void carry(Carried by);
  /// No point pushes any more: the machine was put elsewhere.
  void forget();
  /// Of a step in which nothing was near.
  void clear_points() {
    points_.clear();
    pair_of_.clear();
  }

  [[nodiscard]] const ContactReport& report() const { return report_; }
  [[nodiscard]] std::span<const ContactBody> bodies() const { return bodies_; }
  /// What a body that rolls climbs from now on.
  void climb(std::size_t body, const RollingClimb& climb) { bodies_[body].climb = climb; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::span<const Dent> dents() const { return dents_.dents(); }

  /// Those that have given way, in the order in which they did: for the scene.
  [[nodiscard]] std::span<const LeaningObstacle> leaning() const { return leaning_; }
  /// Something has come that was not there: who is near is asked anew.
  void look_anew() { travelled_m_ = kSlack_m; }
  /// An obstacle stands elsewhere than in the step before: whoever was far from it may be near.
  void moved(std::size_t obstacle);

 private:
  static constexpr double kSlack_m = 0.5;
  static constexpr double kReach_m = 0.02;
  static constexpr double kClear_m = 0.1;  ///< Of what has fallen before it is solid again.
  static constexpr std::uint32_t kTerrain = 0xFFFFFFFFU;  ///< As obstacle of a pair.

  struct Pair {
    std::uint32_t body = 0;
    std::uint32_t obstacle = 0;  ///< Of the ground's; beyond them, movers; kTerrain.
    bool idle = false;           ///< Both rest: all is as it was.
    /// They are no nearer than this, as long as the mover has not gone on from way_m.
    double apart_m = -1e300;
    double way_m = 0.0;  ///< Mover::way_m at the last look.
    /// Of the last look, met or not.
    Eigen::Vector3d axis_W = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();  ///< The same in the link.
    bool pushing = false;
    PairMemory memory;
    /// With what lies loose: in its springs, and no more than was put into them.
    double held_j = 0.0;
  };

  /// What a pair meets, in a form that all of them have.
  struct Met {
    double stiffness_npm = 0.0;  ///< Of itself; 0: rigid.
    double friction = 0.6;
    double strength_nm = 1e300;
    Eigen::Vector3d foot_W = Eigen::Vector3d::Zero();
    const Mover* mover = nullptr;
    const SoilBearing* soil = nullptr;  ///< Of terrain.
    double width_m = 0.0;               ///< Of the patch in which the terrain is met.
    double patch_m2 = 0.0;              ///< Each point's share of it.
  };
  struct Touch {
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
    double gap_m = 0.0;
    std::uint8_t soil = 0;
  };
  struct NearTouch {
    Touch touch;
    bool kept = false;  ///< Of the step before.
  };

  double move_others(double h, double fastest_mps);
  /// What lies loose has gone its way of the step before, which settle() could only predict from
  /// the machine's push: the pairs' springs and bristles are set to where it is.
  void follow_others();
  [[nodiscard]] std::span<const Mover> others() const;
  [[nodiscard]] const Mover* mover_of(std::uint32_t obstacle) const;
  void look(std::span<const ContactLink> links);
  void pair_up(std::uint32_t body, std::uint32_t obstacle);
  [[nodiscard]] double above_terrain_m(const ContactBody& body, std::size_t index,
                                       const ContactLink& link);
  /// Whether a body meets terrain with this normal.
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
  /// The point on the surface of its body as it was before it was bent.
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
  std::vector<Pair> others_;  ///< The list of before, while a new one is made.
  std::vector<std::uint32_t> found_;
  std::vector<NearTouch> touches_;    ///< Of a body and the terrain.
  std::vector<SidePlace> places_;     ///< Of a side that rolls.
  std::vector<SoilBearing> bearing_;  ///< Of each of the ground's soils.
  std::vector<ContactPoint> points_;
  std::vector<std::uint32_t> pair_of_;  ///< Of each point.
  std::vector<LeaningObstacle> leaning_;
  Dents dents_;
  std::size_t falling_ = 0;
  std::vector<ContactLink> at_;                          ///< Links of the last begin().
  std::vector<double> moved_m_;                          ///< Of each body since then, at most.
  std::vector<std::vector<Eigen::Vector3d>> surface_m_;  ///< Of bodies that meet the terrain.
  double look_after_m_ = 0.0;  ///< Way after which who is near is asked anew.
  double others_due_s_ = 0.0;  ///< The machine's last step, that the others have yet to go.
  double settled_s_ = 0.0;     ///< Length of the last step that was settled.
  double others_mps_ = 0.0;    ///< Of the fastest of them in its last step.
  double travelled_m_ = kSlack_m;
  double work_j_ = 0.0;
  double stored_j_ = 0.0;
  std::uint64_t dropped_ = 0;
  ContactReport report_;
};

}  // namespace rigwire::sim
