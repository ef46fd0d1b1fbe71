#include "hil/world/surroundings.h"

#include <utility>

#include "emulators/device.h"

namespace rigwire::hil {
namespace {

class NoDevice final : public emulators::Device {
 public:
  void advance(SimTime /*now*/) override {}
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
};

NoDevice& no_device() {
  static NoDevice device;
  return device;
}

/// take(change) for each that has come.
template <class Fault, class Take>
void each_change(const Shelves& requests, StationIndex station, const Take& take) {
  if (const auto* changes = requests.find<FaultChange<Fault>>(station)) {
    for (const FaultChange<Fault>& change : *changes) {
      take(change);
    }
  }
}

class WorldAir final : public WorldSensor {
 public:
  WorldAir(StationIndex station, std::shared_ptr<sim::AirFaults> faults,
           std::function<void(SimTime)> before_the_first)
      : station_(station),
        faults_(std::move(faults)),
        before_the_first_(std::move(before_the_first)) {}

  [[nodiscard]] bool looks_at_scene() const override { return false; }
  void take(SimTime frontier, const Shelves& requests) override {
    each_change<sim::AirFault>(requests, station_, [this, frontier](const auto& change) {
      std::exchange(before_the_first_, [](SimTime) {})(frontier);
      faults_->apply(change);
    });
  }

 private:
  StationIndex station_;
  std::shared_ptr<sim::AirFaults> faults_;
  std::function<void(SimTime)> before_the_first_;
};

class WorldPowerUnitFaults final : public WorldSensor {
 public:
  WorldPowerUnitFaults(StationIndex station, sim::PowerUnitDefectPort& port,
                       const SurroundingsConfiguration& faults)
      : station_(station),
        port_(port),
        engine_(faults.engine.faults),
        pumps_(faults.pumps.faults) {}

  [[nodiscard]] bool looks_at_scene() const override { return false; }
  void take(SimTime frontier, const Shelves& requests) override {
    each_change<sim::EngineFault>(requests, station_,
                                  [this](const auto& change) { change.apply(engine_); });
    each_change<sim::PumpFault>(requests, station_,
                                [this](const auto& change) { change.apply(pumps_); });
    fail(frontier);
  }
  /// The next one begins where this one ends.
  void step(const WorldStep& step, Shelves& /*samples*/) override { fail(step.t1); }

 private:
  void fail(SimTime time) {
    const sim::PowerUnitDefects defects = sim::defects_at(time, engine_, pumps_);
    if (defects != told_) {
      told_ = defects;
      port_.fail(defects);
    }
  }

  StationIndex station_;
  sim::PowerUnitDefectPort& port_;
  FaultBook<sim::EngineFault> engine_;
  FaultBook<sim::PumpFault> pumps_;
  sim::PowerUnitDefects told_;
};

}  // namespace

SurroundingsStation::SurroundingsStation() : Station(no_device()) {}

std::unique_ptr<WorldSensor> make_world_air(StationIndex station,
                                            std::shared_ptr<sim::AirFaults> faults,
                                            std::function<void(SimTime)> before_the_first) {
  return std::make_unique<WorldAir>(station, std::move(faults), std::move(before_the_first));
}

std::unique_ptr<WorldSensor> make_world_power_unit_faults(StationIndex station,
                                                          sim::PowerUnitDefectPort& port,
                                                          const SurroundingsConfiguration& faults) {
  return std::make_unique<WorldPowerUnitFaults>(station, port, faults);
}

}  // namespace rigwire::hil
