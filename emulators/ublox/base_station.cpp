#include "emulators/ublox/base_station.h"

#include <cmath>

#include "emulators/ublox/geodesy.h"

namespace rigwire::emulators {
namespace {

using protocols::ubx::CfgTmode3;

constexpr double kCorrelation_s = 60.0;
constexpr double kSeemsWrong_m = 50.0;

/// By CFG-TMODE3: ECEF in cm and 0.1 mm, or latitude and longitude in 1e-7 and 1e-9 degrees with a
/// height in cm and 0.1 mm.
std::array<double, 3> configured_place(const CfgTmode3& s) {
  if ((s.flags & protocols::ubx::kTmodeGeodetic) == 0) {
    std::array<double, 3> place_E_m{};
    for (std::size_t axis = 0; axis < place_E_m.size(); ++axis) {
      place_E_m[axis] = s.position[axis] * 1e-2 + s.position_rest[axis] * 1e-4;
    }
    return place_E_m;
  }
  UbloxSolution at;
  at.latitude_deg = s.position[0] * 1e-7 + s.position_rest[0] * 1e-9;
  at.longitude_deg = s.position[1] * 1e-7 + s.position_rest[1] * 1e-9;
  at.ellipsoid_height_m = s.position[2] * 1e-2 + s.position_rest[2] * 1e-4;
  return ecef_position(at);
}

}  // namespace

void UbloxBaseStation::begin(SimTime now, const CfgTmode3& settings) {
  settings_ = settings;
  place_E_m_.reset();
  survey_ = {};
  squares_m2_ = 0.0;
  warned_ = false;
  begun_ = now;
  switch (settings.mode()) {
    case protocols::ubx::kTmodeFixed:
      place_E_m_ = configured_place(settings);
      break;
    case protocols::ubx::kTmodeSurvey:
      survey_.active = true;
      break;
    default:
      break;
  }
}

void UbloxBaseStation::update(SimTime now, const CfgTmode3& settings,
                              const UbloxSolution& solution) {
  if (!settings_ || *settings_ != settings) {
    begin(now, settings);
  }
  if (!survey_.active) {
    return;
  }
  survey_.duration_s = static_cast<std::uint32_t>(to_seconds(now - begun_));
  if (solution.fix_ok && solution.dimensions == 3) {
    ++survey_.observations;
    const double count = survey_.observations;
    const auto position_E_m = ecef_position(solution);
    for (std::size_t axis = 0; axis < position_E_m.size(); ++axis) {
      survey_.mean_E_m[axis] += (position_E_m[axis] - survey_.mean_E_m[axis]) / count;
    }
    const double sigma_m = std::hypot(solution.horizontal_accuracy_m, solution.vertical_accuracy_m);
    squares_m2_ += (sigma_m * sigma_m - squares_m2_) / count;
    // Accuracy of a mean of errors that keep for a time.
    survey_.accuracy_m = std::sqrt(squares_m2_ / (1.0 + to_seconds(now - begun_) / kCorrelation_s));
  }
  constexpr double kLimitStep_m = 1e-4;
  if (survey_.observations > 0 && survey_.duration_s >= settings.survey_least_duration_s &&
      survey_.accuracy_m <= settings.survey_accuracy_limit_e4m * kLimitStep_m) {
    survey_.active = false;
    survey_.valid = true;
    place_E_m_ = survey_.mean_E_m;
  }
}

bool UbloxBaseStation::seems_wrong(const UbloxSolution& solution) {
  if (!place_E_m_ || warned_ || !solution.fix_ok || solution.dimensions != 3) {
    return false;
  }
  const auto own_E_m = ecef_position(solution);
  const double away_m = std::hypot(own_E_m[0] - (*place_E_m_)[0], own_E_m[1] - (*place_E_m_)[1],
                                   own_E_m[2] - (*place_E_m_)[2]);
  warned_ = away_m > kSeemsWrong_m;
  return warned_;
}

}  // namespace rigwire::emulators
