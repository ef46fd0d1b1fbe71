#include "hil/world/gnss.h"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hil/world/truth_observer.h"
#include "sim/scene/scene.h"

namespace rigwire::hil {
namespace {

class WorldGnss final : public WorldSensor {
 public:
  /// On a link of the machine, or on the ground.
  using Place = std::variant<SensorMount, Eigen::Vector3d>;

  WorldGnss(StationIndex station, std::string_view name, const Place& place,
            const sim::LocalFrame& frame, sim::GnssSensor sensor)
      : station_(station),
        name_(name),
        place_(place),
        frame_(frame),
        sensor_(std::move(sensor)),
        instants_(station) {}

  void take(SimTime frontier, const Shelves& requests) override {
    instants_.take(frontier, requests);
    if (const auto* commands = requests.find<GnssCommand>(station_)) {
      for (const GnssCommand& command : *commands) {
        sensor_.command(command);
      }
    }
    if (const auto* changes = requests.find<FaultChange<sim::GnssFault>>(station_)) {
      for (const FaultChange<sim::GnssFault>& change : *changes) {
        change.apply(sensor_.faults());
      }
    }
  }

  void step(const WorldStep& step, Shelves& /*samples*/) override {
    for (; instants_.next() <= step.t1; instants_.pass()) {
      due_.push_back({instants_.next(), motion(step, instants_.next())});
    }
  }

  [[nodiscard]] bool looks_at_scene() const override { return !due_.empty(); }
  void slice(const WorldSlice& slice, Shelves& samples) override {
    if (due_.empty()) {
      return;
    }
    std::vector<GnssSample>& shelf = samples.of<GnssSample>(station_);
    for (const Epoch& epoch : due_) {
      shelf.push_back(sensor_.sample(epoch.time, epoch.motion, slice.scene));
    }
    due_.clear();
  }

  void tell(const WorldStep& step, SimTime time, TruthRecord& truth) const override {
    truth.antennas.push_back({name_, frame_.to_geodetic(motion(step, time).X_WL.translation())});
  }

 private:
  /// An epoch that waits until the scene is in its state at the end of the slice.
  struct Epoch {
    SimTime time;
    sim::LinkMotion motion;
  };

  [[nodiscard]] sim::LinkMotion motion(const WorldStep& step, SimTime time) const {
    if (const auto* mount = std::get_if<SensorMount>(&place_)) {
      return step.motion(*mount, time);
    }
    sim::LinkMotion still;
    still.X_WL.translation() = std::get<Eigen::Vector3d>(place_);
    return still;
  }

  StationIndex station_;
  std::string name_;
  Place place_;
  sim::LocalFrame frame_;
  sim::GnssSensor sensor_;
  PlannedInstants instants_;
  std::vector<Epoch> due_;
};

}  // namespace

std::unique_ptr<WorldSensor> make_world_gnss(StationIndex station, std::string_view name,
                                             const SensorMount& mount, const sim::LocalFrame& frame,
                                             sim::GnssSensor sensor) {
  return std::make_unique<WorldGnss>(station, name, mount, frame, std::move(sensor));
}

std::unique_ptr<WorldSensor> make_world_gnss(StationIndex station, std::string_view name,
                                             const Eigen::Vector3d& p_W,
                                             const sim::LocalFrame& frame, sim::GnssSensor sensor) {
  return std::make_unique<WorldGnss>(station, name, p_W, frame, std::move(sensor));
}

}  // namespace rigwire::hil
