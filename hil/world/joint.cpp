#include "hil/world/joint.h"

namespace rigwire::hil {
namespace {

class WorldJoint final : public StepSensor<EncoderSample> {
 public:
  WorldJoint(StationIndex station, std::size_t base, std::size_t moving, sim::JointAngle angle)
      : StepSensor(station), base_{base}, moving_{moving}, angle_(angle) {}

 private:
  EncoderSample measure(const WorldStep& step, SimTime time) override {
    return angle_.sample(time, step.motion(base_, time), step.motion(moving_, time));
  }

  SensorMount base_;
  SensorMount moving_;
  sim::JointAngle angle_;
};

}  // namespace

std::unique_ptr<WorldSensor> make_world_joint(StationIndex station, std::size_t base,
                                              std::size_t moving, sim::JointAngle angle) {
  return std::make_unique<WorldJoint>(station, base, moving, angle);
}

}  // namespace rigwire::hil
