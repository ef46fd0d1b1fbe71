#include "sim/gnss/navigation_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>

#include "fields/visitor.h"
#include "sim/gnss/constellation.h"

namespace rigwire::sim {

using fields::in;

namespace {

using State = NavigationFilter::State;
using Covariance = NavigationFilter::Covariance;

constexpr int kVelocity = 3;
constexpr int kClock = 6;
constexpr int kClockRate = 7;
constexpr int kClockSystems = 8;

// Standard deviations of who knows nothing; clocks of the systems are broadcast to some metres.
constexpr double kAnywhere_m = 1e4;
constexpr double kAnySpeed_mps = 300.0;
constexpr double kAnyClock_m = 3e5;
constexpr double kAnyClockRate_mps = 1e3;
constexpr double kSystemClock_m = 10.0;
/// A range of one overhead under an open sky: what weights are relative to.
constexpr double kUsualSigma_m = 1.8;
constexpr double kDoubtful = 5.0;
/// Ranges beyond the unknowns that have to agree for one that contradicts them to be left out.
constexpr std::size_t kRedundant = 1;
/// Squared innovations over variances: so large they are by chance, and over so long is the mean.
constexpr double kUsualSquare = 0.5;
constexpr double kUsualByCarriers = 2.0;  // as long as the state has so much of theirs
constexpr double kForgotten_m = 1e-4;
constexpr double kInnovationMean_s = 10.0;
// By how much the filter widens itself when it was wrong.
constexpr double kWiden_m = 100.0;
constexpr double kWiden_mps = 10.0;
/// A velocity that is known to be zero.
constexpr double kStill_mps = 0.01;
constexpr double kLowestSine = 0.087;

/// State of the clock beside that of GPS; none for GPS, SBAS and QZSS.
int system_state(GnssSystem system) {
  switch (system) {
    case GnssSystem::glonass:
      return kClockSystems;
    case GnssSystem::galileo:
      return kClockSystems + 1;
    case GnssSystem::beidou:
      return kClockSystems + 2;
    default:
      return -1;
  }
}

/// P' = F P F^T with F = 1 but for position and clock, to which their rates are added `h` times.
void transport(Covariance& p, double h) {
  p.topRows<3>() += h * p.middleRows<3>(kVelocity);
  p.row(kClock) += h * p.row(kClockRate);
  p.leftCols<3>() += h * p.middleCols<3>(kVelocity);
  p.col(kClock) += h * p.col(kClockRate);
}

template <class Columns>
void transport_columns(Columns& b, double h) {
  b.template topRows<3>() += h * b.template middleRows<3>(kVelocity);
  b.row(kClock) += h * b.row(kClockRate);
}

double faded(double step_s, double correlation_s) {
  return correlation_s > 0.0 ? std::exp(-step_s / correlation_s) : 0.0;
}

}  // namespace

void visit(fields::Visitor& v, NavigationParameters& p) {
  v.number("code_sigma", p.code_sigma_m, in("m").between(0.01, 1000),
           "What the filter takes a pseudorange overhead for; larger: smoother and slower.");
  v.number("rate_sigma", p.rate_sigma_mps, in("m/s").between(0.001, 100),
           "What the filter takes a range rate for; larger: smoother speed, and later.");
}

double NavigationSignal::sigma_m() const {
  double variance = noise_sigma_m * noise_sigma_m + multipath_sigma_m * multipath_sigma_m +
                    orbit_sigma_m * orbit_sigma_m;
  for (const double common : common_m) {
    variance += common * common;
  }
  return std::sqrt(variance);
}

NavigationFilter::NavigationFilter(const NavigationParameters& parameters, std::size_t satellites)
    : parameters_(parameters), own_(satellites) {
  with_common_.setZero();
  with_carriers_.setZero();
  present_.reserve(satellites);
  ranges_.reserve(satellites);
  rates_.reserve(satellites);
  others_.reserve(6);
  left_out_.reserve(satellites);
  residuals_m_.reserve(satellites);
}

void NavigationFilter::begin(const NavigationTruth& truth) {
  set(truth);
  systems_m_.setZero();
  State variances;
  variances.head<3>().setConstant(kAnywhere_m * kAnywhere_m);
  variances.segment<3>(kVelocity).setConstant(kAnySpeed_mps * kAnySpeed_mps);
  variances(kClock) = kAnyClock_m * kAnyClock_m;
  variances(kClockRate) = kAnyClockRate_mps * kAnyClockRate_mps;
  variances.tail<3>().setConstant(kSystemClock_m * kSystemClock_m);
  believed_ = variances.asDiagonal();
  actual_ = believed_;
  with_common_.setZero();
  with_carriers_.setZero();
  for (const std::size_t source : present_) {
    own_[source] = {};
  }
  present_.clear();
  innovation_ = 0.0;
  begun_ = true;
}

void NavigationFilter::set(const NavigationTruth& truth) {
  p_W_ = truth.p_W;
  v_W_ = truth.v_W;
  clock_m_ = truth.clock_m;
  clock_rate_mps_ = truth.clock_rate_mps;
}

State NavigationFilter::error(const NavigationTruth& truth) const {
  State error;
  error << p_W_ - truth.p_W, v_W_ - truth.v_W, clock_m_ - truth.clock_m,
      clock_rate_mps_ - truth.clock_rate_mps, systems_m_;
  return error;
}

void NavigationFilter::predict(double step_s, const NavigationNoise& noise,
                               const NavigationCorrelation& correlation,
                               const Eigen::Matrix3d& ned_from_world) {
  if (!begun_ || step_s <= 0.0) {
    return;
  }
  step_s_ = step_s;
  const double h = step_s;
  p_W_ += h * v_W_;
  clock_m_ += h * clock_rate_mps_;
  const double level = noise.horizontal * noise.horizontal;
  const double upright = noise.vertical * noise.vertical;
  const Eigen::Matrix3d q = ned_from_world.transpose() *
                            Eigen::Vector3d(level, level, upright).asDiagonal() * ned_from_world;
  // Q of white acceleration: [h^3/3 h^2/2; h^2/2 h].
  const double h2 = h * h / 2.0;
  const double h3 = h * h * h / 3.0;
  for (Covariance* p : {&believed_, &actual_}) {
    transport(*p, h);
    p->topLeftCorner<3, 3>() += h3 * q;
    p->block<3, 3>(0, kVelocity) += h2 * q;
    p->block<3, 3>(kVelocity, 0) += h2 * q;
    p->block<3, 3>(kVelocity, kVelocity) += h * q;
    (*p)(kClock, kClock) += h3 * noise.clock_rate_mps2s + h * noise.clock_m2ps;
    (*p)(kClock, kClockRate) += h2 * noise.clock_rate_mps2s;
    (*p)(kClockRate, kClock) += h2 * noise.clock_rate_mps2s;
    (*p)(kClockRate, kClockRate) += h * noise.clock_rate_mps2s;
  }
  // What stays fades by exp(-h / tau), and so does what the state has in common with it.
  transport_columns(with_common_, h);
  with_common_.leftCols<3>() *= faded(h, correlation.ionosphere_s);
  with_common_.col(3) *= faded(h, correlation.troposphere_s);
  transport_columns(with_carriers_, h);
  with_carriers_ *= faded(h, correlation.carrier_s);
  const double orbit = faded(h, correlation.orbit_s);
  const double multipath = faded(h, correlation.multipath_s);
  for (const std::size_t source : present_) {
    auto& with = own_[source].with;
    transport_columns(with, h);
    with.col(0) *= orbit;
    with.col(1) *= multipath;
  }
}

void NavigationFilter::make_rows(const NavigationTruth& truth,
                                 std::span<const NavigationSignal> signals) {
  const State error = this->error(truth);
  ranges_.clear();
  rates_.clear();
  for (const NavigationSignal& signal : signals) {
    const double sigma_m = std::hypot(signal.sigma_m(), signal.mistrust_sigma_m);
    Row range;
    range.h.head<3>() = -signal.direction_W;
    range.h(kClock) = 1.0;
    if (const int state = system_state(signal.system); state >= 0) {
      range.h(state) = 1.0;
    }
    const double code_m = parameters_.code_sigma_m * sigma_m / kUsualSigma_m;
    range.variance = code_m * code_m;
    range.white = signal.noise_sigma_m * signal.noise_sigma_m;
    range.innovation = signal.range_error_m - range.h.dot(error);
    ranges_.push_back(range);

    // A range rate is worse towards the horizon, and by its noise where that is large.
    const double up = (truth.ned_from_world * signal.direction_W).z();
    const double usual_mps = parameters_.rate_sigma_mps / std::sqrt(std::max(-up, kLowestSine));
    Row rate;
    rate.h.segment<3>(kVelocity) = -signal.direction_W;
    rate.h(kClockRate) = 1.0;
    rate.white = signal.rate_noise_mps * signal.rate_noise_mps;
    rate.variance = usual_mps * usual_mps + rate.white;
    rate.innovation = signal.rate_error_mps - rate.h.dot(error);
    rates_.push_back(rate);
  }
}

bool NavigationFilter::agree(std::span<const NavigationSignal> signals) {
  left_out_.assign(signals.size(), false);
  std::size_t beyond = 0;
  double squares = 0.0;
  std::uint32_t systems = 0;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    // Innovation against its variance: of a range by what stays, of a rate by the filter's own.
    const double sigma_m = signals[i].sigma_m();
    const double range = ranges_[i].h.dot(actual_ * ranges_[i].h) + sigma_m * sigma_m;
    squares += std::min(kDoubtful * kDoubtful, std::pow(ranges_[i].innovation, 2) / range);
    systems |= 1U << static_cast<unsigned>(system_state(signals[i].system) + 1);
    const double rate = rates_[i].h.dot(believed_ * rates_[i].h) + rates_[i].variance;
    left_out_[i] = std::abs(ranges_[i].innovation) > kDoubtful * std::sqrt(range) ||
                   std::abs(rates_[i].innovation) > kDoubtful * std::sqrt(rate);
    beyond += left_out_[i] ? 1 : 0;
  }
  if (!signals.empty()) {
    const double fresh = 1.0 - std::exp(-step_s_ / kInnovationMean_s);
    innovation_ += fresh * (squares / static_cast<double>(signals.size()) - innovation_);
  }
  if (2 * beyond > signals.size()) {
    left_out_.assign(signals.size(), false);
    return false;
  }
  const auto unknown = std::size_t{3} + static_cast<std::size_t>(std::popcount(systems));
  if (signals.size() - beyond < unknown + kRedundant) {
    left_out_.assign(signals.size(), false);
  }
  return true;
}

void NavigationFilter::widen() {
  for (Covariance* p : {&believed_, &actual_}) {
    p->diagonal().head<3>().array() += kWiden_m * kWiden_m;
    p->diagonal().segment<3>(kVelocity).array() += kWiden_mps * kWiden_mps;
    (*p)(kClock, kClock) += kAnyClock_m * kAnyClock_m;
    (*p)(kClockRate, kClockRate) += kAnyClockRate_mps * kAnyClockRate_mps;
  }
}

void NavigationFilter::apply(std::span<const NavigationSignal> signals) {
  const Covariance inverse = believed_.llt().solve(Covariance::Identity());
  Covariance information = inverse;
  const auto inform = [&](const Row& row) {
    information.selfadjointView<Eigen::Lower>().rankUpdate(row.h, 1.0 / row.variance);
  };
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (!left_out_[i]) {
      inform(ranges_[i]);
      inform(rates_[i]);
    }
  }
  std::ranges::for_each(others_, inform);
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
  const Covariance after = information.llt().solve(Covariance::Identity());

  // Gains K = P+ h / r; what they make of errors that stay (columns) and of those that do not.
  const Covariance keep = after * inverse;  // 1 - K H
  State change = State::Zero();
  Covariance white = Covariance::Zero();
  const auto gain = [&](const Row& row) -> State {
    State k = after * row.h / row.variance;
    change += k * row.innovation;
    white.selfadjointView<Eigen::Lower>().rankUpdate(k, row.white);
    return k;
  };
  Covariance stays = Covariance::Zero();  // G G^T + (1 - K H) B G^T, column by column
  const auto join = [&](State& with, const State& made) {
    with = keep * with;
    stays.noalias() += (0.5 * made + with) * made.transpose();
    with += made;
  };
  for (const std::size_t source : present_) {
    own_[source].present = false;
  }
  Eigen::Matrix<double, kStates, static_cast<int>(kCommonErrors)> common;
  common.setZero();
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (left_out_[i]) {
      continue;
    }
    const NavigationSignal& signal = signals[i];
    const State k = gain(ranges_[i]);
    (void)gain(rates_[i]);
    for (std::size_t c = 0; c < kCommonErrors; ++c) {
      common.col(static_cast<Eigen::Index>(c)) += signal.common_m[c] * k;
    }
    Own& own = own_[signal.source];
    own.present = true;
    State with = own.with.col(0);
    join(with, signal.orbit_sigma_m * k);
    own.with.col(0) = with;
    with = own.with.col(1);
    join(with, signal.multipath_sigma_m * k);
    own.with.col(1) = with;
  }
  Eigen::Matrix<double, kStates, 3> by_carriers;
  by_carriers.setZero();
  for (const Row& row : others_) {
    const State k = gain(row);
    by_carriers.col(row.axis) += row.stays_m * k;
  }
  for (Eigen::Index axis = 0; axis < by_carriers.cols(); ++axis) {
    State with = with_carriers_.col(axis);
    join(with, by_carriers.col(axis));
    with_carriers_.col(axis) = with;
  }
  for (Eigen::Index c = 0; c < common.cols(); ++c) {
    State with = with_common_.col(c);
    join(with, common.col(c));
    with_common_.col(c) = with;
  }
  white.triangularView<Eigen::StrictlyUpper>() = white.transpose();
  actual_ = keep * actual_ * keep.transpose() + white + stays + stays.transpose().eval();
  believed_ = after;

  // What a satellite that is gone had in common with the state is not followed any further.
  for (const std::size_t source : present_) {
    if (!own_[source].present) {
      own_[source] = {};
    }
  }
  present_.clear();
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (!left_out_[i]) {
      present_.push_back(signals[i].source);
    }
  }
  p_W_ += change.head<3>();
  v_W_ += change.segment<3>(kVelocity);
  clock_m_ += change(kClock);
  clock_rate_mps_ += change(kClockRate);
  systems_m_ += change.tail<3>();
}

/// Makes the position of the state that of the carriers. Its error is then the carriers' alone: it
/// is correlated with the other states only by what earlier positions by carriers put there.
void NavigationFilter::go_on_from(const Position& position, const NavigationTruth& truth) {
  const Eigen::Matrix3d world_from_ned = truth.ned_from_world.transpose();
  p_W_ = truth.p_W + world_from_ned * position.error_ned_m;
  const Eigen::Matrix3d made = world_from_ned * position.sigma_ned_m.asDiagonal();
  with_carriers_.topRows<3>() = made;
  with_common_.topRows<3>().setZero();
  for (const std::size_t source : present_) {
    own_[source].with.topRows<3>().setZero();
  }
  actual_.topRows<3>() = made * with_carriers_.transpose();
  actual_.leftCols<3>() = actual_.topRows<3>().transpose();
}

void NavigationFilter::update(const NavigationTruth& truth,
                              std::span<const NavigationSignal> signals,
                              const std::optional<Position>& position, bool still) {
  const bool fresh = !begun_;
  if (fresh) {
    begin(truth);
  }
  if (truth.clock_reset) {
    constexpr double kMillisecond_m = kLightSpeed_mps * 1e-3;
    clock_m_ += kMillisecond_m * std::round((truth.clock_m - clock_m_) / kMillisecond_m);
  }
  make_rows(truth, signals);
  const State error = this->error(truth);
  others_.clear();
  for (Eigen::Index axis = 0; axis < 3 && position; ++axis) {
    if (std::isfinite(position->sigma_ned_m(axis))) {
      Row row;
      row.h.head<3>() = truth.ned_from_world.row(axis).transpose();
      row.variance = std::pow(position->sigma_ned_m(axis), 2);
      row.white = position->by_carriers ? 0.0 : row.variance;
      row.stays_m = position->by_carriers ? position->sigma_ned_m(axis) : 0.0;
      row.axis = static_cast<int>(axis);
      row.innovation = position->error_ned_m(axis) - row.h.dot(error);
      others_.push_back(row);
    }
  }
  for (Eigen::Index axis = 0; axis < 3 && still; ++axis) {
    Row row;
    row.h(kVelocity + axis) = 1.0;
    row.variance = row.white = kStill_mps * kStill_mps;
    row.innovation = -truth.v_W(axis) - row.h.dot(error);
    others_.push_back(row);
  }
  if (still) {
    for (Row& rate : rates_) {
      rate.variance = 1e12;  // zero is believed
    }
  }
  if (!agree(signals) && !fresh) {
    widen();
  }
  apply(signals);
  if (position && position->by_carriers) {
    go_on_from(*position, truth);
  }
  const State left = this->error(truth);
  residuals_m_.clear();
  for (std::size_t i = 0; i < signals.size(); ++i) {
    residuals_m_.push_back(signals[i].range_error_m - ranges_[i].h.dot(left));
  }
}

double NavigationFilter::disagreement() const {
  // A state by carriers has none of what stays in ranges, so that their innovations have all of it,
  // until it has come to share it.
  const bool by_carriers = with_carriers_.topRows<3>().norm() > kForgotten_m;
  return std::max(1.0, innovation_ / (by_carriers ? kUsualByCarriers : kUsualSquare));
}

double NavigationFilter::clock_variance_m2() const {
  return actual_(kClock, kClock);
}

double NavigationFilter::clock_rate_variance() const {
  return believed_(kClockRate, kClockRate);
}

}  // namespace rigwire::sim
