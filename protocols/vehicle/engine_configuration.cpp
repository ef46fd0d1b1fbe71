#include "protocols/vehicle/engine_configuration.h"

#include "protocols/vehicle/engine.h"

namespace rigwire::protocols::vehicle {
namespace {

using Configuration = EngineConfiguration;

struct Row {
  can::Signal signal;
  double& (*member)(Configuration&);
};

/// Speed of ten rpm a count, in one byte.
constexpr Scale kCoarseSpeed{10.0 * kRevolutionPerMinute_radps, 0.0, "rad/s"};
/// 0.00078125 % per rpm.
constexpr Scale kGain{0.00078125 * kPercent / kRevolutionPerMinute_radps, 0.0, "s/rad"};
constexpr Scale kTorque{1.0, 0.0, "N m"};
constexpr Scale kInertia{0.004, 0.0, "kg m2"};

template <std::size_t point>
double& speed(Configuration& c) {
  return c.speed_radps[point];
}
template <std::size_t point>
double& torque(Configuration& c) {
  return c.torque_share[point];
}
template <double Configuration::*of>
double& member(Configuration& c) {
  return c.*of;
}

constexpr std::array kLayout{
    Row{number_signal("speed at point 1", 188, {1}, 16, kShaftSpeed), speed<0>},
    Row{number_signal("torque at point 1", 539, {3}, 8, kTorqueShare), torque<0>},
    Row{number_signal("speed at point 2", 528, {4}, 16, kShaftSpeed), speed<1>},
    Row{number_signal("torque at point 2", 540, {6}, 8, kTorqueShare), torque<1>},
    Row{number_signal("speed at point 3", 529, {7}, 16, kShaftSpeed), speed<2>},
    Row{number_signal("torque at point 3", 541, {9}, 8, kTorqueShare), torque<2>},
    Row{number_signal("speed at point 4", 530, {10}, 16, kShaftSpeed), speed<3>},
    Row{number_signal("torque at point 4", 542, {12}, 8, kTorqueShare), torque<3>},
    Row{number_signal("speed at point 5", 531, {13}, 16, kShaftSpeed), speed<4>},
    Row{number_signal("torque at point 5", 543, {15}, 8, kTorqueShare), torque<4>},
    Row{number_signal("speed at high idle", 532, {16}, 16, kShaftSpeed),
        member<&Configuration::high_idle_radps>},
    Row{number_signal("governor gain", 545, {18}, 16, kGain),
        member<&Configuration::governor_gain_prad>},
    Row{number_signal("reference torque", 544, {20}, 16, kTorque),
        member<&Configuration::reference_torque_nm>},
    Row{number_signal("requested speed, least", 535, {25}, 8, kCoarseSpeed),
        member<&Configuration::least_speed_radps>},
    Row{number_signal("requested speed, greatest", 536, {26}, 8, kCoarseSpeed),
        member<&Configuration::greatest_speed_radps>},
    Row{number_signal("requested torque, least", 537, {27}, 8, kTorqueShare),
        member<&Configuration::least_torque_share>},
    Row{number_signal("requested torque, greatest", 538, {28}, 8, kTorqueShare),
        member<&Configuration::greatest_torque_share>},
    Row{number_signal("moment of inertia", 1794, {31}, 16, kInertia),
        member<&Configuration::inertia_kgm2>},
};

}  // namespace

std::array<std::uint8_t, kEngineConfigurationBytes> encode_engine_configuration(
    const EngineConfiguration& configuration) {
  std::array<std::uint8_t, kEngineConfigurationBytes> payload;
  payload.fill(0xFF);
  EngineConfiguration values = configuration;
  for (const Row& row : kLayout) {
    can::put(row.signal, payload, row.member(values));
  }
  return payload;
}

Decoded<EngineConfiguration> decode_engine_configuration(std::span<const std::uint8_t> payload) {
  constexpr std::size_t kOldest = 28;  // editions before the moment of inertia
  if (payload.size() < kOldest) {
    return Malformed{"the message has at least 28 bytes", payload.size()};
  }
  EngineConfiguration configuration;
  for (const Row& row : kLayout) {
    const can::Reading reading = can::get(row.signal, payload);
    row.member(configuration) = reading.valid() ? reading.value : kNotAvailable;
  }
  return {configuration, payload.size()};
}

}  // namespace rigwire::protocols::vehicle
