#include "hil/simulated_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "hil/cpu_time.h"

namespace rigwire::hil {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::array kJointNames{"swing", "boom", "stick", "bucket"};

std::size_t index(sim::Link link) {
  return static_cast<std::size_t>(link);
}

}  // namespace

template <class Sensor>
void SimulatedWorld::Mounted<Sensor>::replan(const SamplePlan& changed, SimTime frontier) {
  plan = changed;
  // At the very start the instant 0 itself is still open.
  next = frontier == kStart ? plan.first : plan.next_after(frontier);
}

SimulatedWorld::SimulatedWorld(const WorldSettings& settings,
                               std::unique_ptr<sim::Excavator> machine,
                               std::unique_ptr<sim::Scene> scene, const sim::LocalFrame& frame)
    : settings_(settings), machine_(std::move(machine)), scene_(std::move(scene)), frame_(frame) {
  if (settings.step <= Duration{0} || settings.slice < settings.step ||
      settings.slice % settings.step != Duration{0}) {
    throw std::invalid_argument(
        fmt::format("physics slice {} ns is not a whole multiple of the step {} ns",
                    settings.slice.count(), settings.step.count()));
  }
  if (scene_->body_count() != sim::kLinks) {
    throw std::invalid_argument(fmt::format("the scene has {} moving bodies, the machine {} links",
                                            scene_->body_count(), sim::kLinks));
  }
  after_ = motions();
  bodies_.resize(sim::kLinks);
  for (const char* joint : kJointNames) {
    state_quantities_.push_back({joint, "deg"});
  }
  state_quantities_.push_back({"tip height", "m"});
  state_quantities_.push_back({"supply", "bar"});
}

void SimulatedWorld::add_gnss(DeviceIndex device, const SensorMount& mount,
                              sim::GnssSensor sensor) {
  gnss_.push_back({device, mount, std::move(sensor), {}, kNever});
}

void SimulatedWorld::add_imu(DeviceIndex device, const SensorMount& mount, sim::ImuSensor sensor) {
  imu_.push_back({device, mount, std::move(sensor), {}, kNever});
}

void SimulatedWorld::add_lidar(DeviceIndex device, const SensorMount& mount,
                               std::unique_ptr<sim::SpinningLidar> sensor) {
  lidars_.push_back({device, mount, std::move(sensor), {}, kNever});
}

void SimulatedWorld::add_valves(DeviceIndex device) {
  valves_.push_back({device, {}, {}, {}, kNever});
}

void SimulatedWorld::set_truth_tap(std::unique_ptr<TruthTap> tap, Duration period) {
  tap_ = std::move(tap);
  tap_period_ = period;
  next_tap_ = frontier_ + period;
}

SimulatedWorld::Motions SimulatedWorld::motions() const {
  Motions motions;
  for (std::size_t i = 0; i < sim::kLinks; ++i) {
    motions[i] = machine_->link(static_cast<sim::Link>(i));
  }
  return motions;
}

sim::LinkMotion SimulatedWorld::motion_at(const SensorMount& mount, SimTime t0, SimTime t1,
                                          SimTime time) const {
  const std::size_t link = index(mount.link);
  return sim::at_mount(sim::LinkMotionInterpolation(t0, before_[link], t1, after_[link])(time),
                       mount.X_LS);
}

void SimulatedWorld::apply(const TruthRequests& requests) {
  const auto replan = [&](auto& sensors, const Addressed<SamplePlan>& request) {
    for (auto& sensor : sensors) {
      if (sensor.device == request.device) {
        sensor.replan(request.content, frontier_);
      }
    }
  };
  for (const auto& request : requests.plans) {
    replan(gnss_, request);
    replan(imu_, request);
    replan(valves_, request);
  }
  for (const auto& rate : requests.rotor_rates) {
    for (auto& lidar : lidars_) {
      if (lidar.device == rate.device) {
        lidar.sensor->set_rotor_rate(frontier_, rate.content);
      }
    }
  }
  for (const auto& command : requests.commands) {
    machine_->command(command.content);
  }
}

std::optional<std::string> SimulatedWorld::advance(const TruthRequests& requests,
                                                   SampleBatch& batch) {
  batch.clear();
  batch.from = frontier_;
  batch.until = frontier_ + settings_.slice;
  apply(requests);
  slice_start_ = after_;
  for (SimTime t0 = frontier_; t0 < batch.until; t0 += settings_.step) {
    if (auto fault = step_machine()) {
      return fault;
    }
    sample_step(t0, t0 + settings_.step, batch);
  }
  cast_slice(batch);
  frontier_ = batch.until;
  read_state(batch);
  return std::nullopt;
}

std::optional<std::string> SimulatedWorld::step_machine() {
  const StageTimer timer(stages_.physics_s);
  before_ = after_;
  machine_->step(settings_.step);
  if (const auto& fault = machine_->non_finite()) {
    return fmt::format("{} of the {} joint is not a finite number at {:.4f} s", fault->quantity,
                       kJointNames[static_cast<std::size_t>(fault->joint)],
                       to_seconds(fault->time));
  }
  after_ = motions();
  return std::nullopt;
}

void SimulatedWorld::sample_step(SimTime t0, SimTime t1, SampleBatch& batch) {
  const StageTimer timer(stages_.sensors_s);
  for (auto& imu : imu_) {
    for (; imu.next <= t1; imu.next = imu.plan.next_after(imu.next)) {
      const auto motion = motion_at(imu.mount, t0, t1, imu.next);
      batch.imu.push_back(
          {imu.device, imu.sensor.sample(imu.next, motion, settings_.gravity_mps2)});
    }
  }
  for (auto& valves : valves_) {
    for (; valves.next <= t1; valves.next = valves.plan.next_after(valves.next)) {
      batch.valves.push_back({valves.device, machine_->valve_sample(valves.next)});
    }
  }
  for (auto& gnss : gnss_) {
    for (; gnss.next <= t1; gnss.next = gnss.plan.next_after(gnss.next)) {
      due_epochs_.push_back({&gnss, gnss.next, motion_at(gnss.mount, t0, t1, gnss.next)});
    }
  }
  for (; next_tap_ <= t1; next_tap_ += tap_period_) {
    record_truth(t0, t1, next_tap_);
  }
}

void SimulatedWorld::cast_slice(SampleBatch& batch) {
  const SimTime t0 = batch.from;
  const SimTime t1 = batch.until;
  {
    const StageTimer timer(stages_.ray_casting_s);
    for (std::size_t i = 0; i < sim::kLinks; ++i) {
      bodies_[i] = {slice_start_[i].X_WL, after_[i].X_WL};
    }
    const auto& focus = after_[index(sim::Link::upper)].X_WL;
    scene_->begin_slice(t0, t1, focus.translation(), bodies_);
    batch.lidar.resize(lidars_.size());
    for (std::size_t i = 0; i < lidars_.size(); ++i) {
      auto& lidar = lidars_[i];
      const std::size_t link = index(lidar.mount.link);
      batch.lidar[i].device = lidar.device;
      lidar.sensor->cast(*scene_, t0, t1, sim::at_mount(slice_start_[link], lidar.mount.X_LS),
                         sim::at_mount(after_[link], lidar.mount.X_LS), batch.lidar[i].firings);
    }
  }
  const StageTimer timer(stages_.sensors_s);
  for (const auto& epoch : due_epochs_) {
    batch.gnss.push_back(
        {epoch.gnss->device, epoch.gnss->sensor.sample(epoch.time, epoch.motion, *scene_)});
  }
  due_epochs_.clear();
}

void SimulatedWorld::read_state(SampleBatch& batch) const {
  const auto& joints = machine_->joint_angles_rad();
  for (int i = 0; i < 4; ++i) {
    batch.state.push_back(joints[i] * kDegrees);
  }
  batch.state.push_back(machine_->tip_W().z());
  batch.state.push_back(machine_->supply_pressure_pa() * 1e-5);
}

void SimulatedWorld::record_truth(SimTime t0, SimTime t1, SimTime time) {
  // Joints are those of the step's end, at most one step later than `time`; the tap's periods are
  // whole steps, so that both are the same instant.
  TruthRecord record;
  record.time = time;
  const ValveSample valves = machine_->valve_sample(time);
  for (std::size_t i = 0; i < record.joint_rad.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    record.joint_rad[i] = machine_->joint_angles_rad()[joint];
    record.joint_rate_radps[i] = machine_->joint_rates_radps()[joint];
    record.spool[i] = valves.spool_position[i];
  }
  const Eigen::Vector3d tip = machine_->tip_W();
  record.bucket_tip_W_m = {tip.x(), tip.y(), tip.z()};
  record.antenna_latitude_deg = std::numeric_limits<double>::quiet_NaN();
  if (!gnss_.empty()) {
    const auto motion = motion_at(gnss_.front().mount, t0, t1, time);
    const sim::GeodeticPoint antenna = frame_.to_geodetic(motion.X_WL.translation());
    record.antenna_latitude_deg = antenna.latitude_deg;
    record.antenna_longitude_deg = antenna.longitude_deg;
    record.antenna_height_m = antenna.ellipsoid_height_m;
  }
  tap_->record(record);
}

}  // namespace rigwire::hil
