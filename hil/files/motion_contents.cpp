#include "hil/files/motion_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fields/check.h"

namespace rigwire::hil {

void refuse_motion(const std::string& file, const std::string& why) {
  throw fields::Refused("machine.motion.file", fmt::format("{}: {}", file, why));
}

Eigen::Isometry3d pose_of(const Eigen::Vector3d& p_W, const Eigen::Quaterniond& q) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = p_W;
  X.linear() = q.normalized().toRotationMatrix();
  return X;
}

MotionContents::MotionContents(const MotionSettings& settings, sim::Machine& model)
    : settings_(settings) {
  for (const std::string_view name : model.link_names()) {
    names_.emplace_back(name);
  }
  links_.resize(names_.size());
  std::vector<PortMember> fields;
  for (const sim::TruthField& field : model.truth_fields()) {
    fields.push_back({field.key, field.count, false});
  }
  truth = NumberTable(fields);
  const auto port = [](NumberTable& table, const auto& sample) {
    table = NumberTable(members_of(sample));
    table.rest.clear();
    append_numbers(sample, table.rest);
  };
  if (const sim::ValvePort* valve_port = model.valve_port()) {
    port(valves, valve_port->valve_sample(kStart));
  }
  if (const sim::VehiclePort* vehicle_port = model.vehicle_port()) {
    port(vehicle, vehicle_port->vehicle_sample(kStart));
  }
  if (const sim::PowerUnitPort* engine_port = model.power_unit_port()) {
    port(power_unit, engine_port->power_unit_sample(kStart));
  }
}

std::optional<std::size_t> MotionContents::link(std::string_view name) const {
  if (!settings_.frame.empty() && name == settings_.frame) {
    return 0;
  }
  const auto found = std::ranges::find(names_, name);
  return found == names_.end() || (found == names_.begin() && !settings_.frame.empty())
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - names_.begin()));
}

SimTime MotionContents::played(std::int64_t time_ns) const {
  return kStart + Duration{time_ns - *zero_ns_} - settings_.start + settings_.offset;
}

sim::RecordedNumbers MotionContents::numbers(const NumberTable& table) const {
  sim::RecordedNumbers result(table.steps);
  for (const auto& [time_ns, row] : table.rows) {
    result.add(played(time_ns), row);
  }
  return result;
}

namespace {

/// Each pose replaced by the value there of the parabola that fits its neighbours best, with
/// weights of a normal distribution: noise goes, and a motion of constant acceleration stays as it
/// is.
std::vector<Eigen::Isometry3d> smoothed(const std::vector<SimTime>& times,
                                        const std::vector<Eigen::Isometry3d>& poses,
                                        Duration deviation) {
  constexpr int kReach = 3;
  std::vector<Eigen::Vector4d> turned;
  for (const Eigen::Isometry3d& pose : poses) {
    Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    turned.push_back(!turned.empty() && q.dot(turned.back()) < 0.0 ? Eigen::Vector4d(-q) : q);
  }
  std::vector<Eigen::Isometry3d> result = poses;
  std::size_t first = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    while (times[i] - times[first] > kReach * deviation) {
      ++first;
    }
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 7> right = Eigen::Matrix<double, 3, 7>::Zero();
    for (std::size_t k = first; k < poses.size() && times[k] - times[i] <= kReach * deviation;
         ++k) {
      const double u = to_seconds(times[k] - times[i]) / to_seconds(deviation);
      const Eigen::Vector3d basis(1.0, u, u * u);
      const double weight = std::exp(-0.5 * u * u);
      Eigen::Matrix<double, 1, 7> y;
      y << poses[k].translation().transpose(), turned[k].transpose();
      normal += weight * basis * basis.transpose();
      right += weight * basis * y;
    }
    const auto solver = normal.ldlt();
    if (normal.determinant() <= 1e-9) {
      continue;  // too few neighbours for a parabola
    }
    const Eigen::Matrix<double, 3, 7> fit = solver.solve(right);
    result[i].translation() = fit.row(0).head<3>().transpose();
    const Eigen::Vector4d q = fit.row(0).tail<4>().transpose();
    result[i].linear() = Eigen::Quaterniond(q).normalized().toRotationMatrix();
  }
  return result;
}

}  // namespace

std::unique_ptr<sim::MotionTrack> MotionContents::track(std::size_t link) const {
  const auto& instants = links_[link];
  const bool with_rates = std::ranges::any_of(
      instants, [](const auto& entry) { return entry.second.X_WL && entry.second.rates; });
  std::vector<SimTime> times;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<sim::LinkMotion> motions;
  for (const auto& [time_ns, instant] : instants) {
    // Where any pose has recorded rates, only poses with rates are used; else the track derives
    // velocities and accelerations from the poses (sim/replay/motion_track.h).
    if (!instant.X_WL || (with_rates && !instant.rates)) {
      continue;
    }
    times.push_back(played(time_ns));
    poses.push_back(*instant.X_WL);
    if (with_rates) {
      motions.push_back(*instant.rates);
      motions.back().X_WL = *instant.X_WL;
    }
  }
  if (times.empty()) {
    return nullptr;
  }
  if (with_rates) {
    if (settings_.smoothing != Duration{0}) {
      refuse_motion(settings_.file,
                    "has its own accelerations, which smoothing does not change: leave "
                    "machine.motion.smoothing out");
    }
    return std::make_unique<sim::MotionTrack>(std::move(times), motions);
  }
  if (settings_.smoothing > Duration{0}) {
    poses = smoothed(times, poses, settings_.smoothing);
  }
  return std::make_unique<sim::MotionTrack>(std::move(times), poses);
}

sim::MachineRecord MotionContents::record() const {
  if (links_.front().empty()) {
    refuse_motion(
        settings_.file,
        fmt::format("no pose of the machine's first link \"{}\"; machine.motion.frame says what "
                    "the file calls it",
                    names_.front()));
  }
  if (!zero_ns_) {
    zero_ns_ = links_.front().begin()->first;
  }
  sim::MachineRecord record;
  for (std::size_t link = 0; link < links_.size(); ++link) {
    record.links.push_back(track(link));
  }
  if (played(links_.front().rbegin()->first) <= kStart) {
    refuse_motion(settings_.file, "ends before machine.motion.start");
  }
  record.truth = numbers(truth);
  record.valves = numbers(valves);
  record.vehicle = numbers(vehicle);
  record.power_unit = numbers(power_unit);
  return record;
}

}  // namespace rigwire::hil
