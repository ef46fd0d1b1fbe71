#include "sim/driveline/cvt_driveline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigwire::sim {
namespace {

constexpr double kUsed = 0.9;  // share of the engine's maximum speed before the next range

const CvtParameters& checked(const CvtParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

CvtDriveline::CvtDriveline(const CvtParameters& parameters)
    : ClutchedDriveline(checked(parameters).engine, parameters.clutch, parameters.axles),
      variator_(parameters.variator),
      variator_ratio_(parameters.variator.launch_ratio) {}

double CvtDriveline::range_ratio(int gear) const {
  if (gear == 0) {
    return 0.0;
  }
  return gear > 0 ? variator_.ranges[static_cast<std::size_t>(gear - 1)] : -variator_.reverse_range;
}

int CvtDriveline::select_gear(double rate_radps, double target_radps, int lower) const {
  const int ranges = static_cast<int>(variator_.ranges.size());
  if (target_radps < 0.0) {
    return variator_.reverse_range > 0.0 ? -1 : 0;
  }
  if (target_ > 0 && std::abs(rate_radps) >= variator_.range_change_radps) {
    return target_;
  }
  const double most = kUsed * engine().engine().parameters().maximum_radps;
  int range = 1;
  while (range < ranges && target_radps * axle_ratio() *
                                   variator_.ranges[static_cast<std::size_t>(range - 1)] *
                                   variator_.top_ratio >
                               most) {
    ++range;
  }
  return std::max(1, range - lower);
}

void CvtDriveline::request(const VehicleCommand& command) {
  const bool reverse_exists = variator_.reverse_range > 0.0;
  if (command.gear <= static_cast<int>(variator_.ranges.size()) &&
      command.gear >= (reverse_exists ? -1 : 0)) {
    target_ = command.gear;
  }
}

void CvtDriveline::advance(double h, double output_radps, Transmission& transmission) {
  const bool at_rest = std::abs(output_radps) < variator_.range_change_radps * axle_ratio();
  const bool clutch_open = engine().capacity_nm() <= 0.0 || gear_ == 0;
  const bool engine_slow = engine().idling();
  if (target_ != gear_ && (target_ == 0 || (at_rest && clutch_open && engine_slow))) {
    gear_ = target_;
  }

  // Flyweights: log ratio linear in engine speed, behind a first-order lag exact over h.
  const double launch = std::log(variator_.launch_ratio);
  const double top = std::log(variator_.top_ratio);
  const double way = std::clamp((engine().speed_radps() - variator_.shift_from_radps) /
                                    (variator_.shift_to_radps - variator_.shift_from_radps),
                                0.0, 1.0);
  const double wanted = launch + way * (top - launch);
  const double present = std::log(variator_ratio_);
  const double gain = variator_.lag_s > 0.0 ? -std::expm1(-h / variator_.lag_s) : 1.0;
  variator_ratio_ = std::exp(present + gain * (wanted - present));

  transmission.gear = gear_;
  transmission.ratio = variator_ratio_ * range_ratio(gear_);
  transmission.shifting = target_ != gear_;
  transmission.capacity_share = 1.0;
  transmission.demand = driver_demand();
}

}  // namespace rigwire::sim
