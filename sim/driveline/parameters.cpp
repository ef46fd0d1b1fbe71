#include "sim/driveline/parameters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

void require(bool allowed_value, const std::string& name, double found, const char* allowed) {
  if (allowed_value) {
    return;
  }
  std::ostringstream text;
  text << name << ": found " << found << ", allowed " << allowed;
  throw std::invalid_argument(text.str());
}

bool positive(double value) {
  return std::isfinite(value) && value > 0.0;
}
bool non_negative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

void validate_engine(const EngineParameters& p) {
  require(!p.full_load.empty(), "engine.full_load", 0.0, "at least one point");
  for (std::size_t i = 0; i < p.full_load.size(); ++i) {
    const std::string name = "engine.full_load[" + std::to_string(i) + "].";
    const TorquePoint& point = p.full_load[i];
    require(non_negative(point.speed_radps) &&
                (i == 0 || point.speed_radps > p.full_load[i - 1].speed_radps),
            name + "speed_radps", point.speed_radps, ">= 0 and above the point before");
    require(positive(point.torque_nm), name + "torque_nm", point.torque_nm, "> 0");
  }
  require(positive(p.inertia_kgm2), "engine.inertia_kgm2", p.inertia_kgm2, "> 0");
  require(non_negative(p.drag_nm), "engine.drag_nm", p.drag_nm, ">= 0");
  require(non_negative(p.drag_nmsprad), "engine.drag_nmsprad", p.drag_nmsprad, ">= 0");
  require(positive(p.idle_radps), "engine.idle_radps", p.idle_radps, "> 0");
  require(std::isfinite(p.maximum_radps) && p.maximum_radps > p.idle_radps, "engine.maximum_radps",
          p.maximum_radps, "above idle_radps");
  require(std::isfinite(p.cut_off_radps) && p.cut_off_radps > p.maximum_radps,
          "engine.cut_off_radps", p.cut_off_radps, "above maximum_radps");
  require(positive(p.governor_nmsprad), "engine.governor_nmsprad", p.governor_nmsprad, "> 0");
  require(positive(p.governor_integral_s), "engine.governor_integral_s", p.governor_integral_s,
          "> 0");
  require(non_negative(p.torque_lag_s), "engine.torque_lag_s", p.torque_lag_s, ">= 0");
}

void validate_clutch(const ClutchParameters& p, const EngineParameters& engine) {
  require(positive(p.capacity_nm), "clutch.capacity_nm", p.capacity_nm, "> 0");
  require(std::isfinite(p.open_radps) && p.open_radps > 0.5 * engine.idle_radps &&
              p.open_radps < engine.maximum_radps,
          "clutch.open_radps", p.open_radps, "half of engine.idle_radps .. engine.maximum_radps");
  require(std::isfinite(p.full_radps) && p.full_radps > p.open_radps, "clutch.full_radps",
          p.full_radps, "above open_radps");
}

void validate_axles(const AxleParameters& p) {
  require(non_negative(p.lock_time_s), "axles.lock_time_s", p.lock_time_s, ">= 0");
  require(positive(p.lock_rate_difference_radps), "axles.lock_rate_difference_radps",
          p.lock_rate_difference_radps, "> 0");
  require(positive(p.final_ratio), "axles.final_ratio", p.final_ratio, "> 0");
  require(positive(p.portal_ratio), "axles.portal_ratio", p.portal_ratio, "> 0");
  require(non_negative(p.output_inertia_kgm2), "axles.output_inertia_kgm2", p.output_inertia_kgm2,
          ">= 0");
  require(non_negative(p.output_drag_nmsprad), "axles.output_drag_nmsprad", p.output_drag_nmsprad,
          ">= 0");
  if (p.drive == AxleDrive::rear) {
    require(!p.lockable[static_cast<std::size_t>(Differential::centre)], "axles.lockable[centre]",
            1.0, "no: a rear drive has no centre differential");
  }
}

void validate_ratios(const std::vector<double>& ratios, const std::string& name,
                     std::size_t at_least) {
  require(ratios.size() >= at_least && ratios.size() <= 125, name,
          static_cast<double>(ratios.size()), at_least > 0 ? "1 .. 125 gears" : "0 .. 125 gears");
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    require(positive(ratios[i]), name + "[" + std::to_string(i) + "]", ratios[i], "> 0");
  }
}

}  // namespace

std::vector<TorquePoint> unimog_full_load() {
  return {{600 * kRadpsPerRpm, 450.0},
          {1000 * kRadpsPerRpm, 760.0},
          {1200 * kRadpsPerRpm, 900.0},
          {1600 * kRadpsPerRpm, 900.0},
          {2200 * kRadpsPerRpm, 737.9}};
}

double EngineParameters::greatest_torque_nm() const {
  double greatest = 0.0;
  for (const TorquePoint& point : full_load) {
    greatest = std::max(greatest, point.torque_nm);
  }
  return greatest;
}

std::vector<double> GearboxParameters::geometric(int gears, double top, double step, int count) {
  std::vector<double> ratios;
  for (int gear = 0; gear < count; ++gear) {
    ratios.push_back(top * std::pow(step, gears - 1 - gear));
  }
  return ratios;
}

CvtParameters::CvtParameters() {
  // 50.7 Nm at 3200 rpm are the maker's 17 kW.
  engine.full_load = {
      {1200 * kRadpsPerRpm, 44.0}, {2200 * kRadpsPerRpm, 56.0}, {3200 * kRadpsPerRpm, 50.7}};
  engine.inertia_kgm2 = 0.12;
  engine.drag_nm = 4.0;
  engine.drag_nmsprad = 0.02;
  engine.idle_radps = 1250 * kRadpsPerRpm;
  engine.maximum_radps = 3200 * kRadpsPerRpm;
  engine.cut_off_radps = 3500 * kRadpsPerRpm;
  engine.governor_nmsprad = 6.0;
  engine.torque_lag_s = 0.1;
  clutch.centrifugal = true;
  clutch.capacity_nm = 90.0;
  clutch.open_radps = 1450 * kRadpsPerRpm;
  clutch.full_radps = 2000 * kRadpsPerRpm;
  // Overall 40 (low, launch) to 7.6 (high, top).
  axles.drive = AxleDrive::switchable_front;
  axles.lockable = {false, true, true};
  axles.final_ratio = 9.5;
  axles.portal_ratio = 1.0;
  axles.output_inertia_kgm2 = 0.02;
  axles.output_drag_nmsprad = 0.005;
  variator.ranges = {40.0 / (2.8 * 9.5), 1.0};
  variator.reverse_range = variator.ranges.front();
}

DrivelineParameters unimog_u5023_driveline() {
  return GearedParameters{};
}

DrivelineParameters gator_855d_driveline() {
  return CvtParameters{};
}

void validate(const GearedParameters& p) {
  validate_engine(p.engine);
  validate_clutch(p.clutch, p.engine);
  validate_axles(p.axles);
  validate_ratios(p.gearbox.forward, "gearbox.forward", 1);
  validate_ratios(p.gearbox.reverse, "gearbox.reverse", 0);
  require(p.gearbox.crawler_factor == 0.0 ||
              (std::isfinite(p.gearbox.crawler_factor) && p.gearbox.crawler_factor >= 1.0),
          "gearbox.crawler_factor", p.gearbox.crawler_factor, "0 (none) or >= 1");
  require(non_negative(p.gearbox.ramp_down_s), "gearbox.ramp_down_s", p.gearbox.ramp_down_s,
          ">= 0");
  require(non_negative(p.gearbox.synchronisation_s), "gearbox.synchronisation_s",
          p.gearbox.synchronisation_s, ">= 0");
  require(non_negative(p.gearbox.ramp_up_s), "gearbox.ramp_up_s", p.gearbox.ramp_up_s, ">= 0");
  require(positive(p.gearbox.group_change_radps), "gearbox.group_change_radps",
          p.gearbox.group_change_radps, "> 0");
}

void validate(const CvtParameters& p) {
  validate_engine(p.engine);
  validate_clutch(p.clutch, p.engine);
  validate_axles(p.axles);
  validate_ratios(p.variator.ranges, "variator.ranges", 1);
  require(non_negative(p.variator.reverse_range), "variator.reverse_range",
          p.variator.reverse_range, ">= 0 (0: no reverse)");
  require(positive(p.variator.top_ratio), "variator.top_ratio", p.variator.top_ratio, "> 0");
  require(std::isfinite(p.variator.launch_ratio) && p.variator.launch_ratio >= p.variator.top_ratio,
          "variator.launch_ratio", p.variator.launch_ratio, "at least top_ratio");
  require(positive(p.variator.shift_from_radps), "variator.shift_from_radps",
          p.variator.shift_from_radps, "> 0");
  require(std::isfinite(p.variator.shift_to_radps) &&
              p.variator.shift_to_radps > p.variator.shift_from_radps,
          "variator.shift_to_radps", p.variator.shift_to_radps, "above shift_from_radps");
  require(non_negative(p.variator.lag_s), "variator.lag_s", p.variator.lag_s, ">= 0");
  require(positive(p.variator.range_change_radps), "variator.range_change_radps",
          p.variator.range_change_radps, "> 0");
}

void validate(const DrivelineParameters& parameters) {
  std::visit([](const auto& p) { validate(p); }, parameters);
}

}  // namespace rigwire::sim
