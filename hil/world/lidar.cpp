#include "hil/world/lidar.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/world/truth_observer.h"
#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {

namespace {

constexpr std::array<fields::Choice<LidarMethod>, 2> kLidarMethods{
    {{LidarMethod::rays, "rays", "Every shot is a ray at its own instant."},
     {LidarMethod::depth_image, "depth_image", "Shots are read from images of virtual cameras."}}};

}  // namespace

void visit(fields::Visitor& v, LidarSensorConfiguration& p) {
  v.choice("method", p.method, kLidarMethods, "How shots are simulated.");
  visit(v, p.beam);
  v.only_if(p.method == LidarMethod::depth_image, "method", "method: depth_image",
            [&p](fields::Visitor& w) { w.section("images", p.images, "Virtual cameras."); });
  v.section("rotor", p.rotor, "The head's motor.");
}

void validate(const LidarSensorConfiguration& configuration) {
  fields::check(configuration);
  validate(configuration.beam);
}
namespace {

class WorldLidar final : public WorldSensor {
 public:
  WorldLidar(StationIndex station, std::string_view name, const SensorMount& mount,
             std::unique_ptr<sim::LidarSensor> sensor, LidarPattern pattern)
      : station_(station),
        name_(name),
        mount_(mount),
        sensor_(std::move(sensor)),
        pattern_(std::move(pattern)) {}

  void take(SimTime frontier, const Shelves& requests) override {
    if (const auto* commands = requests.find<LidarCommand>(station_)) {
      for (const LidarCommand& command : *commands) {
        sensor_->command(frontier, command);
      }
    }
  }

  void slice(const WorldSlice& slice, Shelves& samples) override {
    std::vector<LidarFiring>& firings = samples.of<LidarFiring>(station_);
    const bool told = slice.lidar_truth != nullptr;
    sensor_->cast(slice.scene,
                  {.t0 = slice.t0,
                   .t1 = slice.t1,
                   .mount_at_t0 = sim::at_mount(slice.links_at_t0[mount_.link], mount_.X_LS),
                   .mount_at_t1 = sim::at_mount(slice.links_at_t1[mount_.link], mount_.X_LS)},
                  slice.weather, firings, told ? &truth_ : nullptr);
    if (told) {
      slice.lidar_truth->record(name_, pattern_, firings, truth_);
    }
  }

  [[nodiscard]] bool casts_beams() const override { return true; }

 private:
  StationIndex station_;
  std::string name_;
  SensorMount mount_;
  std::unique_ptr<sim::LidarSensor> sensor_;
  LidarPattern pattern_;
  std::vector<sim::LidarBankTruth> truth_;  ///< Shots of one slice.
};

}  // namespace

std::unique_ptr<sim::LidarSensor> make_lidar_sensor(const LidarSensorConfiguration& configuration,
                                                    const LidarHead& head, std::uint64_t seed,
                                                    std::string_view name) {
  if (configuration.method == LidarMethod::depth_image) {
    return std::make_unique<sim::DepthImageLidar>(configuration.images, configuration.beam,
                                                  head.pattern, head.plan, head.command, seed, name,
                                                  configuration.rotor);
  }
  return std::make_unique<sim::SpinningLidar>(configuration.beam, head.pattern, head.plan,
                                              head.command, seed, name, configuration.rotor);
}

std::unique_ptr<WorldSensor> make_world_lidar(StationIndex station, std::string_view name,
                                              const SensorMount& mount,
                                              std::unique_ptr<sim::LidarSensor> sensor,
                                              LidarPattern pattern) {
  return std::make_unique<WorldLidar>(station, name, mount, std::move(sensor), std::move(pattern));
}

}  // namespace rigwire::hil
