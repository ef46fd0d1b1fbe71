// Contact between the machine's own bodies, for links that are not adjacent: the bucket against the
// boom, the house, the cab, the undercarriage; the stick against the last three; the boom against
// the last. The cylinders' end stops keep adjacent links apart.
//
// Points, laws and the state of a pair are those of sim/contact; each point has two links, and its
// velocity is that of the outer link relative to the inner one, so that the force acts on both.
//
// After construction nothing allocates. A step costs one comparison while nothing can be near; a
// pair is tested again once its bodies may have closed the distance last found.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/contact/pair_memory.h"

namespace rigwire::sim {

class OwnContact {
 public:
  static constexpr std::size_t kMostPoints = 24;

  /// Bodies on links that follow each other as their numbers do.
  explicit OwnContact(std::vector<ContactBody> bodies);

  /// Whether any pair can be within reach, no point of the machine having moved against another
  /// faster than `fastest_mps` for h seconds. Where not, neither begin() nor settle() is due.
  [[nodiscard]] bool near(double h, double fastest_mps) {
    step_m_ = h * fastest_mps;
    travelled_m_ += step_m_;
    return !points_.empty() || travelled_m_ > room_m_;
  }
  void begin(double h, std::span<const ContactLink> links);
  /// The points of the last begin() for a shorter step from the same poses.
  void shorten(double h);
  [[nodiscard]] std::span<ContactPoint> points() { return {points_.data(), points_.size()}; }
  /// The other link of a point; ContactPoint::link is the outer one.
  [[nodiscard]] std::size_t inner_link(std::size_t point) const {
    return bodies_[pairs_[pair_of_[point]].inner].link;
  }
  [[nodiscard]] bool touching() const { return !points_.empty(); }

  /// Ends the step: velocities along its three directions per point, in the order of points().
  template <class VelocitiesOf>
  void settle(double h, VelocitiesOf&& of) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      lost_j_ -= points_[i].settle(h, of(i));
    }
    finish(h);
  }

  /// Results of the last step: the sum of the points' normal forces, N, and the pair that pushes
  /// most.
  [[nodiscard]] double force_n() const { return force_n_; }
  [[nodiscard]] std::string_view outer() const { return outer_; }
  [[nodiscard]] std::string_view inner() const { return inner_; }
  [[nodiscard]] double deepest_ever_m() const { return deepest_ever_m_; }
  /// Work taken from the machine since the start, J, including the energy in the springs.
  [[nodiscard]] double lost_j() const { return lost_j_; }

 private:
  struct Pair {
    std::size_t outer = 0;
    std::size_t inner = 0;
    Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();  ///< In the outer link.
    double apart_m = -1e300;                            ///< They are no nearer than this.
    PairMemory memory;
  };

  /// The pair's gap, or a lower bound of one beyond reach.
  double meet(Pair& pair, double h, double reach_m, std::span<const ContactLink> links);
  void finish(double h);

  std::vector<ContactBody> bodies_;
  std::vector<Pair> pairs_;
  std::vector<ContactPoint> points_;
  std::vector<std::uint32_t> pair_of_;
  /// No point can have come farther since the last begin(), this step included.
  double travelled_m_ = std::numeric_limits<double>::infinity();
  double step_m_ = 0.0;  ///< In this step.
  double room_m_ = 0.0;  ///< The minimum gap of the last test, less the reach.
  double force_n_ = 0.0;
  double deepest_ever_m_ = 0.0;
  double lost_j_ = 0.0;
  std::string_view outer_;
  std::string_view inner_;
};

}  // namespace rigwire::sim
