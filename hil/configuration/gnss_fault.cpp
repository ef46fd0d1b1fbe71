#include "hil/configuration/gnss_fault.h"

#include <optional>

namespace rigwire::hil {
namespace {

using sim::GnssFault;
using sim::GnssFaultKind;

Eigen::Vector3d eigen(const Vector3& v) {
  return {v.x, v.y, v.z};
}

std::optional<GnssFault> of_kind(GnssFaultKind kind) {
  GnssFault fault;
  fault.kind = kind;
  return fault;
}

/// Nothing for faults of the device.
struct ToSignals {
  std::optional<GnssFault> operator()(const OutageFault&) const {
    return of_kind(GnssFaultKind::outage);
  }
  std::optional<GnssFault> operator()(const JammingFault& p) const {
    auto fault = of_kind(GnssFaultKind::jamming);
    fault->jamming_db = p.loss_db;
    return fault;
  }
  std::optional<GnssFault> operator()(const SpoofDriftFault& p) const {
    auto fault = of_kind(GnssFaultKind::spoof_drift);
    fault->drift_mps = eigen(p.velocity_mps);
    fault->clock_drift_mps = p.clock_rate_mps;
    return fault;
  }
  std::optional<GnssFault> operator()(const JumpFault& p) const {
    auto fault = of_kind(GnssFaultKind::jump);
    fault->offset_m = eigen(p.offset_m);
    return fault;
  }
  std::optional<GnssFault> operator()(const AntennaShortFault&) const {
    return of_kind(GnssFaultKind::antenna_short);
  }
  std::optional<GnssFault> operator()(const AntennaOpenFault&) const {
    return of_kind(GnssFaultKind::antenna_open);
  }
  std::optional<GnssFault> operator()(const CorrectionOutageFault&) const {
    return of_kind(GnssFaultKind::correction_outage);
  }
  template <class OfTheDevice>
  std::optional<GnssFault> operator()(const OfTheDevice&) const {
    return std::nullopt;
  }
};

using emulators::UbloxFault;
using emulators::UbloxFaultKind;

/// Nothing for faults of the surroundings.
struct ToUblox {
  std::optional<UbloxFault> operator()(const FrozenFixFault&) const {
    return UbloxFault{.kind = UbloxFaultKind::frozen_fix};
  }
  std::optional<UbloxFault> operator()(const WrongLeapSecondFault& p) const {
    return UbloxFault{.kind = UbloxFaultKind::wrong_leap_second,
                      .value = static_cast<double>(p.seconds)};
  }
  std::optional<UbloxFault> operator()(const UartNoiseFault& p) const {
    return UbloxFault{.kind = UbloxFaultKind::line_noise, .value = p.bit_error_rate};
  }
  template <class OfTheSurroundings>
  std::optional<UbloxFault> operator()(const OfTheSurroundings&) const {
    return std::nullopt;
  }
};

}  // namespace

std::vector<GnssFault> signal_faults(const std::vector<GnssFaultConfiguration>& faults) {
  std::vector<GnssFault> result;
  for (const GnssFaultConfiguration& configured : faults) {
    if (auto fault = std::visit(ToSignals{}, configured.settings)) {
      fault->start = configured.at;
      fault->duration = configured.length;
      result.push_back(*fault);
    }
  }
  return result;
}

std::vector<UbloxFault> ublox_faults(const std::vector<GnssFaultConfiguration>& faults) {
  std::vector<UbloxFault> result;
  for (const GnssFaultConfiguration& configured : faults) {
    if (auto fault = std::visit(ToUblox{}, configured.settings)) {
      fault->begin = configured.at;
      fault->end = configured.at + configured.length;
      result.push_back(*fault);
    }
  }
  return result;
}

}  // namespace rigwire::hil
