// Three meetings with solid things, instant by instant, for pictures: a Unimog at 50 km/h into a
// trunk that does not give way, the bucket lowered onto a rock, a Unimog that rolls against a trunk
// which lies across its way.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace rigwire::bench {

/// Seen from the side: x along the way, z up, both in m.
using Outline = std::vector<Eigen::Vector2d>;

struct ContactTrace {
  struct Instant {
    double time_s = 0.0;
    double x_m = 0.0;  ///< Position of the machine's front, or of the bucket's tip.
    double z_m = 0.0;
    double force_n = 0.0;
    double deepest_m = 0.0;  ///< Overlap at this instant.
    double dent_m = 0.0;
    double pressed_m = 0.0;  ///< Compression of the tyre that is pressed in most.
  };
  std::string name;
  std::vector<Instant> instants;  ///< 1 ms apart.
  std::vector<Outline> obstacle;
  std::vector<Outline> at_touch;  ///< The machine at first contact ...
  std::vector<Outline> at_end;    ///< ... and at its farthest.
};

/// Level full, out of gear, the trunk 0.8 m thick and in the middle of the way.
[[nodiscard]] ContactTrace drive_into_trunk();
/// The boom's valve open by 0.5 downwards, a rock of 0.7 m radius under the tip, half in the
/// ground.
[[nodiscard]] ContactTrace lower_onto_rock();
/// Level full, out of gear, at 3 m/s; the trunk is 1.3 m thick, half of it in the ground, and so
/// higher than the wheels' axles.
[[nodiscard]] ContactTrace roll_at_fallen_trunk();

}  // namespace rigwire::bench
