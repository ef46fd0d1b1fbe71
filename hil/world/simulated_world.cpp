#include "hil/world/simulated_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hil/executive/cpu_time.h"

namespace rigwire::hil {
namespace {

void copy(std::span<const sim::LinkMotion> from, std::vector<sim::LinkMotion>& to) {
  to.assign(from.begin(), from.end());
}

}  // namespace

template <class Sensor>
void SimulatedWorld::Mounted<Sensor>::replan(const SamplePlan& changed, SimTime frontier) {
  plan = changed;
  // At the very start the instant 0 itself is still open.
  next = frontier == kStart ? plan.first : plan.next_after(frontier);
}

SimulatedWorld::SimulatedWorld(const WorldSettings& settings, MachineInScene content,
                               const sim::LocalFrame& frame)
    : settings_(settings), content_(std::move(content)), frame_(frame) {
  if (settings.step <= Duration{0} || settings.slice < settings.step ||
      settings.slice % settings.step != Duration{0}) {
    throw std::invalid_argument(
        fmt::format("physics slice {} ns is not a whole multiple of the step {} ns",
                    settings.slice.count(), settings.step.count()));
  }
  const std::size_t links = content_.machine->links().size();
  if (content_.scene->body_count() != links) {
    throw std::invalid_argument(fmt::format("the scene has {} moving bodies, the machine {} links",
                                            content_.scene->body_count(), links));
  }
  copy(content_.machine->links(), after_);
  before_ = after_;
  bodies_.resize(links);
  for (const sim::StatusQuantity& quantity : content_.machine->status_quantities()) {
    state_quantities_.push_back({std::string(quantity.name), std::string(quantity.unit)});
  }
  std::size_t numbers = 0;
  for (const sim::TruthField& field : content_.machine->truth_fields()) {
    numbers += field.count;
  }
  truth_.machine.resize(numbers);
}

void SimulatedWorld::add_gnss(DeviceIndex device, const SensorMount& mount,
                              sim::GnssSensor sensor) {
  gnss_.push_back({device, mount, std::move(sensor), {}, kNever});
  truth_.antennas.resize(gnss_.size());
}

void SimulatedWorld::add_imu(DeviceIndex device, const SensorMount& mount, sim::ImuSensor sensor,
                             std::optional<sim::Magnetometer> magnetometer) {
  imu_.push_back({device, mount, {std::move(sensor), std::move(magnetometer)}, {}, kNever});
}

void SimulatedWorld::add_encoder(DeviceIndex device, std::size_t base, std::size_t moving,
                                 sim::JointAngle joint) {
  SensorMount mount;
  mount.link = base;
  encoders_.push_back({device, mount, {moving, joint}, {}, kNever});
}

void SimulatedWorld::add_lidar(DeviceIndex device, const SensorMount& mount,
                               std::unique_ptr<sim::LidarSensor> sensor, LidarPattern pattern) {
  lidars_.push_back({device, mount, {std::move(sensor), std::move(pattern)}, {}, kNever});
}

void SimulatedWorld::add_valves(DeviceIndex device) {
  if (content_.machine->valve_port() == nullptr) {
    throw std::invalid_argument("the machine has no valve block for a valve driver");
  }
  valves_.push_back({device, {}, {}, {}, kNever});
}

void SimulatedWorld::add_vehicle(DeviceIndex device, sim::VehicleSensors sensors) {
  if (content_.machine->vehicle_port() == nullptr) {
    throw std::invalid_argument("the machine has no drive train for a vehicle gateway");
  }
  vehicles_.push_back({device, {}, std::move(sensors), {}, kNever});
}

void SimulatedWorld::set_weather(std::unique_ptr<sim::SceneWeather> weather) {
  weather_ = std::move(weather);
}

void SimulatedWorld::set_truth_tap(std::unique_ptr<TruthTap> tap, Duration period) {
  tap_ = std::move(tap);
  tap_period_ = period;
  next_tap_ = frontier_ + period;
}

void SimulatedWorld::set_lidar_truth_tap(std::unique_ptr<LidarTruthTap> tap) {
  lidar_tap_ = std::move(tap);
}

sim::LinkMotion SimulatedWorld::motion_at(const SensorMount& mount, SimTime t0, SimTime t1,
                                          SimTime time) const {
  return sim::at_mount(
      sim::LinkMotionInterpolation(t0, before_[mount.link], t1, after_[mount.link])(time),
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
    replan(encoders_, request);
    replan(valves_, request);
    replan(vehicles_, request);
  }
  for (const auto& command : requests.lidar_commands) {
    for (auto& lidar : lidars_) {
      if (lidar.device == command.device) {
        lidar.sensor.sensor->command(frontier_, command.content);
      }
    }
  }
  for (const auto& command : requests.valve_commands) {
    content_.machine->valve_port()->command(command.content);
  }
  for (const auto& command : requests.vehicle_commands) {
    content_.machine->vehicle_port()->command(command.content);
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
  std::swap(before_, after_);
  content_.machine->step(settings_.step);
  copy(content_.machine->links(), after_);
  if (const auto& fault = content_.machine->non_finite()) {
    return fmt::format("{} of the {} is not a finite number at {:.4f} s", fault->quantity,
                       fault->part, to_seconds(fault->time));
  }
  return std::nullopt;
}

void SimulatedWorld::sample_step(SimTime t0, SimTime t1, SampleBatch& batch) {
  const StageTimer timer(stages_.sensors_s);
  for (auto& imu : imu_) {
    for (; imu.next <= t1; imu.next = imu.plan.next_after(imu.next)) {
      const auto motion = motion_at(imu.mount, t0, t1, imu.next);
      ImuSample sample = imu.sensor.sensor.sample(imu.next, motion, settings_.gravity_mps2);
      if (imu.sensor.magnetometer) {
        sample.magnetic_field_t = imu.sensor.magnetometer->sample(imu.next, motion, 0.0).field_t;
      }
      batch.imu.push_back({imu.device, sample});
    }
  }
  for (auto& encoder : encoders_) {
    for (; encoder.next <= t1; encoder.next = encoder.plan.next_after(encoder.next)) {
      SensorMount moving;
      moving.link = encoder.sensor.moving;
      batch.encoders.push_back(
          {encoder.device,
           encoder.sensor.angle.sample(encoder.next, motion_at(encoder.mount, t0, t1, encoder.next),
                                       motion_at(moving, t0, t1, encoder.next))});
    }
  }
  for (auto& valves : valves_) {
    for (; valves.next <= t1; valves.next = valves.plan.next_after(valves.next)) {
      batch.valves.push_back(
          {valves.device, content_.machine->valve_port()->valve_sample(valves.next)});
    }
  }
  for (auto& vehicle : vehicles_) {
    for (; vehicle.next <= t1; vehicle.next = vehicle.plan.next_after(vehicle.next)) {
      const VehicleSample exact = content_.machine->vehicle_port()->vehicle_sample(vehicle.next);
      batch.vehicles.push_back({vehicle.device, vehicle.sensor.measure(exact)});
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
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i] = {slice_start_[i].X_WL, after_[i].X_WL};
    }
    if (const auto changed = content_.machine->take_ground_changes()) {
      content_.scene->update_terrain(content_.terrain, content_.ground->field(), *changed);
    }
    content_.scene->begin_slice(t0, t1, after_.front().X_WL.translation(), bodies_);
    if (weather_ != nullptr) {
      weather_->advance(t1, content_.machine->dust_emitters());
    }
    batch.lidar.resize(lidars_.size());
    for (std::size_t i = 0; i < lidars_.size(); ++i) {
      auto& lidar = lidars_[i];
      const std::size_t link = lidar.mount.link;
      batch.lidar[i].device = lidar.device;
      lidar.sensor.sensor->cast(*content_.scene,
                                {.t0 = t0,
                                 .t1 = t1,
                                 .mount_at_t0 = sim::at_mount(slice_start_[link], lidar.mount.X_LS),
                                 .mount_at_t1 = sim::at_mount(after_[link], lidar.mount.X_LS)},
                                weather_.get(), batch.lidar[i].firings,
                                lidar_tap_ != nullptr ? &lidar_truth_ : nullptr);
      if (lidar_tap_ != nullptr) {
        lidar_tap_->record(i, lidar.sensor.pattern, batch.lidar[i].firings, lidar_truth_);
      }
    }
  }
  const StageTimer timer(stages_.sensors_s);
  for (const auto& epoch : due_epochs_) {
    batch.gnss.push_back(
        {epoch.gnss->device, epoch.gnss->sensor.sample(epoch.time, epoch.motion, *content_.scene)});
  }
  due_epochs_.clear();
}

void SimulatedWorld::read_state(SampleBatch& batch) const {
  batch.state.resize(state_quantities_.size());
  content_.machine->read_status(batch.state);
}

void SimulatedWorld::record_truth(SimTime t0, SimTime t1, SimTime time) {
  // The machine's fields are those of the step's end, at most one step later than `time`; the tap's
  // periods are whole steps, so that both are the same instant.
  truth_.time = time;
  truth_.carrier = motion_at({}, t0, t1, time);
  content_.machine->read_truth(truth_.machine);
  for (std::size_t i = 0; i < gnss_.size(); ++i) {
    truth_.antennas[i] =
        frame_.to_geodetic(motion_at(gnss_[i].mount, t0, t1, time).X_WL.translation());
  }
  tap_->record(truth_);
}

}  // namespace rigwire::hil
