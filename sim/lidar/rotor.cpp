#include "sim/lidar/rotor.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

Rotor::Rotor(const LidarCommand& command) {
  this->command(kStart, command);
}

void Rotor::command(SimTime time, const LidarCommand& command) {
  if (!std::isfinite(command.rotor_rate_radps)) {
    throw std::invalid_argument("lidar rotor: its rate is not a finite number");
  }
  changed_ = at(time);
  changed_at_ = time;
  changed_.rate_radps = command.rotor_rate_radps;
}

RotorState Rotor::at(SimTime time) const {
  RotorState state = changed_;
  const double azimuth =
      std::fmod(changed_.azimuth_rad + changed_.rate_radps * to_seconds(time - changed_at_), kTurn);
  state.azimuth_rad = azimuth < 0.0 ? azimuth + kTurn : azimuth;
  return state;
}

}  // namespace rigwire::sim
