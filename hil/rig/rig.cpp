#include "hil/rig/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "hil/devices/starfire_line.h"
#include "hil/devices/usb_joystick_line.h"
#include "hil/devices/usb_passthrough_line.h"
#include "hil/devices/valve_driver_line.h"
#include "hil/devices/velodyne_line.h"
#include "hil/files/geoid_file.h"
#include "hil/files/mesh_file.h"
#include "hil/wires/can_hop.h"
#include "hil/wires/rig_usb.h"
#include "hil/world/lidar.h"
#include "hil/world/machine.h"
#include "hil/world/scene.h"
#include "hil/world/scene_fall_obstacle.h"
#include "hil/world/sky.h"
#include "sim/random.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::hil {
namespace {

/// Between two changes of the terrain that the rays see: about what a lidar looks at once.
constexpr Duration kTerrainPeriod = std::chrono::milliseconds(50);

Eigen::Vector3d eigen(const Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d pose(const Vector3& position_m, const RollPitchYaw& rotation) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = (Eigen::AngleAxisd(rotation.yaw_rad, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(rotation.pitch_rad, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(rotation.roll_rad, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  X.translation() = eigen(position_m);
  return X;
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

std::optional<sim::Magnetometer> make_magnetometer(
    const sim::MagnetometerConfiguration& configuration, std::uint64_t seed,
    const std::string& name) {
  if (!configuration.present) {
    return std::nullopt;
  }
  return sim::Magnetometer(parameters_of(configuration), seed, name);
}

SimulatedWorld make_world(const RigConfiguration& configuration, const sim::LocalFrame& frame) {
  MachineInScene built = build_machine_in_scene(configuration);
  WorldSettings settings;
  settings.step = configuration.step;
  settings.slice = configuration.slice;
  settings.gravity_mps2 = gravity_mps2(configuration.machine.settings);
  SimulatedWorld world(settings, std::move(built), frame);
  if (configuration.scene.weather.any()) {
    world.set_weather(
        std::make_unique<sim::SceneWeather>(configuration.scene.weather, configuration.seed));
  }
  return world;
}

CanLineSettings line_settings(const BusConfiguration& bus, const CanHop& hop) {
  CanLineSettings settings;
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
  const auto names = link_names(machine.settings);
  const auto found = std::find(names.begin(), names.end(), mount.link);
  if (found == names.end()) {
    throw std::invalid_argument(fmt::format("the machine has no link '{}'", mount.link));
  }
  return {static_cast<std::size_t>(found - names.begin()), pose(mount.position_m, mount.rotation)};
}

MachineInScene build_machine_in_scene(const RigConfiguration& configuration) {
  const SceneFiles files = load_scene_files(configuration.scene.description, configuration.origin);
  for (const std::string& line : files.report) {
    fmt::print(stderr, "rigwire: {}\n", line);
  }
  sim::BuiltScene built = sim::build_scene(files.description, files.meshes, configuration.seed);
  const MachineConfiguration& machine = configuration.machine;
  MachineInScene result;
  result.scene = std::move(built.scene);
  result.terrain = built.terrain;
  result.ground = std::make_unique<sim::Ground>(built.ground, built.soils, built.obstacles);
  result.obstacles = std::make_unique<SceneFallObstacle>(*result.scene);
  if (changes_ground(machine.settings)) {
    result.scene->make_changeable(result.terrain);
    result.scene->set_terrain_period(kTerrainPeriod);
  }
  Eigen::Isometry3d X_WB = pose(machine.position_m, {0.0, 0.0, machine.yaw_rad});
  if (machine.on_ground) {
    X_WB.translation().z() +=
        result.ground->height_m(X_WB.translation().x(), X_WB.translation().y());
  }
  result.machine = make_machine(machine.settings, {*result.ground, *result.obstacles, X_WB});
  for (const std::string_view link : result.machine->link_names()) {
    const sim::Scene::BodyId body = result.scene->add_body(link);
    for (const LinkShape& shape : machine.shapes) {
      if (shape.link == link) {
        result.scene->add_body_part(body, add_shape(*result.scene, shape.placed.shape),
                                    pose(shape.placed.position_m, shape.placed.rotation),
                                    {shape.placed.reflectance, shape.placed.label});
      }
    }
  }
  return result;
}

struct Rig::Bus {
  Bus(CanHop opened, const BusConfiguration& configuration)
      : hop(std::move(opened)),
        line(configuration.bus, *hop.endpoint, line_settings(configuration, hop)) {}

  CanHop hop;
  CanLine line;
};

Rig::Rig(const RigConfiguration& configuration, boost::asio::io_context& io,
         const TruthFiles& truth)
    : configuration_(configuration),
      io_(io),
      calendar_(configuration.start),
      frame_(make_local_frame(configuration.origin)),
      satellites_(make_satellites(configuration.satellites, calendar_)),
      world_(make_world(configuration, frame_)),
      executive_(io, world_) {
  for (const auto& [name, bus] : configuration_.buses) {
    open_bus(name, bus);
  }
  for (const auto& [name, line] : configuration_.modbus) {
    open_modbus_line(name, line);
  }
  for (const auto& [name, device] : configuration_.devices) {
    for (const auto& [bus_name, bus] : buses_) {
      bus->line.begin_device(name);
    }
    add_device(name, device);
  }
  for (const auto& [name, bus] : configuration_.buses) {
    if (!bus.faults.empty()) {
      buses_.at(name)->line.set_faults(can_bus_faults(
          bus.faults, sim::RandomStream(configuration_.seed, name + "/faults").bits()));
    }
  }
  connect_receivers();
  connect_joysticks();
  open_taps(truth);
}

void Rig::open_taps(const TruthFiles& files) {
  std::vector<std::string> antennas;
  std::vector<std::string> lidars;
  for (const Device& device : devices_) {
    if (dynamic_cast<const GnssLine*>(device.line.get()) != nullptr) {
      antennas.push_back(device.name);
    } else if (dynamic_cast<const LidarLine*>(device.line.get()) != nullptr) {
      lidars.push_back(device.name);
    }
  }
  if (!files.machine.empty()) {
    world_.set_truth_tap(
        std::make_unique<TruthTap>(files.machine, calendar_, world_.machine().truth_fields(),
                                   std::move(antennas)),
        configuration_.truth.period);
  }
  if (!files.lidar.empty()) {
    world_.set_lidar_truth_tap(
        std::make_unique<LidarTruthTap>(files.lidar, calendar_, world_.scene(), lidars));
  }
}

Rig::~Rig() = default;

void Rig::open_bus(const std::string& name, const BusConfiguration& configuration) {
  auto bus = std::make_unique<Bus>(
      open_can_hop(configuration, examine_can_host(), io_, [this]() -> UsbBus& { return usb(); }),
      configuration);
  executive_.add(bus->line);
  executive_.add(bus->line.outlet());
  drivers::CanBus& endpoint = *bus->hop.endpoint;
  endpoint.on_client([this, &line = bus->line](const drivers::CanClient& client) {
    line.client(executive_.arrive(), client);
  });
  endpoint.start([this, &line = bus->line](const protocols::can::Frame& frame) {
    line.receive(executive_.arrive(), frame);
  });
  buses_.emplace(name, std::move(bus));
}

void Rig::open_modbus_line(const std::string& name, const ModbusLineConfiguration& configuration) {
  const std::uint64_t seed =
      sim::RandomStream(configuration_.seed, "modbus." + name + "/line").bits();
  auto line = make_modbus_line(configuration, io_, seed);
  line->start(executive_);
  modbus_lines_.emplace(name, std::move(line));
}

void Rig::add_device(const std::string& name, const DeviceConfiguration& configuration) {
  const std::uint64_t seed = configuration_.seed;
  const LineContext context{io_, calendar_, sim::RandomStream(seed, name + "/line").bits(), name,
                            [this]() -> UsbBus& { return usb(); }};
  const auto mount = [this](const MountConfiguration& place) {
    return sensor_mount(configuration_.machine, place);
  };
  if (const UbloxConfiguration* gnss = as_ublox(configuration.settings)) {
    sim::GnssParameters sensor = gnss->sensor;
    sensor.faults = signal_faults(gnss->faults);
    auto line = make_line(*gnss, context);
    world_.add_gnss(line->enlist(executive_), mount(gnss->mount),
                    sim::GnssSensor(sensor, satellites_, calendar_, frame_, seed, name));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* starfire = std::get_if<StarFireConfiguration>(&configuration.settings)) {
    sim::GnssParameters sensor = starfire->sensor;
    sensor.faults = signal_faults(starfire->faults);
    auto line = make_line(*starfire, context,
                          starfire->bus.empty() ? nullptr : &buses_.at(starfire->bus)->line);
    world_.add_gnss(line->enlist(executive_), mount(starfire->mount),
                    sim::GnssSensor(sensor, satellites_, calendar_, frame_, seed, name));
    devices_.push_back({name, std::move(line)});
  } else if (const VelodyneConfiguration* lidar = as_velodyne(configuration.settings)) {
    auto line = make_line(*lidar, context);
    const emulators::LidarBackend& backend = line->backend();
    auto sensor = make_lidar_sensor(
        lidar->sensor, {backend.pattern(), line->device().sample_plan(), backend.command()}, seed,
        name);
    world_.add_lidar(line->enlist(executive_), mount(lidar->mount), std::move(sensor),
                     backend.pattern());
    if (const auto motion = line->enlist_motion(executive_)) {
      world_.add_imu(*motion, mount(lidar->mount),
                     sim::ImuSensor(sim::perfect_imu(), seed, name + "/motion"));
    }
    devices_.push_back({name, std::move(line)});
  } else if (const auto* imu = as_kind<OpenImuDeviceConfiguration>(configuration.settings)) {
    auto line = make_line(*imu, buses_.at(imu->bus)->line);
    world_.add_imu(line->enlist(executive_), mount(imu->mount),
                   sim::ImuSensor(imu->sensor, seed, name),
                   make_magnetometer(imu->magnetometer, seed, name));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* mti = std::get_if<XsensMtiConfiguration>(&configuration.settings)) {
    auto line = make_line(*mti, context, buses_.at(mti->bus)->line);
    world_.add_imu(line->enlist(executive_), mount(mti->mount),
                   sim::ImuSensor(mti->sensor, seed, name),
                   make_magnetometer(mti->magnetometer, seed, name));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* encoder =
                 std::get_if<EncoderDeviceConfiguration>(&configuration.settings)) {
    auto line = make_line(*encoder, buses_.at(encoder->bus)->line);
    const auto link = [this](const std::string& link_name) {
      return sensor_mount(configuration_.machine, {link_name, {}, {}}).link;
    };
    world_.add_encoder(line->enlist(executive_), link(encoder->base), link(encoder->link),
                       sim::JointAngle(encoder->axis - 'x'));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* gateway =
                 std::get_if<VehicleGatewayDeviceConfiguration>(&configuration.settings)) {
    auto line = make_line(*gateway, buses_.at(gateway->bus)->line);
    world_.add_vehicle(line->enlist(executive_),
                       sim::VehicleSensors(gateway->sensor, gateway->odometry, seed, name));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* block = std::get_if<IsoValvesConfiguration>(&configuration.settings)) {
    auto line = make_line(*block, buses_.at(block->bus)->line);
    world_.add_valves(line->enlist(executive_));
    devices_.push_back({name, std::move(line)});
  } else if (const auto* joystick =
                 std::get_if<UsbJoystickConfiguration>(&configuration.settings)) {
    auto line = make_line(*joystick, usb(), name);
    line->enlist(executive_);
    devices_.push_back({name, std::move(line)});
  } else if (const auto* real = std::get_if<UsbPassThroughConfiguration>(&configuration.settings)) {
    devices_.push_back({name, make_line(*real, io_, usb(), name)});
  } else {
    const auto& valves = std::get<ValveDriverConfiguration>(configuration.settings);
    auto line = make_line(valves, context,
                          valves.line.empty() ? nullptr : modbus_lines_.at(valves.line).get());
    world_.add_valves(line->enlist(executive_));
    devices_.push_back({name, std::move(line)});
  }
}

void Rig::connect_receivers() {
  for (const Device& device : devices_) {
    auto* listener = dynamic_cast<FixListener*>(device.line.get());
    if (listener == nullptr) {
      continue;
    }
    const DeviceSettings& settings = configuration_.devices.at(device.name).settings;
    const VelodyneConfiguration* lidar = as_velodyne(settings);
    const std::string& source =
        lidar != nullptr ? lidar->time_source
                         : std::get<VehicleGatewayDeviceConfiguration>(settings).position_from;
    for (const Device& candidate : devices_) {
      auto* gnss = dynamic_cast<GnssLine*>(candidate.line.get());
      const bool wanted =
          (lidar != nullptr && source == VelodyneConfiguration::kAutomaticTimeSource) ||
          source == candidate.name;
      if (gnss != nullptr && wanted) {
        gnss->inform(*listener);
        break;
      }
    }
  }
}

std::vector<std::string> Rig::wires() const {
  std::vector<std::string> lines;
  for (const auto& [name, bus] : buses_) {
    lines.push_back(
        fmt::format("bus {}: {} ({})", name, bus->line.endpoint().address, bus->hop.choice.why));
  }
  return lines;
}

void Rig::connect_joysticks() {
  const auto valves = [this]() -> const emulators::ValveBackend* {
    for (const Device& device : devices_) {
      if (const auto* found =
              dynamic_cast<const emulators::ValveBackend*>(&device.line->device())) {
        return found;
      }
    }
    return nullptr;
  }();
  for (const Device& device : devices_) {
    auto* joystick = dynamic_cast<JoystickLine*>(device.line.get());
    if (joystick != nullptr && valves != nullptr) {
      joystick->follow(*valves);
    }
  }
}

UsbBus& Rig::usb() {
  if (usb_ == nullptr) {
    usb_ = std::make_unique<UsbServerLine>(configuration_.usb, io_, executive_);
  }
  return *usb_;
}

RigStatus Rig::status() const {
  RigStatus status;
  status.now = executive_.now();
  status.machine = executive_.machine_state();
  for (const Device& device : devices_) {
    status.devices.push_back(device.line->status(device.name, status.now));
  }
  return status;
}

std::vector<DeviceReport> Rig::device_reports() const {
  std::vector<DeviceReport> reports;
  for (const Device& device : devices_) {
    DeviceReport report{device.name, device.line->endpoint().address, device.line->frames(),
                        device.line->statistics()};
    report.statistics.dropped = device.line->dropped();
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace rigwire::hil
