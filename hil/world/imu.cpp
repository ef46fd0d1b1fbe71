#include "hil/world/imu.h"

#include <utility>

namespace rigwire::hil {
namespace {

class WorldImu final : public StepSensor<ImuSample> {
 public:
  WorldImu(StationIndex station, const SensorMount& mount, sim::ImuSensor sensor,
           std::optional<sim::Magnetometer> magnetometer)
      : StepSensor(station),
        mount_(mount),
        sensor_(std::move(sensor)),
        magnetometer_(std::move(magnetometer)) {}

 private:
  ImuSample measure(const WorldStep& step, SimTime time) override {
    const sim::LinkMotion motion = step.motion(mount_, time);
    ImuSample sample = sensor_.sample(time, motion, step.gravity_mps2);
    if (magnetometer_) {
      sample.magnetic_field_t = magnetometer_->sample(time, motion, 0.0).field_t;
    }
    return sample;
  }

  SensorMount mount_;
  sim::ImuSensor sensor_;
  std::optional<sim::Magnetometer> magnetometer_;
};

}  // namespace

std::unique_ptr<WorldSensor> make_world_imu(StationIndex station, const SensorMount& mount,
                                            sim::ImuSensor sensor,
                                            std::optional<sim::Magnetometer> magnetometer) {
  return std::make_unique<WorldImu>(station, mount, std::move(sensor), std::move(magnetometer));
}

}  // namespace rigwire::hil
