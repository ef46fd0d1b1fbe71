#include "sim/gnss/gnss_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/constants.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::sim {

namespace {

constexpr double kCepPerSigma = 1.1774;  // sqrt(2 ln 2), circular normal distribution
/// CEP with SBAS over CEP without, u-blox 7 data sheet: 2.0 m and 2.5 m.
constexpr double kSbasCircularShare = 0.8;
/// So long after a slip its ambiguity is known well enough again to be found.
constexpr double kHeld_s = 2.0;
/// A receiver that has never had a 3D fix knows its height so well, and loses it by the slope of
/// the ground while it moves.
constexpr double kUnknownHeightSigma_m = 10.0;
constexpr double kSlope = 0.1;
/// No fix where the satellites' directions are worse.
constexpr double kWorstDilution = 100.0;
constexpr double kLeastCarrierSigma_m = 1e-3;

constexpr std::array kSystems{GnssSystem::gps,    GnssSystem::sbas, GnssSystem::galileo,
                              GnssSystem::beidou, GnssSystem::qzss, GnssSystem::glonass};

std::shared_ptr<const Constellation> nominal(const GnssParameters& parameters) {
  validate(parameters);
  std::vector<GnssSystem> systems;
  std::ranges::copy_if(kSystems, std::back_inserter(systems),
                       [&](GnssSystem system) { return parameters.systems.receives(system); });
  return make_nominal_constellation(systems);
}

std::shared_ptr<const Constellation> checked(const GnssParameters& parameters,
                                             std::shared_ptr<const Constellation> constellation) {
  validate(parameters);
  if (constellation == nullptr) {
    throw std::invalid_argument("gnss: there is no constellation");
  }
  return constellation;
}

std::string below(std::string_view name, const char* what) {
  return std::string(name) + what;
}

void list_directions(std::span<ReceivedSatellite* const> satellites,
                     std::vector<Eigen::Vector3d>& directions_enu) {
  directions_enu.clear();
  for (const ReceivedSatellite* satellite : satellites) {
    const Eigen::Vector3d& ned = satellite->direction_ned;
    directions_enu.emplace_back(ned.y(), ned.x(), -ned.z());
  }
}

/// Returns the dilution model: in the error model `paper` the chosen one, else always the geometric
/// one.
std::unique_ptr<DilutionModel> dilution_of(const GnssParameters& parameters) {
  return make_dilution(parameters.error_model == ErrorModel::paper ? parameters.dilution
                                                                   : DilutionKind::geometric);
}

void count(const ReceivedSatellite& satellite, bool second, CarrierCount& carriers) {
  ++carriers.used;
  if (!satellite.carries) {
    return;
  }
  ++carriers.line_of_sight;
  if (satellite.held_s < kHeld_s) {
    return;
  }
  ++carriers.held;
  if (second && satellite.cn0_dbhz - satellite.second_weaker_db >= kCarrierCn0_dbhz) {
    ++carriers.two_band;
  }
}

}  // namespace

GnssFix fix_by_count(int satellites) {
  if (satellites <= 1) {
    return GnssFix::none;
  }
  if (satellites <= 2) {
    return GnssFix::bad;
  }
  return satellites <= 3 ? GnssFix::two_d : GnssFix::three_d;
}

GnssSensor::GnssSensor(const GnssParameters& parameters,
                       std::shared_ptr<const Constellation> constellation, const Calendar& calendar,
                       const LocalFrame& frame, std::uint64_t seed, std::string_view name)
    : name_(name),
      parameters_(parameters),
      faults_(parameters.faults),
      constellation_(checked(parameters, std::move(constellation))),
      calendar_(calendar),
      frame_(frame),
      dilution_(dilution_of(parameters)),
      random_(seed, name),
      held_random_(seed, below(name, "/height")),
      clock_(parameters.clock, seed, below(name, "/clock")),
      channels_(parameters, constellation_, seed, name),
      carrier_(parameters.corrections, seed, name),
      station_(constellation_),
      observations_(constellation_->satellites().size(), seed, below(name, "/carrier_phase")),
      engine_(parameters.navigation, constellation_->satellites().size()) {}

GnssSensor::GnssSensor(const GnssParameters& parameters, const Calendar& calendar,
                       const LocalFrame& frame, std::uint64_t seed, std::string_view name)
    : GnssSensor(parameters, nominal(parameters), calendar, frame, seed, name) {}

GnssSensor::Epoch GnssSensor::begin(SimTime time, const LinkMotion& antenna) {
  Epoch epoch;
  epoch.clock = clock_.measure(time);
  epoch.fault = fault_state(faults_, time);
  Reception& reception = epoch.reception;
  reception.time = time;
  reception.gps = calendar_.gps(time);
  // Where the antenna is when the receiver's own clock shows the epoch.
  reception.p_W = antenna.X_WL.translation() + epoch.clock.measured_after_s * antenna.v_WL_W;
  reception.speed_mps = antenna.v_WL_W.norm();
  epoch.ned_from_world = frame_.ned_from_world(reception.p_W);
  const auto in_world = [&](const Eigen::Vector3d& enu) -> Eigen::Vector3d {
    return epoch.ned_from_world.transpose() * Eigen::Vector3d(enu.y(), enu.x(), -enu.z());
  };
  reception.ranges_p_W = reception.p_W + in_world(epoch.fault.offset_m);
  epoch.v_W = antenna.v_WL_W + in_world(epoch.fault.offset_rate_mps);
  epoch.height_m = frame_.to_geodetic(reception.ranges_p_W).ellipsoid_height_m;
  return epoch;
}

void GnssSensor::select(std::span<ReceivedSatellite> received, Epoch& epoch) const {
  epoch.used.reserve(received.size());
  const double mask_rad = parameters_.sky.elevation_mask_deg * std::numbers::pi / 180.0;
  for (ReceivedSatellite& satellite : received) {
    epoch.augmented |= satellite.tracked && satellite.satellite.system == GnssSystem::sbas &&
                       satellite.elevation_rad >= mask_rad;
    satellite.two_bands =
        parameters_.second_signals && has_second_carrier(satellite.satellite.system) &&
        command_.uses_second(satellite.satellite.system) &&
        satellite.cn0_dbhz - satellite.second_weaker_db >= parameters_.sky.cn0_threshold_dbhz;
    satellite.used = satellite.usable && command_.uses(satellite.satellite.system) &&
                     satellite.elevation_rad >= command_.minimum_elevation_rad &&
                     satellite.cn0_dbhz >= command_.minimum_cn0_dbhz;
    if (satellite.used) {
      epoch.used.push_back(&satellite);
    }
  }
  if (epoch.used.size() > command_.maximum_satellites) {
    // The strongest stay, in their order.
    std::vector<ReceivedSatellite*> by_strength = epoch.used;
    std::ranges::stable_sort(by_strength, std::ranges::greater{}, &ReceivedSatellite::cn0_dbhz);
    for (std::size_t i = command_.maximum_satellites; i < by_strength.size(); ++i) {
      by_strength[i]->used = false;
    }
    std::erase_if(epoch.used, [](const ReceivedSatellite* satellite) { return !satellite->used; });
  }
}

void GnssSensor::command(const GnssCommand& command) {
  if (command.starts != command_.starts) {
    engine_.forget();
    held_.reset();
  }
  command_ = command;
}

bool GnssSensor::quadrants_filled(const Epoch& epoch) const {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const double turn = parameters_.quadrant_rule == QuadrantRule::cardinal ? 0.5 * kQuarter : 0.0;
  std::array<bool, 4> filled{};
  for (const ReceivedSatellite* satellite : epoch.used) {
    const double quarter = (satellite->azimuth_rad + turn) / kQuarter;
    filled[static_cast<std::size_t>(quarter) % 4] = true;
  }
  return std::ranges::all_of(filled, [](bool one) { return one; });
}

GnssFix GnssSensor::fix_of(const Epoch& epoch) const {
  const bool coloured = parameters_.error_model == ErrorModel::coloured;
  const int count = coloured ? effective_count(equations_) : static_cast<int>(epoch.used.size());
  const GnssFix fix = fix_by_count(count);
  const bool degraded = fix == GnssFix::three_d &&
                        (command_.altitude_m || (parameters_.quadrant_rule != QuadrantRule::off &&
                                                 !quadrants_filled(epoch)));
  return degraded ? GnssFix::two_d : fix;
}

void GnssSensor::take_corrections(const Epoch& epoch) {
  const auto& newest = command_.corrections;
  if (parameters_.corrections.kind != CorrectionKind::rtk || newest == nullptr ||
      newest == corrections_ || epoch.fault.corrections_lost) {
    return;
  }
  corrections_ = newest;
  const GpsTime time = calendar_.gps(newest->measured);
  const auto navigation = constellation_->navigation(time);
  const double time_of_week_s = static_cast<double>(time.time_of_week_ns) * 1e-9;
  const Eigen::Vector3d origin_E_m = frame_.to_ecef(Eigen::Vector3d::Zero());
  // Delays as measure() computes them for this antenna.
  const auto delay_of = [&](std::size_t index, const Eigen::Vector3d& p_E_m,
                            const Eigen::Vector3d& direction_E) {
    const Eigen::Vector3d p_W = frame_.world_from_ecef() * (p_E_m - origin_E_m);
    const GeodeticPoint point = frame_.to_geodetic(p_W);
    const Eigen::Vector3d ned =
        frame_.ned_from_world(p_W) * (frame_.world_from_ecef() * direction_E);
    const double azimuth = std::atan2(ned.y(), ned.x());
    const double elevation = std::max(std::asin(std::clamp(-ned.z(), -1.0, 1.0)), 0.01);
    const RangeError shared =
        channels_.shared_error(index, newest->measured, p_E_m, direction_E, elevation);
    double ionosphere_m = shared.ionosphere_m;
    double troposphere_m = shared.troposphere_m;
    if (parameters_.ionosphere && navigation != nullptr) {
      ionosphere_m +=
          klobuchar_delay_m(navigation->ionosphere, point.latitude_deg * kDegree,
                            point.longitude_deg * kDegree, azimuth, elevation, time_of_week_s);
    }
    if (parameters_.troposphere) {
      troposphere_m +=
          saastamoinen_delay_m(point.latitude_deg * kDegree, point.ellipsoid_height_m, elevation);
    }
    return KnownDelay{shared.orbit_clock_m + troposphere_m, ionosphere_m};
  };
  std::vector<KnownAntenna> antennas;
  antennas_->each(newest->measured, name_, [&](std::size_t id, const Eigen::Vector3d& p_W) {
    antennas.push_back({id, frame_.to_ecef(p_W)});
  });
  station_.take(*newest, time, delay_of, antennas);
}

std::optional<ReceivedCorrections> GnssSensor::received_corrections(const Epoch& epoch) const {
  if (corrections_ == nullptr) {
    return std::nullopt;
  }
  ReceivedCorrections received;
  received.measured = corrections_->measured;
  received.largest_age = corrections_->largest_age;
  const Vector3& station = corrections_->station_E_m;
  received.baseline_m = (frame_.to_ecef(epoch.reception.ranges_p_W) -
                         Eigen::Vector3d(station.x, station.y, station.z))
                            .norm();
  received.gps_only = true;
  for (const ReceivedSatellite* satellite : epoch.used) {
    if (station_.has(satellite->index)) {
      count(*satellite, station_.has_second(satellite->index), received.common);
      received.gps_only = received.gps_only &&
                          (!satellite->carries || satellite->satellite.system == GnssSystem::gps);
    }
  }
  received.carriers_agree = station_.carriers_agree();
  received.floating_only = corrections_->floating_only;
  return received;
}

void GnssSensor::correct(Epoch& epoch, GnssSample& sample) {
  take_corrections(epoch);
  CorrectionInput input;
  input.received = received_corrections(epoch);
  input.time = epoch.reception.time;
  for (const ReceivedSatellite* satellite : epoch.used) {
    count(*satellite, false, input.carriers);
  }
  input.has_position = epoch.used.size() >= 3;
  input.link = !epoch.fault.corrections_lost && !epoch.fault.no_signal;
  if (parameters_.corrections.kind == CorrectionKind::sbas && channels_.knows(GnssSystem::sbas)) {
    input.link = input.link && epoch.augmented;
  }
  epoch.corrections = carrier_.advance(input);
  if (auto& error_ned_m = epoch.corrections.error_ned_m) {
    *error_ned_m *= parameters_.errors ? 1.0 : 0.0;
    if (parameters_.corrections.kind == CorrectionKind::rtk) {
      // A station that claims a wrong place moves its rovers by as much; what the engine does not
      // know of the station's place, it does not know of its own.
      const Eigen::Matrix3d turn = epoch.ned_from_world * frame_.world_from_ecef();
      *error_ned_m += turn * station_.claim_error_E_m();
      const Eigen::Matrix3d unknown_m2 = turn * station_.claim_covariance_m2() * turn.transpose();
      CorrectionOutput& output = epoch.corrections;
      output.horizontal_sigma_m = std::sqrt(std::pow(output.horizontal_sigma_m, 2) +
                                            0.5 * (unknown_m2(0, 0) + unknown_m2(1, 1)));
      output.vertical_sigma_m = std::sqrt(std::pow(output.vertical_sigma_m, 2) + unknown_m2(2, 2));
    }
  }
  sample.differential = epoch.corrections.differential;
  sample.differential_age_s = epoch.corrections.age_s;
  channels_.range_errors(epoch.corrections.share, epoch.fault.spoofed);
  equations_.clear();
  for (const ReceivedSatellite* satellite : epoch.used) {
    equations_.push_back({satellite->direction_ned, satellite->satellite.system,
                          satellite->error.total_m(), satellite->error.sigma_m,
                          satellite->error.common_m});
  }
}

void GnssSensor::put_dilution(const Dilution& geometric, GnssSample& sample) const {
  sample.horizontal_dilution = geometric.horizontal;
  sample.vertical_dilution = geometric.vertical;
  sample.position_dilution = geometric.position;
  sample.time_dilution = geometric.time;
  sample.north_dilution = geometric.north;
  sample.east_dilution = geometric.east;
  const bool regression = parameters_.error_model == ErrorModel::paper &&
                          parameters_.dilution == DilutionKind::regression;
  if (regression && sample.fix == GnssFix::two_d) {
    sample.position_dilution = 0.0;  // the paper's rule for 2D
  }
}

void GnssSensor::solve_paper(Epoch& epoch, GnssSample& sample) {
  list_directions(epoch.used, directions_enu_);
  const Dilution amplitude = dilution_->amplitude(directions_enu_);
  if (!std::isfinite(amplitude.horizontal)) {  // the satellites lie on a cone
    sample.fix = GnssFix::none;
    return;
  }
  put_dilution(dilution_->reported(directions_enu_), sample);

  // Per unit of horizontal dilution; a held height keeps the horizontal scale.
  const bool sbas = parameters_.corrections.kind == CorrectionKind::sbas && sample.differential;
  const double range_sigma_m =
      parameters_.circular_error_m * (sbas ? kSbasCircularShare : 1.0) / kCepPerSigma;
  const double vertical =
      std::isfinite(amplitude.vertical) ? amplitude.vertical : amplitude.horizontal;
  const double horizontal_sigma_m = amplitude.horizontal * range_sigma_m / std::numbers::sqrt2;
  const double vertical_sigma_m = vertical * range_sigma_m;
  // Eq. 2 of Wolf et al. 2020: range error times dilution; level, sigma / sqrt(2) on each axis.
  epoch.error_ned_m = {horizontal_sigma_m * unit_error_[1].value(),
                       horizontal_sigma_m * unit_error_[0].value(),
                       -vertical_sigma_m * unit_error_[2].value()};
  const double speed_sigma_mps = parameters_.speed_sigma_mps * amplitude.horizontal;
  epoch.velocity_error_ned_mps = speed_sigma_mps * unit_velocity_;
  sample.horizontal_accuracy_m = horizontal_sigma_m * std::numbers::sqrt2;
  sample.vertical_accuracy_m = vertical_sigma_m;
  const double horizontal_m2 = horizontal_sigma_m * horizontal_sigma_m;
  sample.position_covariance_ned_m2 = {horizontal_m2, 0.0, 0.0,
                                       horizontal_m2, 0.0, vertical_sigma_m * vertical_sigma_m};
  sample.speed_accuracy_mps = speed_sigma_mps * std::sqrt(3.0);
  sample.time_accuracy_s = amplitude.time * range_sigma_m / kLightSpeed_mps;
}

HeldHeight GnssSensor::held_height(const Epoch& epoch) {
  if (command_.altitude_m) {
    constexpr double kGivenHeightSigma_m = 1.0;
    const double geoid_m = frame_.geoid_separation_m();
    return {*command_.altitude_m + geoid_m - epoch.height_m, kGivenHeightSigma_m};
  }
  if (!held_) {
    const double off_m = parameters_.errors ? kUnknownHeightSigma_m * held_random_.gaussian() : 0.0;
    held_ = {epoch.height_m + off_m, kUnknownHeightSigma_m, epoch.reception.ranges_p_W};
  }
  // A held height ages by the slope of the ground over the way since.
  const double moved_m = (epoch.reception.ranges_p_W - held_->p_W).norm();
  return {held_->height_m - epoch.height_m, std::hypot(held_->sigma_m, kSlope * moved_m)};
}

void GnssSensor::solve_coloured(Epoch& epoch, GnssSample& sample) {
  std::optional<PositionSolution> solution;
  if (sample.fix == GnssFix::three_d) {
    solution = solve_position(equations_, std::nullopt);
  }
  if (!solution) {
    sample.fix = GnssFix::two_d;
    solution = solve_position(equations_, held_height(epoch));
  }
  if (!solution) {
    sample.fix = GnssFix::none;
    return;
  }
  put_dilution(solution->dilution, sample);
  epoch.error_ned_m = solution->error_ned_m;
  const Eigen::Matrix3d& c = solution->covariance_ned_m2;
  sample.position_covariance_ned_m2 = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  sample.horizontal_accuracy_m = std::sqrt(c(0, 0) + c(1, 1));
  sample.vertical_accuracy_m = std::sqrt(c(2, 2));
  sample.time_accuracy_s = solution->clock_sigma_m / kLightSpeed_mps;
  sample.clock_bias_s += solution->clock_error_m / kLightSpeed_mps;
  for (std::size_t i = 0; i < epoch.used.size(); ++i) {
    epoch.used[i]->residual_m = solution->residuals_m[i];
  }
  if (sample.fix == GnssFix::three_d) {
    held_ = {epoch.height_m - epoch.error_ned_m.z(), sample.vertical_accuracy_m,
             epoch.reception.ranges_p_W};
  }
  solve_velocity(epoch, sample);
}

void GnssSensor::solve_velocity(Epoch& epoch, GnssSample& sample) {
  constexpr double kLeastSigma_mps = 1e-4;
  const double sigma_mps = std::max(parameters_.speed_sigma_mps, kLeastSigma_mps);
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    // Velocity by the same least squares, with range rates.
    equations_[i].error_m = parameters_.speed_sigma_mps * epoch.used[i]->error.rate_mps;
    equations_[i].sigma_m = sigma_mps;
    equations_[i].common_m = {};
  }
  std::optional<HeldHeight> held;
  if (sample.fix == GnssFix::two_d) {
    // The held height does not change: the receiver takes its rate for 0.
    held = HeldHeight{(epoch.ned_from_world * epoch.v_W).z(), sigma_mps};
  }
  if (const auto solution = solve_position(equations_, held)) {
    epoch.velocity_error_ned_mps = solution->error_ned_m;
    sample.speed_accuracy_mps = std::sqrt(solution->covariance_ned_m2.trace());
  }
}

NavigationEngine::Epoch GnssSensor::engine_epoch(const Epoch& epoch) const {
  NavigationEngine::Epoch e;
  const Reception& reception = epoch.reception;
  e.time = reception.time + epoch.clock.measured_after;
  e.truth = {
      .p_W = reception.ranges_p_W,
      .v_W = epoch.v_W,
      .clock_m = kLightSpeed_mps * epoch.clock.bias_s + epoch.fault.clock_offset_m,
      .clock_rate_mps = kLightSpeed_mps * epoch.clock.drift + epoch.fault.clock_offset_rate_mps,
      .clock_reset = epoch.clock.reset,
      .ned_from_world = epoch.ned_from_world};
  e.noise.horizontal = command_.horizontal_acceleration;
  e.noise.vertical = command_.vertical_acceleration;
  // A Gauss-Markov rate grows at first like a random walk of 2 sigma^2 / tau.
  const double wander_mps = kLightSpeed_mps * parameters_.clock.wander_sigma;
  e.noise.clock_rate_mps2s =
      std::max(e.noise.clock_rate_mps2s,
               2.0 * wander_mps * wander_mps / parameters_.clock.wander_correlation_s);
  const RangeErrorParameters& r = parameters_.ranges;
  const double rest_s = r.multipath_correlation_s;
  e.correlation = {
      .ionosphere_s = r.ionosphere_correlation_s,
      .troposphere_s = r.troposphere_correlation_s,
      .orbit_s = r.orbit_clock_correlation_s,
      .multipath_s = rest_s / (1.0 + rest_s * reception.speed_mps / r.multipath_length_m),
      .carrier_s = parameters_.corrections.correlation_s};
  e.still = command_.stationary;
  return e;
}

void GnssSensor::solve_engine(Epoch& epoch, GnssSample& sample) {
  list_directions(epoch.used, directions_enu_);
  if (!(dilution_->reported(directions_enu_).position <= kWorstDilution)) {
    sample.fix = GnssFix::none;
    return;
  }
  engine_signals_.clear();
  for (const ReceivedSatellite* satellite : epoch.used) {
    const RangeError& error = satellite->error;
    engine_signals_.push_back({.source = satellite->index,
                               .system = satellite->satellite.system,
                               .direction_W = satellite->direction_W,
                               .range_error_m = error.total_m(),
                               .rate_error_mps = error.range_rate_mps,
                               .noise_sigma_m = error.noise_sigma_m,
                               .multipath_sigma_m = error.multipath_sigma_m,
                               .orbit_sigma_m = error.orbit_sigma_m,
                               .common_m = error.common_m,
                               .mistrust_sigma_m = error.mistrust_sigma_m,
                               .rate_noise_mps = error.range_rate_noise_mps});
  }
  std::optional<NavigationFilter::Position> position;
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  HeldHeight height;
  if (sample.fix == GnssFix::two_d) {
    height = held_height(epoch);
    position = {{0.0, 0.0, -height.error_m}, {kUnknown, kUnknown, height.sigma_m}};
  } else if (epoch.corrections.error_ned_m && !epoch.fault.spoofed) {
    // The filter follows the carrier's position, so that it goes on from there when that is lost.
    const double level_m = std::max(epoch.corrections.horizontal_sigma_m, kLeastCarrierSigma_m);
    position = {
        *epoch.corrections.error_ned_m,
        {level_m, level_m, std::max(epoch.corrections.vertical_sigma_m, kLeastCarrierSigma_m)},
        true};
  }
  const NavigationEngine::Epoch now = engine_epoch(epoch);
  NavigationFix fix = engine_.fix(now, engine_signals_, position);
  if (!parameters_.errors) {
    engine_.set(now.truth);
    fix.p_W = now.truth.p_W;
    fix.v_W = now.truth.v_W;
    fix.clock_m = now.truth.clock_m;
    fix.clock_rate_mps = now.truth.clock_rate_mps;
  }
  const NavigationFilter& filter = engine_.filter();
  for (std::size_t i = 0; i < epoch.used.size(); ++i) {
    epoch.used[i]->used = !filter.left_out()[i];
    epoch.used[i]->residual_m = filter.residuals_m()[i];
  }
  std::erase_if(epoch.used, [](const ReceivedSatellite* satellite) { return !satellite->used; });
  list_directions(epoch.used, directions_enu_);
  Dilution dilution = dilution_->reported(directions_enu_);
  if (sample.fix == GnssFix::two_d) {
    // The height is held, whatever the number of satellites.
    dilution.vertical = std::numeric_limits<double>::quiet_NaN();
    dilution.position = dilution.horizontal;
  }
  put_dilution(dilution, sample);
  put_fix(fix, epoch, sample);
  const double height_m = frame_.to_geodetic(fix.p_W).ellipsoid_height_m;
  if (sample.fix == GnssFix::three_d) {
    held_ = {height_m, sample.vertical_accuracy_m, epoch.reception.ranges_p_W};
  }
}

void GnssSensor::coast(const Epoch& epoch, GnssSample& sample) {
  if (const auto fix = engine_.coast(engine_epoch(epoch))) {
    sample.predicted = true;
    put_fix(*fix, epoch, sample);
  }
}

GnssSample GnssSensor::sample(SimTime time, const LinkMotion& antenna,
                              const Visibility& visibility) {
  // Each epoch draws the same numbers, whatever is visible: one device's sky never shifts its
  // noise.
  const double step_s = last_ == kNever ? 0.0 : to_seconds(time - last_);
  for (GaussMarkov& axis : unit_error_) {
    axis.advance(step_s, parameters_.correlation_time_s, random_);
  }
  unit_velocity_ = {random_.gaussian(), random_.gaussian(), random_.gaussian()};
  last_ = time;

  Epoch epoch = begin(time, antenna);
  antennas_->note(name_, time + epoch.clock.label_offset, epoch.reception.ranges_p_W);
  const std::span<ReceivedSatellite> received =
      channels_.receive(epoch.reception, frame_, visibility, epoch.fault);
  select(received, epoch);

  GnssSample sample;
  sample.time = time;
  sample.measured_after = epoch.clock.measured_after;
  sample.clock_label_offset = epoch.clock.label_offset;
  sample.clock_reset = epoch.clock.reset;
  sample.clock_bias_s = epoch.clock.bias_s + epoch.fault.clock_offset_m / kLightSpeed_mps;
  sample.clock_drift = epoch.clock.drift + epoch.fault.clock_offset_rate_mps / kLightSpeed_mps;
  sample.geoid_separation_m = frame_.geoid_separation_m();
  const auto jamming = [](double loss_db) { return 1.0 - std::pow(10.0, -loss_db / 20.0); };
  sample.radio = {epoch.fault.antenna, jamming(epoch.fault.jamming_db), epoch.fault.jamming_db,
                  jamming(epoch.fault.second_jamming_db), epoch.fault.second_jamming_db};
  sample.navigation = constellation_->navigation(epoch.reception.gps);
  correct(epoch, sample);
  sample.fix = fix_of(epoch);
  if (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) {
    switch (parameters_.error_model) {
      case ErrorModel::engine:
        solve_engine(epoch, sample);
        break;
      case ErrorModel::coloured:
        solve_coloured(epoch, sample);
        break;
      case ErrorModel::paper:
        solve_paper(epoch, sample);
        break;
    }
    put_carrier(epoch, sample);
  }
  if (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) {
    put_position(epoch, sample);
  } else if (parameters_.error_model == ErrorModel::engine) {
    coast(epoch, sample);
  }
  put_satellites(received, epoch, sample);
  if (parameters_.raw_measurements) {
    measure(received, epoch, sample);
  }
  return sample;
}

// What a GNSS sensor puts into its sample once the epoch is solved: position, satellites, raw
// measurements.

void GnssSensor::put_carrier(Epoch& epoch, GnssSample& sample) const {
  const CorrectionOutput& corrections = epoch.corrections;
  if (!corrections.error_ned_m || sample.fix != GnssFix::three_d || epoch.fault.spoofed) {
    return;
  }
  sample.carrier = corrections.carrier;
  epoch.error_ned_m = *corrections.error_ned_m;
  const double horizontal_m2 = corrections.horizontal_sigma_m * corrections.horizontal_sigma_m;
  const double vertical_m2 = corrections.vertical_sigma_m * corrections.vertical_sigma_m;
  sample.position_covariance_ned_m2 = {horizontal_m2, 0.0, 0.0, horizontal_m2, 0.0, vertical_m2};
  sample.horizontal_accuracy_m = std::sqrt(2.0 * horizontal_m2);
  sample.vertical_accuracy_m = corrections.vertical_sigma_m;
}

void GnssSensor::put_fix(const NavigationFix& fix, const Epoch& epoch, GnssSample& sample) const {
  const Eigen::Matrix3d& c = fix.covariance_ned_m2;
  sample.position_covariance_ned_m2 = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  sample.horizontal_accuracy_m = fix.horizontal_sigma_m;
  sample.vertical_accuracy_m = fix.vertical_sigma_m;
  sample.speed_accuracy_mps = fix.speed_sigma_mps;
  sample.time_accuracy_s = fix.clock_sigma_m / kLightSpeed_mps;
  sample.clock_bias_s = fix.clock_m / kLightSpeed_mps;
  sample.clock_drift = fix.clock_rate_mps / kLightSpeed_mps;
  const Eigen::Vector3d v_ned = epoch.ned_from_world * fix.v_W;
  sample.velocity_ned_mps = {v_ned.x(), v_ned.y(), v_ned.z()};
  put_place(fix.p_W, sample);
}

void GnssSensor::put_place(const Eigen::Vector3d& p_W, GnssSample& sample) const {
  const GeodeticPoint point = frame_.to_geodetic(p_W);
  sample.latitude_deg = point.latitude_deg;
  sample.longitude_deg = point.longitude_deg;
  sample.ellipsoid_height_m = point.ellipsoid_height_m;
  sample.geoid_separation_m = frame_.geoid_separation_m(point.latitude_deg, point.longitude_deg);
}

void GnssSensor::put_position(const Epoch& epoch, GnssSample& sample) const {
  if (parameters_.error_model == ErrorModel::engine) {
    if (sample.carrier != CarrierSolution::none) {
      put_place(epoch.reception.ranges_p_W + epoch.ned_from_world.transpose() * epoch.error_ned_m,
                sample);
    }
    return;  // solve_engine() put it
  }
  const double switched = parameters_.errors ? 1.0 : 0.0;
  // A held height, and the place that a base station claims, are off even without range errors.
  const Eigen::Vector3d error_ned_m =
      parameters_.error_model == ErrorModel::coloured || sample.carrier != CarrierSolution::none
          ? epoch.error_ned_m
          : Eigen::Vector3d(switched * epoch.error_ned_m);
  put_place(epoch.reception.ranges_p_W + epoch.ned_from_world.transpose() * error_ned_m, sample);
  const Eigen::Vector3d error_mps = parameters_.error_model == ErrorModel::coloured
                                        ? epoch.velocity_error_ned_mps
                                        : Eigen::Vector3d(switched * epoch.velocity_error_ned_mps);
  const Eigen::Vector3d v_ned = epoch.ned_from_world * epoch.v_W + error_mps;
  sample.velocity_ned_mps = {v_ned.x(), v_ned.y(), v_ned.z()};
}

void GnssSensor::put_satellites(std::span<const ReceivedSatellite> received, const Epoch& epoch,
                                GnssSample& sample) const {
  const bool fixed = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
  sample.satellites.reserve(received.size());
  for (const ReceivedSatellite& satellite : received) {
    SatelliteView& view = sample.satellites.emplace_back();
    view.system = satellite.satellite.system;
    view.number = satellite.satellite.number;
    view.azimuth_rad = satellite.azimuth_rad;
    view.elevation_rad = satellite.elevation_rad;
    view.cn0_dbhz = satellite.cn0_dbhz;
    view.tracked = satellite.tracked;
    view.used = fixed && satellite.used;
    view.residual_m = view.used ? satellite.residual_m : 0.0;
    view.corrected = view.used && epoch.corrections.differential;
  }
}

void GnssSensor::measure(std::span<const ReceivedSatellite> received, const Epoch& epoch,
                         GnssSample& sample) {
  const Reception& reception = epoch.reception;
  const GeodeticPoint point = frame_.to_geodetic(reception.ranges_p_W);
  const double latitude = point.latitude_deg * kDegree;
  const double longitude = point.longitude_deg * kDegree;
  const double time_of_week_s = static_cast<double>(reception.gps.time_of_week_ns) * 1e-9;
  signals_.clear();
  for (const ReceivedSatellite& satellite : received) {
    const GnssSystem system = satellite.satellite.system;
    if (!satellite.tracked || !command_.uses(system)) {
      continue;
    }
    TrackedSignal signal;
    signal.satellite = satellite.index;
    signal.cn0_dbhz = satellite.cn0_dbhz;
    if (parameters_.ionosphere && sample.navigation != nullptr) {
      signal.ionosphere_m =
          klobuchar_delay_m(sample.navigation->ionosphere, latitude, longitude,
                            satellite.azimuth_rad, satellite.elevation_rad, time_of_week_s);
    }
    if (parameters_.troposphere) {
      signal.troposphere_m =
          saastamoinen_delay_m(latitude, point.ellipsoid_height_m, satellite.elevation_rad);
    }
    if (parameters_.error_model != ErrorModel::paper) {
      const RangeError& error = satellite.error;
      signal.ionosphere_m += error.ionosphere_m;
      signal.troposphere_m += error.troposphere_m;
      // Code and carrier have orbit and detour, and local errors each of its own.
      signal.code_error_m = error.orbit_clock_m + error.detour_m + error.local_m;
      signal.carrier_error_m = error.orbit_clock_m + error.detour_m + error.carrier_m;
      signal.range_rate_error_mps = parameters_.error_model == ErrorModel::engine
                                        ? error.range_rate_mps
                                        : parameters_.speed_sigma_mps * error.rate_mps;
    }
    signal.code_error_m += epoch.fault.clock_offset_m;
    signal.carrier_error_m += epoch.fault.clock_offset_m;
    signal.range_rate_error_mps += epoch.fault.clock_offset_rate_mps;
    signal.slipped = satellite.slipped;
    signals_.push_back(signal);
    const double second_dbhz = satellite.cn0_dbhz - satellite.second_weaker_db;
    const bool second_heard =
        satellite.second_weaker_db <= 0.0 || second_dbhz >= parameters_.sky.cn0_threshold_dbhz;
    if (parameters_.second_signals && has_second_carrier(system) && command_.uses_second(system) &&
        second_heard) {
      signal.second = true;
      signal.cn0_dbhz = second_dbhz;
      if (parameters_.error_model != ErrorModel::paper) {
        const RangeError& error = satellite.error;
        signal.code_error_m += error.second_local_m - error.local_m;
        signal.carrier_error_m += error.second_carrier_m - error.carrier_m;
      }
      signals_.push_back(signal);
    }
  }
  const Eigen::Matrix3d ecef_from_world = frame_.world_from_ecef().transpose();
  observations_.measure(
      *constellation_, reception.time, epoch.clock,
      reception_point(reception.gps, epoch.clock, frame_.to_ecef(reception.ranges_p_W),
                      ecef_from_world * epoch.v_W),
      signals_, sample.measurements);
}

}  // namespace rigwire::sim
