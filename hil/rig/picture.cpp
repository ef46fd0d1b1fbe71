#include "hil/rig/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "hil/devices/gige_camera.h"
#include "hil/rig/rig.h"
#include "hil/world/camera.h"
#include "hil/world/simulated_world.h"
#include "hil/world/truth_observer.h"

namespace rigwire::hil {
namespace {

/// Before the one that is wanted, for automatic exposure.
constexpr int kPicturesBefore = 32;
/// The only one.
constexpr StationIndex kStation = 0;

/// Keeps the one picture that is wanted, with what is true behind it.
class PictureKeeper final : public CameraTruthObserver {
 public:
  PictureKeeper(SimTime wanted, std::optional<CameraTruthRecord>& kept)
      : wanted_(wanted), kept_(kept) {}

  [[nodiscard]] bool wants(std::string_view /*camera*/, SimTime start) const override {
    return start == wanted_;
  }
  void record(std::string_view /*camera*/, CameraTruthRecord record) override {
    kept_ = std::move(record);
  }

 private:
  SimTime wanted_;
  std::optional<CameraTruthRecord>& kept_;
};

/// By instance, as far as the picture shows them.
std::vector<std::string> labels_in(const sim::CameraTruth& truth, const sim::Scene& scene) {
  std::vector<std::string> labels;
  for (const std::uint32_t instance : truth.instance) {
    if (instance >= scene.instance_count()) {
      continue;
    }
    if (instance >= labels.size()) {
      labels.resize(instance + 1);
    }
    labels[instance] = scene.label(instance);
  }
  return labels;
}

std::map<std::string, const GigeCameraConfiguration*> cameras_of(const RigConfiguration& rig) {
  std::map<std::string, const GigeCameraConfiguration*> cameras;
  for (const auto& [name, device] : rig.devices) {
    if (const auto* camera = fields::as<GigeCameraConfiguration>(device)) {
      cameras.emplace(name, camera);
    }
  }
  return cameras;
}

/// Its name and what it is.
std::pair<std::string, const GigeCameraConfiguration*> find_camera(const RigConfiguration& rig,
                                                                   const std::string& name) {
  const auto cameras = cameras_of(rig);
  if (cameras.empty()) {
    throw std::invalid_argument("the rig has no camera, found 0, allowed 1 or more");
  }
  std::vector<std::string> names;
  for (const auto& [camera, configuration] : cameras) {
    names.push_back(camera);
  }
  if (name.empty() && cameras.size() == 1) {
    return *cameras.begin();
  }
  const auto found = cameras.find(name);
  if (found == cameras.end()) {
    throw std::invalid_argument(fmt::format(
        "camera: found {}, allowed {}",
        name.empty() ? fmt::format("{} of them", cameras.size()) : fmt::format("\"{}\"", name),
        fmt::join(names, ", ")));
  }
  return *found;
}

/// Returns the command at power-on, with every part that this kind of camera makes.
CameraCommand command_of(const GigeCameraConfiguration& camera) {
  const sim::CameraAbilities abilities = sim::abilities_of(camera.sensor);
  CameraCommand command = power_on_command(camera);
  command.intensity = abilities.parts.intensity;
  command.intensity_right = abilities.parts.intensity_right;
  command.disparity = abilities.parts.disparity;
  command.range = abilities.parts.range;
  command.confidence = abilities.parts.confidence;
  return command;
}

/// Pictures up to the one that is wanted: at the camera's rate, or quicker where there is no time
/// for enough of them, but not so that they are exposed for less long.
SamplePlan plan_of(const CameraCommand& command, const GigeCameraConfiguration& camera,
                   SimTime at) {
  const Duration room = at - kStart;
  const Duration period = std::min(
      camera.camera.frame_period,
      std::max(room / kPicturesBefore, sim::optics_of(camera.sensor).auto_exposure.longest));
  const bool settles = command.exposure_auto || command.gain_auto;
  const auto before = settles ? std::min<Duration::rep>(room / period, kPicturesBefore) : 0;
  return {at - before * period, period};
}

void drive(sim::Machine& machine, double travel_mps) {
  if (machine.vehicle_port() == nullptr) {
    throw std::invalid_argument(
        fmt::format("travel: found {:g} m/s, allowed for machines that drive alone", travel_mps));
  }
  VehicleCommand command;
  command.travel_speed_mps = travel_mps;
  command.automatic_gear = true;
  command.parking_brake = false;
  machine.vehicle_port()->command(command);
}

}  // namespace

TakenPicture take_picture(const RigConfiguration& configuration, const PictureRequest& request,
                          RunLog* log) {
  const auto [name, camera] = find_camera(configuration, request.device);
  if (request.at < kStart) {
    throw std::invalid_argument(fmt::format("at: found {}, allowed 0 s or later",
                                            fields::print_duration((request.at - kStart).count())));
  }
  std::optional<CameraTruthRecord> kept;
  SimulatedWorld world = make_world(configuration, log);
  world.set_camera_truth_observer(std::make_unique<PictureKeeper>(request.at, kept));
  WorldCameraSettings settings;
  settings.name = name;
  settings.mount = sensor_mount(configuration.machine, camera->mount);
  settings.sees_own_link = camera->sees_own_link;
  settings.auto_exposure = sim::optics_of(camera->sensor).auto_exposure;
  world.add(make_world_camera(kStation, settings, world.scene(), world.terrain(),
                              make_surroundings(configuration), [&, camera = camera, name = name] {
                                return sim::make_camera(camera->sensor, configuration.seed, name);
                              }));
  if (request.travel_mps) {
    drive(world.machine(), *request.travel_mps);
  }

  const CameraCommand command = command_of(*camera);
  TruthRequests requests;
  SampleBatch batch;
  requests.of<CameraCommand>(kStation).push_back(command);
  requests.of<SamplePlan>(kStation).push_back(plan_of(command, *camera, request.at));
  world.begin(false);
  while (!kept) {
    if (const auto fault = world.advance(requests, batch)) {
      throw std::runtime_error(*fault);
    }
    requests.clear();
    if (batch.until >= request.at && batch.from < request.at) {
      requests.of<SamplePlan>(kStation).push_back({});
    }
  }
  std::vector<std::string> labels = labels_in(kept->truth, world.scene());
  return {name,
          {std::move(kept->picture), std::move(kept->truth), std::move(labels),
           sim::abilities_of(camera->sensor).geometry}};
}

}  // namespace rigwire::hil
