#include "bench/carried_machine.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "hil/rig/rig.h"

namespace rigwire::bench {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

const sim::Track& closed_track(const hil::RigConfiguration& rig) {
  for (const sim::Track& track : rig.scene.description.tracks) {
    if (track.closed) {
      return track;
    }
  }
  throw std::invalid_argument("the scene has no closed track");
}

CarriedMachine::CarriedMachine(const hil::RigConfiguration& rig, double speed_mps)
    : line_(sim::track_line(closed_track(rig))),
      speed_mps_(speed_mps),
      built_(hil::build_machine_in_scene(rig)),
      X_start_(built_.machine->links().front().X_WL),
      bodies_(built_.machine->links().size()) {
  if (!(speed_mps > 0.0)) {
    throw std::invalid_argument(
        fmt::format("carried machine: found a speed of {} m/s, allowed > 0", speed_mps));
  }
  const Vector3d start_W = X_start_.translation();
  height_m_ = start_W.z() - built_.ground->height_m(start_W.x(), start_W.y());
}

Vector2d CarriedMachine::point(double along_m) const {
  const auto& points = line_.points_m;
  const double place = along_m / sim::kTrackSpacing_m;
  const auto i = static_cast<std::size_t>(place) % points.size();
  const double part = place - std::floor(place);
  return points[i] + part * (points[(i + 1) % points.size()] - points[i]);
}

void CarriedMachine::place(SimTime time, double along_m) {
  const Vector2d at = point(along_m);
  const Vector2d ahead = (point(along_m + 1.0) - at).normalized();
  ahead_W_ << ahead, 0.0;
  Isometry3d X_WB = Isometry3d::Identity();
  X_WB.linear() =
      Eigen::AngleAxisd(std::atan2(ahead.y(), ahead.x()), Vector3d::UnitZ()).toRotationMatrix();
  X_WB.translation() << at, built_.ground->height_m(at.x(), at.y()) + height_m_;
  moved_ = X_WB * X_start_.inverse();
  const auto links = built_.machine->links();
  for (std::size_t i = 0; i < links.size(); ++i) {
    bodies_[i].X_WB_start = bodies_[i].X_WB_end = moved_ * links[i].X_WL;
  }
  built_.scene->begin_slice(time, time + std::chrono::milliseconds{1}, X_WB.translation(), bodies_);
}

sim::LinkMotion CarriedMachine::motion(const hil::SensorMount& mount) const {
  sim::LinkMotion link;
  link.X_WL = moved_ * built_.machine->links()[mount.link].X_WL;
  link.v_WL_W = speed_mps_ * ahead_W_;
  return sim::at_mount(link, mount.X_LS);
}

}  // namespace rigwire::bench
