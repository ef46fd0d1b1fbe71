#include "hil/world/view.h"

#include <cmath>
#include <utility>

#include "sim/scene/height_field.h"
#include "sim/scene/scene.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {
namespace {

AirView view_of(const sim::SceneWeather& weather, SimTime time) {
  const sim::AirState state = weather.state(time);
  AirView air{state.rain_mmph, state.snow_mmph, weather.even_extinction_pm(time), {}};
  for (const sim::DustPuff& puff : weather.dust().puffs()) {
    air.dust.push_back({puff.centre_W, std::sqrt(puff.variance_m2),
                        sim::middle_depth(puff, weather.dust_parameters())});
  }
  return air;
}

class WorldView final : public WorldSensor {
 public:
  WorldView(std::size_t links, Duration period, std::function<void(ViewChange)> told)
      : links_(links), period_(period), told_(std::move(told)) {}

  void take(SimTime /*frontier*/, const Shelves& /*requests*/) override {}

  [[nodiscard]] bool looks_at_scene() const override { return false; }
  void slice(const WorldSlice& slice, Shelves& /*samples*/) override {
    dug_.follow(slice);
    if (slice.t1 < next_) {
      return;
    }
    next_ = slice.t1 + period_;
    ViewChange change;
    change.time = slice.t1;
    change.dug = dug_.take(slice);
    const std::size_t bodies = slice.links_at_t1.size();
    const bool first = places_.empty();
    places_.resize(bodies, Eigen::Isometry3d::Identity());
    for (std::size_t body = links_; body < bodies; ++body) {
      const Eigen::Isometry3d& X_WB = slice.links_at_t1[body].X_WL;
      if (first || !X_WB.isApprox(places_[body], 1e-9)) {
        places_[body] = X_WB;
        change.moved.push_back({body, X_WB});
      }
    }
    const auto displaced = slice.scene.placement().displaced;
    if (displaced != displaced_) {
      displaced_ = displaced;
      change.displaced = sim::displaced_things(slice.scene.placement());
    }
    if (slice.weather != nullptr) {
      if (AirView air = view_of(*slice.weather, slice.t1); air != air_) {
        air_ = air;
        change.air = std::move(air);
      }
    }
    if (change.changes_the_scene() || change.air) {
      told_(std::move(change));
    }
  }

 private:
  std::size_t links_;
  Duration period_;
  std::function<void(ViewChange)> told_;
  SimTime next_ = kStart;
  DugNodes dug_;
  std::vector<Eigen::Isometry3d> places_;
  std::shared_ptr<const std::vector<sim::DisplacedPiece>> displaced_;
  AirView air_;
};

}  // namespace

std::unique_ptr<WorldSensor> make_world_view(std::size_t links, Duration period,
                                             std::function<void(ViewChange)> told) {
  return std::make_unique<WorldView>(links, period, std::move(told));
}

}  // namespace rigwire::hil
