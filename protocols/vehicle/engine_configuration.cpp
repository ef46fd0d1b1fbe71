#include "protocols/vehicle/engine_configuration.h"

#include "protocols/vehicle/engine.h"

namespace rigwire::protocols::vehicle {
namespace {

using Configuration = EngineConfiguration;

/// A number from that byte on (from 1).
struct Row {
  unsigned byte;
  j1939::Field field;
  double& (*member)(Configuration&);
};

constexpr j1939::Field field(std::string_view name, std::uint16_t spn, std::uint8_t width,
                             const Scale& scale) {
  return {name,
          spn,
          0,
          width,
          scale.count,
          scale.offset,
          scale.offset,
          scale.offset + j1939::greatest_valid(width) * scale.count,
          scale.unit};
}

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

constexpr std::array kRows{
    Row{1, field("speed at point 1", 188, 16, kShaftSpeed), speed<0>},
    Row{3, field("torque at point 1", 539, 8, kTorqueShare), torque<0>},
    Row{4, field("speed at point 2", 528, 16, kShaftSpeed), speed<1>},
    Row{6, field("torque at point 2", 540, 8, kTorqueShare), torque<1>},
    Row{7, field("speed at point 3", 529, 16, kShaftSpeed), speed<2>},
    Row{9, field("torque at point 3", 541, 8, kTorqueShare), torque<2>},
    Row{10, field("speed at point 4", 530, 16, kShaftSpeed), speed<3>},
    Row{12, field("torque at point 4", 542, 8, kTorqueShare), torque<3>},
    Row{13, field("speed at point 5", 531, 16, kShaftSpeed), speed<4>},
    Row{15, field("torque at point 5", 543, 8, kTorqueShare), torque<4>},
    Row{16, field("speed at high idle", 532, 16, kShaftSpeed),
        member<&Configuration::high_idle_radps>},
    Row{18, field("governor gain", 545, 16, kGain), member<&Configuration::governor_gain_prad>},
    Row{20, field("reference torque", 544, 16, kTorque),
        member<&Configuration::reference_torque_nm>},
    Row{25, field("requested speed, least", 535, 8, kCoarseSpeed),
        member<&Configuration::least_speed_radps>},
    Row{26, field("requested speed, greatest", 536, 8, kCoarseSpeed),
        member<&Configuration::greatest_speed_radps>},
    Row{27, field("requested torque, least", 537, 8, kTorqueShare),
        member<&Configuration::least_torque_share>},
    Row{28, field("requested torque, greatest", 538, 8, kTorqueShare),
        member<&Configuration::greatest_torque_share>},
    Row{31, field("moment of inertia", 1794, 16, kInertia), member<&Configuration::inertia_kgm2>},
};

}  // namespace

std::array<std::uint8_t, kEngineConfigurationBytes> encode_engine_configuration(
    const EngineConfiguration& configuration) {
  std::array<std::uint8_t, kEngineConfigurationBytes> payload;
  payload.fill(0xFF);
  EngineConfiguration values = configuration;
  for (const Row& row : kRows) {
    j1939::encode(row.field, std::span(payload).subspan(row.byte - 1), row.member(values));
  }
  return payload;
}

Decoded<EngineConfiguration> decode_engine_configuration(std::span<const std::uint8_t> payload) {
  constexpr std::size_t kOldest = 28;  // editions before the moment of inertia
  if (payload.size() < kOldest) {
    return Malformed{"the message has at least 28 bytes", payload.size()};
  }
  EngineConfiguration configuration;
  for (const Row& row : kRows) {
    const bool there = row.byte - 1 < payload.size();
    const j1939::Reading reading =
        there ? j1939::decode(row.field, payload.subspan(row.byte - 1)) : j1939::Reading{};
    row.member(configuration) = reading.valid() ? reading.value : kNotAvailable;
  }
  return {configuration, payload.size()};
}

}  // namespace rigwire::protocols::vehicle
