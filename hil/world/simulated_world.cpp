#include "hil/world/simulated_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include "hil/executive/cpu_time.h"
#include "sim/contact/loose_bodies.h"
#include "sim/excavator/bucket_soil.h"
#include "sim/ground/ground.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {

MachineInScene::MachineInScene() = default;
MachineInScene::~MachineInScene() = default;
MachineInScene::MachineInScene(MachineInScene&&) noexcept = default;
MachineInScene& MachineInScene::operator=(MachineInScene&&) noexcept = default;

SimulatedWorld::SimulatedWorld(const WorldSettings& settings, MachineInScene content)
    : settings_(settings), content_(std::move(content)) {
  if (settings.step <= Duration{0} || settings.slice < settings.step ||
      settings.slice % settings.step != Duration{0}) {
    throw std::invalid_argument(
        fmt::format("physics slice {} ns is not a whole multiple of the step {} ns",
                    settings.slice.count(), settings.step.count()));
  }
  copy_motions(after_);
  const std::size_t links = after_.size();
  if (content_.scene->body_count() != links) {
    throw std::invalid_argument(
        fmt::format("the scene has {} moving bodies, machine and loose things are {}",
                    content_.scene->body_count(), links));
  }
  before_ = after_;
  bodies_.resize(links);
  state_quantities_ = hil::state_quantities(*content_.machine);
  state_.resize(state_quantities_.size());
  truth_.state.resize(state_quantities_.size());
  std::size_t numbers = 0;
  for (const sim::TruthField& field : content_.machine->truth_fields()) {
    numbers += field.count;
  }
  truth_.machine.resize(numbers);
  truth_.links.resize(content_.machine->links().size());
  hand_ = std::make_unique<Hand>(*content_.machine);
}

SimulatedWorld::~SimulatedWorld() = default;
SimulatedWorld::SimulatedWorld(SimulatedWorld&&) noexcept = default;

void SimulatedWorld::add(std::unique_ptr<WorldSensor> sensor) {
  sensors_.push_back(std::move(sensor));
}

void SimulatedWorld::set_weather(std::unique_ptr<sim::SceneWeather> weather) {
  weather_ = std::move(weather);
}

void SimulatedWorld::add_truth_observer(std::unique_ptr<TruthObserver> observer, Duration period) {
  told_.push_back({std::move(observer), period, frontier_ + period});
}

void SimulatedWorld::set_lidar_truth_observer(std::unique_ptr<LidarTruthObserver> observer) {
  lidar_observer_ = std::move(observer);
}

void SimulatedWorld::set_camera_truth_observer(std::unique_ptr<CameraTruthObserver> observer) {
  camera_observer_ = std::move(observer);
}

std::optional<std::string> SimulatedWorld::advance(const TruthRequests& requests,
                                                   SampleBatch& batch) {
  batch.clear();
  batch.from = frontier_;
  batch.until = frontier_ + settings_.slice;
  hand_->lift();
  for (const auto& sensor : sensors_) {
    sensor->take(frontier_, requests);
  }
  hand_->lay(frontier_, requests);
  slice_start_ = after_;
  for (SimTime t0 = frontier_; t0 < batch.until; t0 += settings_.step) {
    if (auto fault = step_machine()) {
      return fault;
    }
    sample_step({t0, t0 + settings_.step, before_, after_, settings_.gravity_mps2}, batch.samples);
  }
  prepare_scene(batch.from, batch.until);
  sample_slice(batch.from, batch.until, batch.samples);
  for (const auto& sensor : sensors_) {
    if (auto fault = sensor->fault()) {
      return fault;
    }
  }
  frontier_ = batch.until;
  batch.state.resize(state_quantities_.size());
  read_state(*content_.machine, batch.state);
  return std::nullopt;
}

void SimulatedWorld::copy_motions(std::vector<sim::LinkMotion>& to) const {
  const auto links = content_.machine->links();
  to.assign(links.begin(), links.end());
  const sim::LooseBodies* loose = content_.ground ? content_.ground->loose() : nullptr;
  for (std::size_t i = 0; loose != nullptr && i < loose->size(); ++i) {
    to.push_back(loose->motion(i));
  }
}

std::optional<std::string> SimulatedWorld::step_machine() {
  const StageTimer timer(stages_.physics_s);
  std::swap(before_, after_);
  content_.machine->step(settings_.step);
  copy_motions(after_);
  if (const auto& fault = content_.machine->non_finite()) {
    return fmt::format("{} of the {} is not a finite number at {:.4f} s", fault->quantity,
                       fault->part, to_seconds(fault->time));
  }
  return std::nullopt;
}

void SimulatedWorld::sample_step(const WorldStep& step, Shelves& samples) {
  const StageTimer timer(stages_.sensors_s);
  for (const auto& sensor : sensors_) {
    sensor->step(step, samples);
  }
  for (Told& told : told_) {
    for (; told.next <= step.t1; told.next += told.period) {
      fill_truth(step, told.next);
      told.observer->record(truth_);
    }
  }
}

void SimulatedWorld::prepare_scene(SimTime t0, SimTime t1) {
  const StageTimer timer(stages_.ray_casting_s);
  dug_ = content_.machine->take_ground_changes();
  if (dug_) {
    content_.scene->update_terrain(content_.terrain, content_.ground->field(), *dug_);
  }
  show_leaning();
  const Eigen::Vector3d focus_W = after_.front().X_WL.translation();
  if (std::ranges::any_of(sensors_, &WorldSensor::looks_at_scene)) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i] = {slice_start_[i].X_WL, after_[i].X_WL};
    }
    content_.scene->begin_slice(t0, t1, focus_W, bodies_);
  } else {
    content_.scene->pass_slice(t0, t1, focus_W);
  }
  if (weather_ != nullptr) {
    weather_->advance(t1, content_.machine->dust_emitters());
  }
}

void SimulatedWorld::show_leaning() {
  const auto leaning = content_.machine->leaning_obstacles();
  shown_rad_.resize(leaning.size());
  for (std::size_t i = 0; i < leaning.size(); ++i) {
    if (leaning[i].angle_rad == shown_rad_[i]) {
      continue;
    }
    shown_rad_[i] = leaning[i].angle_rad;
    const Eigen::Isometry3d motion_W =
        leaning[i].motion_W(content_.ground->obstacles()[leaning[i].obstacle].foot_W());
    auto look = std::ranges::lower_bound(content_.looks, leaning[i].obstacle, {},
                                         &sim::ObstacleLook::obstacle);
    for (; look != content_.looks.end() && look->obstacle == leaning[i].obstacle; ++look) {
      content_.scene->displace(look->piece, motion_W);
    }
  }
}

void SimulatedWorld::sample_slice(SimTime t0, SimTime t1, Shelves& samples) {
  const WorldSlice slice{.t0 = t0,
                         .t1 = t1,
                         .links_at_t0 = slice_start_,
                         .links_at_t1 = after_,
                         .scene = *content_.scene,
                         .weather = weather_.get(),
                         .lidar_truth = lidar_observer_.get(),
                         .camera_truth = camera_observer_.get(),
                         .ground = content_.ground ? &content_.ground->field() : nullptr,
                         .dug = dug_,
                         .paced = paced_};
  const auto ask = [&](bool casting, double& account_s) {
    const StageTimer timer(account_s);
    for (const auto& sensor : sensors_) {
      if (sensor->casts_beams() == casting) {
        sensor->slice(slice, samples);
      }
    }
  };
  ask(true, stages_.ray_casting_s);
  ask(false, stages_.sensors_s);
}

void SimulatedWorld::fill_truth(const WorldStep& step, SimTime time) {
  // The machine's fields are those of the step's end, at most one step later than `time`; the
  // periods are whole steps, so that both are the same instant.
  truth_.time = time;
  for (std::size_t link = 0; link < truth_.links.size(); ++link) {
    truth_.links[link] = step.motion({link, Eigen::Isometry3d::Identity()}, time);
  }
  content_.machine->read_truth(truth_.machine);
  read_state(*content_.machine, state_);
  for (std::size_t i = 0; i < state_.size(); ++i) {
    truth_.state[i] = {state_quantities_[i].name, state_[i]};
  }
  if (const sim::ValvePort* port = content_.machine->valve_port()) {
    truth_.valves = port->valve_sample(time);
  }
  if (const sim::VehiclePort* port = content_.machine->vehicle_port()) {
    truth_.vehicle = port->vehicle_sample(time);
  }
  if (const sim::PowerUnitPort* port = content_.machine->power_unit_port()) {
    truth_.power_unit = port->power_unit_sample(time);
  }
  if (const sim::ContactReport* report = content_.machine->contact_report()) {
    ContactTruth& contact = truth_.contact.emplace();
    contact.touching = report->points > 0;
    contact.body = report->body;
    if (report->obstacle) {
      contact.with = content_.ground->obstacles()[*report->obstacle].name;
      contact.place_W = report->p_W;
    } else if (report->mover) {
      contact.with = content_.ground->loose()->name(*report->mover);
      contact.place_W = report->p_W;
    } else if (report->terrain) {
      contact.with = "terrain";
      contact.place_W = report->p_W;
    }
    contact.force_W = report->force_W;
    contact.deepest_m = report->deepest_m;
    contact.dent_m = report->dent_m;
    contact.pressed_m = report->pressed_m;
    contact.sunk_m = report->sunk_m;
    contact.lost_j = report->lost_j;
    contact.felled = report->felled;
  }
  truth_.moved.clear();
  const sim::LooseBodies* loose = content_.ground ? content_.ground->loose() : nullptr;
  for (std::size_t i = 0; loose != nullptr && i < loose->size(); ++i) {
    if (loose->moved(i)) {
      truth_.moved.push_back({loose->name(i), loose->motion(i)});
    }
  }
  truth_.hand = hand_->held();
  truth_.antennas.clear();
  for (const auto& sensor : sensors_) {
    sensor->tell(step, time, truth_);
  }
}

}  // namespace rigwire::hil
