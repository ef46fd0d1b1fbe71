#include "emulators/j1939/engine_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "protocols/vehicle/condition.h"

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::is;
using vehicle::kNotAvailable;
using vehicle::reading;

namespace {

constexpr double kRuns_radps = 300.0 * vehicle::kRevolutionPerMinute_radps;

double indicated_nm(const EngineSample& sample) {
  return std::max(0.0, sample.torque_nm + sample.friction_nm);
}

}  // namespace

EngineReport::EngineReport(const EngineData& engine, Duration hours)
    : engine_(engine), running_s_(to_seconds(hours)) {}

void EngineReport::take(SimTime time, const EngineSample& sample) {
  if (taken_ && sample.speed_radps >= kRuns_radps) {
    // Hours and turns by the rectangle rule over the samples.
    const double past_s = to_seconds(time - *taken_);
    running_s_ += past_s;
    turns_ += sample.speed_radps * past_s / (2.0 * std::numbers::pi);
  }
  taken_ = time;
}

double EngineReport::share(double torque_nm) const {
  const double reference_nm = engine_.reference_torque_nm;
  return reference_nm > 0.0 ? reading(torque_nm / reference_nm) : kNotAvailable;
}

double EngineReport::torque_share(const EngineSample& sample) const {
  return share(indicated_nm(sample));
}

double EngineReport::load_share(const EngineSample& sample) {
  const double most_nm = sample.full_load_nm + sample.friction_nm;
  return most_nm > 0.0 ? reading(indicated_nm(sample) / most_nm) : kNotAvailable;
}

std::optional<protocols::can::Frame> EngineReport::frame(std::uint32_t pgn, std::uint8_t source,
                                                         const EngineSample* sample) const {
  const bool known = sample != nullptr;
  const EngineSample engine = known ? *sample : EngineSample{};
  if (is<vehicle::Eec3>(pgn)) {
    return vehicle::encode(
        known ? vehicle::Eec3{share(engine.friction_nm), engine.desired_radps} : vehicle::Eec3{},
        source);
  }
  if (is<vehicle::Eflp1>(pgn)) {
    return vehicle::encode(vehicle::Eflp1{engine.fuel_pressure_pa, engine.oil_level_share,
                                          engine.oil_pressure_pa, engine.coolant_level_share},
                           source);
  }
  if (is<vehicle::Et1>(pgn)) {
    return vehicle::encode(vehicle::Et1{engine.coolant_c, kNotAvailable, engine.oil_c}, source);
  }
  if (is<vehicle::Dd1>(pgn)) {
    return vehicle::encode(vehicle::Dd1{kNotAvailable, engine.fuel_level_share}, source);
  }
  if (is<vehicle::Vep1>(pgn)) {
    return vehicle::encode(vehicle::Vep1{engine.battery_a, engine.alternator_a, engine.battery_v,
                                         engine.battery_v, engine.battery_v},
                           source);
  }
  if (is<vehicle::Lfe1>(pgn)) {
    return vehicle::encode(vehicle::Lfe1{engine.fuel_rate_m3ps}, source);
  }
  if (is<vehicle::Lfc1>(pgn)) {
    return vehicle::encode(vehicle::Lfc1{engine.fuel_used_m3, engine.fuel_used_m3}, source);
  }
  if (is<vehicle::Hours>(pgn)) {
    return vehicle::encode(vehicle::Hours{running_s_, turns_}, source);
  }
  return std::nullopt;
}

void EngineReport::send_due(J1939Node& node, SimTime now, std::uint64_t tick) {
  constexpr auto kPeriodTicks = static_cast<std::uint64_t>(vehicle::kEngineConfigurationPeriod /
                                                           std::chrono::milliseconds{10});
  constexpr std::uint64_t kPhaseTicks = 70;
  configuration_due_ = configuration_due_ || tick % kPeriodTicks == kPhaseTicks;
  if (configuration_due_) {
    configuration_due_ =
        send_configuration(node, now, protocols::j1939::kGlobalAddress) == J1939Answer::busy;
  }
}

J1939Answer EngineReport::send_configuration(J1939Node& node, SimTime now,
                                             std::uint8_t destination) const {
  const auto payload = configuration();
  return payload ? node.send_answer(now, vehicle::kEngineConfigurationPgn, destination, *payload)
                 : J1939Answer::unknown;
}

std::optional<std::array<std::uint8_t, vehicle::kEngineConfigurationBytes>>
EngineReport::configuration() const {
  const double reference_nm = engine_.reference_torque_nm;
  if (!(reference_nm > 0.0)) {
    return std::nullopt;
  }
  vehicle::EngineConfiguration configuration;
  // Idle, the end of full load, then the points between them.
  constexpr std::array<std::size_t, EngineData::kPoints> kOrder{0, EngineData::kPoints - 1, 1, 2,
                                                                3};
  static_assert(EngineData::kPoints == vehicle::EngineConfiguration::kPoints);
  for (std::size_t i = 0; i < kOrder.size(); ++i) {
    const EnginePoint& point = engine_.full_load[kOrder[i]];
    configuration.speed_radps[i] = point.speed_radps;
    configuration.torque_share[i] = (point.torque_nm + point.friction_nm) / reference_nm;
  }
  configuration.high_idle_radps = engine_.high_idle_radps;
  configuration.governor_gain_prad = engine_.governor_nmsprad / reference_nm;
  configuration.reference_torque_nm = reference_nm;
  configuration.least_speed_radps = engine_.full_load.front().speed_radps;
  configuration.greatest_speed_radps = engine_.full_load.back().speed_radps;
  configuration.least_torque_share = 0.0;
  configuration.greatest_torque_share = 1.0;
  configuration.inertia_kgm2 = engine_.inertia_kgm2;
  return vehicle::encode_engine_configuration(configuration);
}

bool TorqueSpeedCheck::passes(const protocols::can::Frame& frame,
                              const protocols::vehicle::Tsc1& request, std::uint8_t source) {
  constexpr std::uint8_t kNotUsed = 0xF;
  constexpr std::uint8_t kGreatestCounter = 7;
  if (request.counter == kNotUsed && request.checksum == kNotUsed) {
    counters_[source] = kNone;
    return !required_;
  }
  const std::uint8_t last = std::exchange(counters_[source], request.counter);
  return request.counter != last && request.counter <= kGreatestCounter &&
         request.checksum == protocols::vehicle::torque_speed_checksum(frame);
}

}  // namespace rigwire::emulators
