#include "hil/rig/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <stdexcept>

#include "drivers/endpoint_news.h"
#include "drivers/line_watch.h"
#include "emulators/velodyne/unit_report.h"
#include "fields/check.h"
#include "fields/failure_text.h"
#include "hil/configuration/suggest.h"
#include "hil/devices/gige_camera.h"
#include "hil/devices/velodyne.h"
#include "hil/files/geoid_file.h"
#include "hil/files/mesh_file.h"
#include "hil/files/motion_file.h"
#include "hil/record/camera_truth_tap.h"
#include "hil/record/contact_watch.h"
#include "hil/record/lidar_truth_tap.h"
#include "hil/record/truth_tap.h"
#include "hil/wires/can_hop.h"
#include "hil/wires/client_drain.h"
#include "hil/wires/outlets.h"
#include "hil/wires/rig_usb.h"
#include "hil/world/camera_surroundings.h"
#include "hil/world/machine.h"
#include "hil/world/quantities.h"
#include "hil/world/scene.h"
#include "hil/world/sky.h"
#include "hil/world/standing_free.h"
#include "hil/world/surroundings.h"
#include "hil/world/truth_faults.h"
#include "sim/camera/visible_labels.h"
#include "sim/contact/loose_bodies.h"
#include "sim/excavator/bucket_soil.h"
#include "sim/ground/ground.h"
#include "sim/random.h"
#include "sim/replay/replayed_machine.h"
#include "sim/scene/triangle_mesh.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {
namespace {

/// Between two changes of the terrain that the rays see: about what a lidar looks at once.
constexpr Duration kTerrainPeriod = std::chrono::milliseconds(50);
/// In which rocks and crates come to rest before the start.
constexpr double kLongestSettling_s = 5.0;

Eigen::Vector3d eigen(const Vector3& v) {
  return {v.x, v.y, v.z};
}

sim::Scene::MeshId add_shape(sim::Scene& scene, const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    return scene.add_mesh(sim::make_box("box", eigen(box->size_m)));
  }
  const auto& mesh = std::get<MeshShape>(shape);
  sim::TriangleMesh loaded = load_mesh(mesh.file, mesh.file);
  for (auto& vertex : loaded.vertices) {
    vertex *= static_cast<float>(mesh.scale);
  }
  return scene.add_mesh(loaded);
}

/// What soil that is poured out may fall on: the fixed objects of the scene, found by a ray. A
/// truck's box catches what falls into it; the machine's links and loose bodies do not.
class SceneFallObstacle final : public sim::FallObstacle {
 public:
  /// `scene` must outlive it. Nothing is caught before the scene's first slice.
  explicit SceneFallObstacle(const sim::Scene& scene) : scene_(scene) {}

  [[nodiscard]] bool catches(const Eigen::Vector3d& from_W, double terrain_m) const override {
    constexpr double kClear_m = 0.1;  // What lies flat on the ground catches nothing.
    const double reach_m = from_W.z() - terrain_m - kClear_m;
    return reach_m > 0.0 && scene_.fixed_within(from_W, -Eigen::Vector3d::UnitZ(), reach_m);
  }

 private:
  const sim::Scene& scene_;
};

/// Checks that a camera can see every label whose looks it defines. Throws fields::Refused.
void require_looks(const RigConfiguration& configuration, const sim::Scene& scene) {
  std::optional<std::vector<std::string>> labels;
  for (const auto& [name, device] : configuration.devices) {
    const auto* const camera = fields::as<GigeCameraConfiguration>(device);
    if (camera == nullptr) {
      continue;
    }
    const std::vector<sim::SurfaceLook>& looks = sim::optics_of(camera->sensor).looks;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      labels = labels ? std::move(labels) : sim::visible_labels(scene);
      const std::string path = fmt::format("devices.{}.sensor.looks.{}.label", name, i);
      const std::string& label = looks[i].label;
      if (std::ranges::find(*labels, label) == labels->end()) {
        const std::string near = nearest_word(label, *labels);
        throw fields::Refused(
            path,
            fmt::format("nothing in the scene has it, found \"{}\", allowed {}{}", label,
                        join_words(*labels), near.empty() ? "" : ", did you mean " + near + "?"));
      }
      const auto same = [&label](const sim::SurfaceLook& look) { return look.label == label; };
      if (std::any_of(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(i), same)) {
        throw fields::Refused(
            path, fmt::format("it has its looks already, found \"{}\" again, allowed once", label));
      }
    }
  }
}

/// Key path of something that faults are of: "devices.gnss", "buses.can".
std::string path_of_target(const std::string& where) {
  for (const auto& [prefix, section] : {std::pair{"bus ", "buses."}, {"modbus ", "modbus."}}) {
    if (where.starts_with(prefix)) {
      return section + where.substr(std::string_view(prefix).size());
    }
  }
  const auto* const around =
      std::ranges::find(kSurroundingsTargets, where, &SurroundingsTarget::name);
  return around != kSurroundingsTargets.end() ? fmt::format("{}.{}", kSurroundings, around->key)
                                              : "devices." + where;
}

/// Those of the air that the rig's file has.
std::shared_ptr<sim::AirFaults> air_faults(const RigConfiguration& configuration) {
  return std::make_shared<sim::AirFaults>(configuration.surroundings.air.faults);
}

std::unique_ptr<sim::SceneWeather> make_weather(const RigConfiguration& configuration,
                                                std::shared_ptr<const sim::AirFaults> faults) {
  return std::make_unique<sim::SceneWeather>(configuration.scene.weather, configuration.seed,
                                             std::move(faults));
}

/// What faults wait for, the machine has. Throws fields::Refused.
void require_quantities(const RigConfiguration& configuration,
                        const std::vector<StateQuantity>& quantities) {
  RigConfiguration shown = configuration;
  std::map<std::string, std::size_t> seen;
  each_fault(shown, [&](const std::string& where, FaultPeriod& when, const std::string&) {
    const std::size_t number = seen[where]++;
    const std::string& name = when.when.quantity;
    if (!when.waits() || find_quantity(quantities, name)) {
      return;
    }
    throw fields::Refused(fmt::format("{}.faults.{}.when.quantity", path_of_target(where), number),
                          fmt::format("the machine has no such quantity, found \"{}\", allowed {}",
                                      name, allowed_quantities(quantities, name)));
  });
}

/// Each fault draws for its probability from a stream of its own.
RigConfiguration with_fault_streams(RigConfiguration configuration) {
  each_fault(configuration,
             [&](const std::string& where, FaultPeriod& when, const std::string& name) {
               when.stream = fault_stream(configuration.seed, where, name, when.at);
             });
  return configuration;
}

RigCanSettings can_settings(const BusConfiguration& bus, const CanHop& hop) {
  RigCanSettings settings;
  settings.node.order = bus.order;
  settings.node.one_shot = bus.one_shot;
  settings.node.restart_after = bus.restarts ? std::optional(bus.restart_after) : std::nullopt;
  // The kernel restarts a gs_usb controller itself, by closing and opening it.
  settings.client_restart_after =
      hop.choice.wire == CanWire::gs_usb ? std::nullopt : settings.node.restart_after;
  settings.client_is_known = hop.client_is_known;
  settings.acknowledging_node = bus.acknowledger;
  return settings;
}

}  // namespace

SimulatedWorld make_world(const RigConfiguration& configuration, RunLog* log,
                          std::shared_ptr<const sim::AirFaults> air) {
  MachineInScene built = build_machine_in_scene(configuration, log);
  WorldSettings settings;
  settings.step = configuration.step;
  settings.slice = configuration.slice;
  settings.gravity_mps2 = configuration.machine.model->gravity_mps2();
  SimulatedWorld world(settings, std::move(built));
  if (configuration.scene.weather.any() || !configuration.surroundings.air.faults.empty()) {
    world.set_weather(
        make_weather(configuration, air != nullptr ? std::move(air) : air_faults(configuration)));
  }
  return world;
}

std::shared_ptr<CameraSurroundings> make_surroundings(const RigConfiguration& configuration,
                                                      std::shared_ptr<const sim::AirFaults> air) {
  return std::make_shared<CameraSurroundings>(
      Calendar(configuration.start), configuration.origin.latitude_deg,
      configuration.origin.longitude_deg, configuration.scene.daylight, configuration.scene.weather,
      air != nullptr ? std::move(air) : air_faults(configuration));
}

sim::LocalFrame make_local_frame(const OriginConfiguration& origin) {
  std::shared_ptr<const sim::GeoidGrid> geoid;
  if (origin.geoid == GeoidSource::egm96) {
    geoid = load_geoid(origin.geoid_file.empty() ? kEgm96File : origin.geoid_file,
                       origin.geoid_interpolation);
  }
  return sim::LocalFrame(
      {origin.latitude_deg, origin.longitude_deg, origin.height_m, origin.geoid_separation_m},
      std::move(geoid));
}

SensorMount sensor_mount(const MachineConfiguration& machine, const MountConfiguration& mount) {
  const auto names = machine.model->links();
  const auto found = std::find(names.begin(), names.end(), mount.link);
  if (found == names.end()) {
    throw std::invalid_argument(fmt::format("the machine has no link '{}'", mount.link));
  }
  return {static_cast<std::size_t>(found - names.begin()), pose(mount.position_m, mount.rotation)};
}

MachineInScene build_machine_in_scene(const RigConfiguration& configuration, RunLog* log) {
  const SceneFiles files = load_scene_files(configuration.scene.description, configuration.origin);
  for (const std::string& line : files.report) {
    if (log != nullptr) {
      log->warning(line);
    }
  }
  sim::BuiltScene built = sim::build_scene(files.description, files.meshes, configuration.seed);
  const MachineConfiguration& machine = configuration.machine;
  require_on_terrain(machine, built.ground);
  MachineInScene result;
  result.scene = std::move(built.scene);
  result.terrain = built.terrain;
  result.looks = built.looks;
  result.ground = std::make_unique<sim::Ground>(built.ground, built.soils, built.obstacles);
  result.ground->set_loose(std::move(built.loose));
  if (sim::LooseBodies* loose = result.ground->loose()) {
    // Rocks and crates come to rest before the machine is placed among them.
    loose->settle(kLongestSettling_s);
  }
  result.obstacles = std::make_unique<SceneFallObstacle>(*result.scene);
  if (machine.model->changes_ground()) {
    result.scene->make_changeable(result.terrain);
    result.scene->set_terrain_period(kTerrainPeriod);
  }
  Eigen::Isometry3d X_WB = pose(machine.position_m, {0.0, 0.0, machine.yaw_rad});
  if (machine.on_ground) {
    // The position's height counts from the ground below the origin of the first link.
    X_WB.translation().z() +=
        result.ground->height_m(X_WB.translation().x(), X_WB.translation().y());
  }
  result.machine = machine.model->make({*result.ground, *result.obstacles, X_WB});
  if (machine.motion.file.empty()) {
    require_standing_free(machine, *result.machine, *result.ground);
  } else {
    sim::MachineRecord record =
        read_motion(machine.motion, *result.machine, make_local_frame(configuration.origin));
    result.machine =
        std::make_unique<sim::ReplayedMachine>(std::move(result.machine), std::move(record));
  }
  for (const std::string_view link : result.machine->link_names()) {
    // Each link of the machine is a body of the scene, with the shapes mounted on it.
    const sim::Scene::BodyId body = result.scene->add_body(link);
    for (const LinkShape& shape : machine.shapes) {
      if (shape.link == link) {
        result.scene->add_body_part(body, add_shape(*result.scene, shape.placed.shape),
                                    pose(shape.placed.position_m, shape.placed.rotation),
                                    {.reflectance = shape.placed.reflectance,
                                     .label = shape.placed.label,
                                     .retro_gain = shape.placed.retro_gain});
      }
    }
  }
  const sim::LooseBodies* loose = result.ground->loose();
  for (std::size_t i = 0; i < built.loose_looks.size(); ++i) {
    const sim::Scene::BodyId body = result.scene->add_loose_body(loose->name(i));
    result.scene->add_body_part(body, built.loose_looks[i].mesh, Eigen::Isometry3d::Identity(),
                                built.loose_looks[i].material, loose->name(i));
  }
  require_looks(configuration, *result.scene);
  return result;
}

CloudSettings recorded_clouds(const RigConfiguration& configuration) {
  CloudSettings clouds{configuration.truth.clouds_every, {}};
  for (const auto& [name, device] : configuration.devices) {
    if (const auto* const lidar = fields::as<VelodyneConfiguration>(device)) {
      const protocols::velodyne::Model& model = model_of(*lidar);
      clouds.lidars.push_back({name, lidar->mount.link,
                               sensor_mount(configuration.machine, lidar->mount).X_LS, &model,
                               emulators::unit_calibration(settings_of(*lidar), model)});
    }
  }
  return clouds;
}

Problem placed(const fields::Refused& refused, const Origins& origins) {
  return {origins.nearest(refused.path()), refused.path(), refused.rest(), {}, {}, {}};
}

void check_start(const LoadedRig& rig, RunLog* log) {
  const RigConfiguration& configuration = rig.configuration;
  Problems problems;
  // `key`: what the part is made from, empty: from several.
  const auto make = [&](const std::string& key, const char* what, auto&& part) {
    try {
      part();
    } catch (const fields::Refused& refused) {
      problems.add(placed(refused, rig.origins));
    } catch (const std::exception& error) {
      problems.add({rig.origins.nearest(key), key, fields::failure_text(error, what), {}, {}, {}});
    }
  };
  const auto key_of = [](const std::string& section, const char* key, const std::string& file) {
    return file.empty() ? section : section + key;
  };
  make(key_of("origin", ".geoid_file", configuration.origin.geoid_file), "the geoid",
       [&] { (void)make_local_frame(configuration.origin); });
  make(key_of("satellites", ".file", configuration.satellites.file), "the satellites",
       [&] { (void)make_satellites(configuration.satellites, Calendar(configuration.start)); });
  make("", "the scene with the machine", [&] {
    const MachineInScene built = build_machine_in_scene(configuration, log);
    require_quantities(configuration, state_quantities(*built.machine));
  });
  problems.name_as_written(rig.origins);
  problems.throw_if_any();
}

struct Rig::Bus {
  /// `own`: the caller's end, in place of the hop's.
  Bus(CanHop opened, const BusConfiguration& configuration, drivers::CanBus* own)
      : hop(std::move(opened)),
        endpoint(own != nullptr ? *own : *hop.endpoint),
        can(configuration.bus, endpoint, can_settings(configuration, hop)) {}

  CanHop hop;
  drivers::CanBus& endpoint;
  RigCan can;
};

/// The rig as one of its devices sees it while it is made.
class Rig::DeviceSite final : public Site {
 public:
  DeviceSite(Rig& rig, const std::string& name) : rig_(rig), name_(name) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::uint64_t seed() const override { return rig_.configuration_.seed; }
  [[nodiscard]] std::uint64_t stream_seed(std::string_view stream) const override {
    return sim::RandomStream(seed(), fmt::format("{}/{}", name_, stream)).bits();
  }
  [[nodiscard]] const Calendar& calendar() const override { return rig_.calendar_; }
  [[nodiscard]] boost::asio::io_context& io() override { return rig_.io_; }
  [[nodiscard]] Executive& executive() override { return rig_.executive_; }
  [[nodiscard]] RigCan& bus(const std::string& bus) override { return rig_.buses_.at(bus)->can; }
  [[nodiscard]] RigModbus& modbus(const std::string& line) override {
    return *rig_.modbus_lines_.at(line);
  }
  [[nodiscard]] UsbBus& usb() override { return rig_.usb(); }
  [[nodiscard]] SimulatedWorld& world() override { return rig_.world_; }
  [[nodiscard]] const std::shared_ptr<CameraSurroundings>& surroundings() const override {
    return rig_.surroundings_;
  }
  [[nodiscard]] const std::shared_ptr<const sim::Constellation>& satellites() const override {
    return rig_.satellites_;
  }
  [[nodiscard]] const std::shared_ptr<sim::AntennaBook>& antennas() const override {
    return rig_.antennas_;
  }
  [[nodiscard]] const sim::LocalFrame& frame() const override { return rig_.frame_; }
  [[nodiscard]] SensorMount mount(const MountConfiguration& mount) const override {
    return sensor_mount(rig_.configuration_.machine, mount);
  }
  [[nodiscard]] std::size_t link(const std::string& link) const override {
    return mount({link, {}, {}}).link;
  }

 private:
  Rig& rig_;
  const std::string& name_;
};

class Rig::DeviceNeighbours final : public Neighbours {
 public:
  explicit DeviceNeighbours(const Rig& rig) : rig_(rig) {}

  [[nodiscard]] FixSource* fixes_of(const std::string& name) const override {
    for (const NamedDevice& device : rig_.devices_) {
      FixSource* fixes = device.device->fixes();
      if (fixes != nullptr && (name.empty() || name == device.name)) {
        return fixes;
      }
    }
    return nullptr;
  }
  [[nodiscard]] CorrectionSource* corrections_of(const std::string& name) const override {
    for (const NamedDevice& device : rig_.devices_) {
      if (device.name == name) {
        return device.device->corrections();
      }
    }
    return nullptr;
  }
  [[nodiscard]] std::vector<const ValveSource*> valves() const override {
    std::vector<const ValveSource*> all;
    for (const NamedDevice& device : rig_.devices_) {
      if (const ValveSource* valves = device.device->valves()) {
        all.push_back(valves);
      }
    }
    return all;
  }

 private:
  const Rig& rig_;
};

Rig::Rig(const RigConfiguration& configuration, boost::asio::io_context& io,
         const TruthFiles& truth, RunLog* log, const OwnEnds& own, Recorder* recorder)
    : configuration_(with_fault_streams(configuration)),
      io_(io),
      log_(log),
      recorder_(recorder),
      calendar_(configuration.start),
      frame_(make_local_frame(configuration.origin)),
      satellites_(make_satellites(configuration.satellites, calendar_)),
      air_(air_faults(configuration_)),
      surroundings_(make_surroundings(configuration, air_)),
      world_(make_world(configuration, log, air_)),
      executive_(io, world_),
      faults_(configuration.seed, world_.state_quantities()) {
  require_quantities(configuration_, world_.state_quantities());
  if (recorder_ != nullptr) {
    recorder_->attach(executive_);
  }
  for (const auto& [name, end] : own.buses) {
    if (!configuration_.buses.contains(name)) {
      throw std::invalid_argument(fmt::format("the rig has no bus '{}'", name));
    }
  }
  for (const auto& [name, bus] : configuration_.buses) {
    const auto end = own.buses.find(name);
    open_bus(name, bus, end == own.buses.end() ? nullptr : end->second,
             own.with_known_clients.contains(name));
  }
  for (const auto& [name, line] : configuration_.modbus) {
    open_modbus_line(name, line);
  }
  for (const auto& [name, device] : configuration_.devices) {
    for (const auto& [bus_name, bus] : buses_) {
      bus->can.begin_device(name);
    }
    DeviceSite site(*this, name);
    const std::size_t first = executive_.outlets().size();
    devices_.push_back({name, device->make(site)});
    settings_.add(name, *device, *devices_.back().device);
    record(name, first, devices_.back().device->endpoint());
  }
  number_faults();
  executive_.on_slice([this](SimTime until, const std::vector<double>& state) {
    faults_.look(executive_.now(), until, state);
  });
  const DeviceNeighbours neighbours(*this);
  for (const NamedDevice& device : devices_) {
    device.device->connect(neighbours);
  }
  open_taps(truth);
  if (recorder_ != nullptr) {
    recorder_->start([this] { return recorded_status(); }, faults_.windows());
    faults_.inform([this](const FaultWindow& fault) { recorder_->expect(fault); });
  }
  const auto warn = [log](const std::string& news) {
    if (log != nullptr) {
      log->warning(news);
    }
  };
  drivers::line_watch(io_).start(warn);
  drivers::endpoint_news(io_).on_news(warn);
  if (log_ != nullptr) {
    log_->follow([this] { return executive_.reached(); });
  }
}

void Rig::number_faults() {
  for (const NamedDevice& device : devices_) {
    for (const auto& port : device.device->fault_ports()) {
      faults_.add(device.name, *port);
    }
  }
  for (const auto& [name, bus] : configuration_.buses) {
    RigCan& can = buses_.at(name)->can;
    can.set_faults({bus.faults, sim::RandomStream(configuration_.seed, name + "/faults").bits()});
    wire_faults_.push_back(can.fault_port(bus.faults));
    faults_.add("bus " + name, *wire_faults_.back());
  }
  for (const auto& [name, line] : configuration_.modbus) {
    wire_faults_.push_back(modbus_lines_.at(name)->fault_port(line.faults));
    faults_.add("modbus " + name, *wire_faults_.back());
  }
  number_surroundings();
}

void Rig::number_surroundings() {
  const StationIndex station = executive_.add(surroundings_station_);
  world_.add(make_world_air(station, air_, [this](SimTime frontier) {
    if (!world_.has_weather()) {
      auto weather = make_weather(configuration_, air_);
      // Advances the weather from the start of the run, in steps so that it needs little memory.
      constexpr Duration kBit = std::chrono::seconds{1};
      for (SimTime time = kStart + kBit; time < frontier; time += kBit) {
        weather->advance(time, {});
      }
      world_.set_weather(std::move(weather));
    }
  }));
  const auto add = [&]<class Fault>(const SurroundingsTarget& target,
                                    const std::vector<Fault>& faults) {
    wire_faults_.push_back(truth_faults(executive_, surroundings_station_, faults));
    faults_.add(std::string(target.name), *wire_faults_.back());
  };
  const SurroundingsConfiguration& around = configuration_.surroundings;
  add(kSurroundingsTargets[0], around.air.faults);
  // What follows a recorded motion has ports and no such parts.
  const MachineModel& model = *configuration_.machine.model;
  sim::Machine& machine = world_.machine();
  auto* const parts = model.has_power_unit()
                          ? dynamic_cast<sim::PowerUnitDefectPort*>(machine.power_unit_port())
                          : dynamic_cast<sim::PowerUnitDefectPort*>(machine.vehicle_port());
  if (parts != nullptr && model.has_engine()) {
    world_.add(make_world_power_unit_faults(station, *parts, around));
    add(kSurroundingsTargets[1], around.engine.faults);
    if (model.has_power_unit()) {
      add(kSurroundingsTargets[2], around.pumps.faults);
    }
  }
}

void Rig::record(const std::string& wire, std::size_t first,
                 const drivers::EndpointStatus& endpoint) {
  WireTap* tap = nullptr;
  for (std::size_t i = first; i < executive_.outlets().size(); ++i) {
    // Every outlet of a rig is a QueuedOutlet.
    auto& outlet = dynamic_cast<QueuedOutlet&>(*executive_.outlets()[i]);
    outlets_.emplace_back(wire, &outlet);
    if (recorder_ == nullptr) {
      continue;
    }
    if (i == first) {
      tap = &recorder_->add_wire(wire, outlet.kind(), endpoint.address);
    }
    if (tap != nullptr) {
      recorder_->join(*tap, outlet);
    }
  }
}

RecordedStatus Rig::recorded_status() const {
  const RigStatus now = status();
  RecordedStatus recorded;
  for (const DeviceStatus& device : now.devices) {
    recorded.devices.push_back({device.name, device.wire, device.frames, device.bytes,
                                device.dropped, device.lateness_p99, device.lateness_max});
  }
  recorded.faults = now.faults;
  return recorded;
}

void Rig::open_taps(const TruthFiles& files) {
  if (!files.machine.empty()) {
    world_.add_truth_observer(
        std::make_unique<TruthTap>(files.machine, calendar_, world_.machine().truth_fields(),
                                   files.failures, files.patience),
        configuration_.truth.period);
  }
  if (recorder_ != nullptr) {
    world_.add_truth_observer(recorder_->truth_observer(calendar_, world_.machine().truth_fields(),
                                                        world_.machine().link_names()),
                              configuration_.truth.period);
    if (world_.machine().contact_report() != nullptr) {
      world_.add_truth_observer(std::make_unique<ContactWatch>(recorder_->events()),
                                configuration_.truth.period);
    }
  }
  if (!files.lidar.empty()) {
    std::vector<std::string> lidars;
    for (const NamedDevice& device : devices_) {
      if (device.device->is_lidar()) {
        lidars.push_back(device.name);
      }
    }
    world_.set_lidar_truth_observer(std::make_unique<LidarTruthTap>(
        files.lidar, calendar_, world_.scene(), std::move(lidars), files.failures, files.patience));
  }
  if (!files.cameras.empty()) {
    const std::vector<std::string> all = camera_names(configuration_);
    if (all.empty()) {
      throw std::invalid_argument(
          "the camera truth: found 0 cameras in the rig, allowed 1 or more");
    }
    const std::vector<std::string>& chosen = configuration_.truth.cameras;
    world_.set_camera_truth_observer(std::make_unique<CameraTruthTap>(
        files.cameras, calendar_, world_.scene(), chosen.empty() ? all : chosen, files.failures,
        files.patience > std::chrono::milliseconds{0}));
  }
}

std::map<std::string, StationIndex> Rig::camera_stations() const {
  std::map<std::string, StationIndex> stations;
  for (const NamedDevice& device : devices_) {
    if (const auto station = device.device->camera_station()) {
      stations.emplace(device.name, *station);
    }
  }
  return stations;
}

std::shared_ptr<CameraSurroundings> Rig::more_surroundings() const {
  return make_surroundings(configuration_, air_);
}

Rig::~Rig() {
  drivers::line_watch(io_).stop();
  drivers::endpoint_news(io_).on_news({});
  if (log_ != nullptr) {
    log_->follow([end = executive_.reached()] { return end; });
  }
}

void Rig::open_bus(const std::string& name, const BusConfiguration& configuration,
                   drivers::CanBus* own, bool client_is_known) {
  if (own != nullptr && (configuration.ports != 1 || configuration.socketcand.port != 0)) {
    throw std::invalid_argument(
        fmt::format("bus {}: its end is in this program, found {} ports and socketcand port {}, "
                    "allowed 1 and 0",
                    name, configuration.ports, configuration.socketcand.port));
  }
  CanHop hop;
  if (own == nullptr) {
    hop =
        open_can_hop(name, configuration, examine_can_host(), io_,
                     std::chrono::floor<std::chrono::microseconds>(unix_time(configuration_.start)),
                     [this]() -> UsbBus& { return usb(); });
  } else {
    hop.choice.why = "in this program";
    hop.client_is_known = client_is_known;
  }
  auto bus = std::make_unique<Bus>(std::move(hop), configuration, own);
  executive_.add(bus->can);
  const std::size_t first = executive_.outlets().size();
  executive_.add(bus->can.outlet());
  record(name, first, bus->can.endpoint());
  bus->can.outlet().on_client([this, &can = bus->can](const drivers::CanClient& client) {
    can.client(executive_.arrive(), client);
  });
  bus->can.outlet().start([this, &can = bus->can](const protocols::can::Frame& frame) {
    can.receive(executive_.arrive(), frame);
  });
  for (const CanHop::Further& further : bus->hop.further) {
    RigCan::Port& port =
        bus->can.add_port(further.node, *further.endpoint, further.client_is_known);
    executive_.add(port.outlet());
    port.outlet().on_client([this, &port](const drivers::CanClient& client) {
      port.client(executive_.arrive(), client);
    });
    port.outlet().start([this, &port](const protocols::can::Frame& frame) {
      port.receive_from_client(executive_.arrive(), frame);
    });
  }
  buses_.emplace(name, std::move(bus));
}

void Rig::open_modbus_line(const std::string& name, const ModbusLineConfiguration& configuration) {
  const std::uint64_t seed =
      sim::RandomStream(configuration_.seed, "modbus." + name + "/line").bits();
  auto line = make_rig_modbus(configuration, io_, seed);
  const std::size_t first = executive_.outlets().size();
  line->start(executive_);
  record(name, first, line->endpoint());
  modbus_lines_.emplace(name, std::move(line));
}

void Rig::watch_clients(ClientDrain& drain) const {
  for (const auto& [name, outlet] : outlets_) {
    drain.watch(name, *outlet);
  }
}

std::vector<std::string> Rig::wires() const {
  std::vector<std::string> lines;
  for (const auto& [name, bus] : buses_) {
    lines.push_back(
        fmt::format("bus {}: {} ({})", name, bus->can.endpoint().address, bus->hop.choice.why));
    for (const CanHop::Further& further : bus->hop.further) {
      lines.push_back(
          fmt::format("bus {}: {} (a further port)", name, further.endpoint->status().address));
    }
  }
  for (const NamedDevice& device : devices_) {
    if (const std::string remark = device.device->remark(); !remark.empty()) {
      lines.push_back(device.name + ": " + remark);
    }
  }
  return lines;
}

UsbBus& Rig::usb() {
  if (usb_ == nullptr) {
    usb_ = std::make_unique<RigUsb>(configuration_.usb, io_, executive_);
  }
  return *usb_;
}

RigStatus Rig::status() const {
  RigStatus status;
  status.now = executive_.now();
  status.slipped = executive_.slipped();
  status.machine = executive_.machine_state();
  for (const NamedDevice& device : devices_) {
    status.devices.push_back(device.device->status(device.name, status.now));
  }
  for (const auto& [name, bus] : buses_) {
    const emulators::CanBusModel& model = bus->can.bus();
    status.buses.push_back(
        {name, model.load(status.now), model.frames(), model.error_frames(), model.nodes()});
  }
  status.faults = faults_.windows();
  std::erase_if(status.faults,
                [&](const FaultWindow& fault) { return !fault.acts_at(status.now); });
  return status;
}

std::vector<DeviceReport> Rig::device_reports() const {
  std::vector<DeviceReport> reports;
  for (const NamedDevice& device : devices_) {
    DeviceReport report{device.name,
                        device.device->endpoint().address,
                        device.device->frames(),
                        device.device->statistics(),
                        device.device->last_request(),
                        device.device->counts(),
                        device.device->remark()};
    report.statistics.dropped = device.device->dropped();
    if (const std::uint64_t cut_off = device.device->endpoint().cut_off; cut_off > 0) {
      report.counts.push_back({"clients closed that did not read", cut_off});
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace rigwire::hil
