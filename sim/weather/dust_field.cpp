#include "sim/weather/dust_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/lidar/counter_noise.h"
#include "sim/weather/air_echoes.h"

namespace rigwire::sim {
namespace {

constexpr double kNegligibleDepth = 1e-4;
constexpr std::size_t kGroupPuffs = 8;
constexpr double kRootTwoPi = 2.5066282746310002;
/// Steps of an echogram per half pulse, and their most.
constexpr int kPulseSteps = 4;
constexpr std::size_t kMostSteps = 512;
/// Reflectance of dust in the model optical_depth, relative to white.
constexpr double kDustReflectance = 0.25;

/// cos^2 of the pulse at 0, 1, 2, 3 quarters of its half length.
constexpr std::array<double, kPulseSteps> kPulse{1.0, 0.85355339059327373, 0.5,
                                                 0.14644660940672624};

/// exp(-x) to 1e-5 for 0 <= x <= 0.4.
double fade(double x) {
  if (x > 0.4) {
    return std::exp(-x);
  }
  const double even = 1.0 + x * x / 12.0;
  return (even - 0.5 * x) / (even + 0.5 * x);
}

/// Integral of the overlap of sender and receiver up to s.
double overlap_integral(double s_m, double start_m, double end_m) {
  const double ramp_m = std::clamp(s_m, start_m, end_m) - start_m;
  return 0.5 * ramp_m * ramp_m / (end_m - start_m) + std::max(s_m - end_m, 0.0);
}

/// Standard normal distribution; the ends without a call.
double normal_share(double x) {
  if (std::abs(x) > 6.0) {
    return x > 0.0 ? 1.0 : 0.0;
  }
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

}  // namespace

double middle_depth(const DustPuff& puff, const DustParameters& parameters) {
  // k m / (2 pi s^2)
  const double optical_area_m2 =
      parameters.mass_extinction_m2pkg * puff.mass_kg / puff.share_above_ground();
  return optical_area_m2 / (2.0 * std::numbers::pi * puff.variance_m2);
}

struct DustField::Passages {
  std::array<Passage, kMostPuffs> all;
  std::size_t count = 0;

  [[nodiscard]] std::span<const Passage> span() const { return std::span(all).first(count); }
};

void DustField::fill(std::span<const DustPuff> puffs, const WeatherParameters& parameters) {
  parameters_ = parameters.dust;
  overlap_start_m_ = parameters.overlap_start_m;
  overlap_end_m_ = parameters.overlap_end_m;
  puffs_.clear();
  groups_.clear();
  for (const DustPuff& puff : puffs.first(std::min(puffs.size(), kMostPuffs))) {
    const double depth = middle_depth(puff, parameters_);
    if (!(depth > kNegligibleDepth)) {
      continue;
    }
    const double sigma_m = std::sqrt(puff.variance_m2);
    // Negligible from sqrt(2 s^2 ln(depth / kNegligibleDepth)) on.
    puffs_.push_back({puff.centre_W, 2.0 * puff.variance_m2 * std::log(depth / kNegligibleDepth),
                      sigma_m, 0.5 / puff.variance_m2, depth / (sigma_m * kRootTwoPi)});
  }
  if (!puffs_.empty()) {
    split(0, puffs_.size());
    all_ = group_of(0, puffs_.size());
  }
}

void DustField::split(std::size_t first, std::size_t last) {
  if (last - first <= kGroupPuffs) {
    groups_.push_back(group_of(first, last));
    return;
  }
  Eigen::Vector3d low = puffs_[first].centre_W;
  Eigen::Vector3d high = low;
  for (std::size_t i = first + 1; i < last; ++i) {
    low = low.cwiseMin(puffs_[i].centre_W);
    high = high.cwiseMax(puffs_[i].centre_W);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return puffs_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [axis](const Puff& a, const Puff& b) {
    return a.centre_W(axis) < b.centre_W(axis);
  });
  split(first, middle);
  split(middle, last);
}

DustField::Group DustField::group_of(std::size_t first, std::size_t last) const {
  Eigen::Vector3d low = puffs_[first].centre_W;
  Eigen::Vector3d high = low;
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(std::sqrt(puffs_[i].cut_m2));
    low = low.cwiseMin(puffs_[i].centre_W - reach);
    high = high.cwiseMax(puffs_[i].centre_W + reach);
  }
  Group group{0.5 * (low + high), 0.0, first, last};
  double radius_m = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    radius_m = std::max(radius_m,
                        (puffs_[i].centre_W - group.centre_W).norm() + std::sqrt(puffs_[i].cut_m2));
  }
  group.radius_m2 = radius_m * radius_m;
  return group;
}

void DustField::find(const Eigen::Vector3d& start_W, const Eigen::Vector3d& direction_W,
                     double length_m, Passages& found) const {
  const auto meets = [&](const Eigen::Vector3d& centre_W, double radius_m2) {
    const Eigen::Vector3d to = centre_W - start_W;
    const double nearest_m = std::clamp(to.dot(direction_W), 0.0, length_m);
    return (to - nearest_m * direction_W).squaredNorm() < radius_m2;
  };
  if (!meets(all_.centre_W, all_.radius_m2)) {
    return;
  }
  for (const Group& group : groups_) {
    if (!meets(group.centre_W, group.radius_m2)) {
      continue;
    }
    for (std::size_t i = group.first; i < group.last; ++i) {
      const Puff& puff = puffs_[i];
      const Eigen::Vector3d to = puff.centre_W - start_W;
      // Nearest approach of the beam to the centre; along the beam a Gaussian of the same s.
      const double nearest_m = to.dot(direction_W);
      const double miss_m2 = (to - nearest_m * direction_W).squaredNorm();
      if (miss_m2 >= puff.cut_m2) {
        continue;
      }
      const double half_m = std::sqrt(puff.cut_m2 - miss_m2);
      if (nearest_m + half_m > 0.0 && nearest_m - half_m < length_m) {
        found.all[found.count++] = {
            nearest_m, half_m, puff.peak_pm * std::exp(-miss_m2 * puff.exponent_pm2), puff.sigma_m};
      }
    }
  }
}

double DustField::depth(const Passages& found, double length_m) {
  double sum = 0.0;
  for (const Passage& passage : found.span()) {
    // Line integral of a Gaussian: peak s sqrt(2 pi) (Phi(end) - Phi(start)).
    sum += passage.peak_pm * passage.sigma_m * kRootTwoPi *
           (normal_share((length_m - passage.nearest_m) / passage.sigma_m) -
            normal_share(-passage.nearest_m / passage.sigma_m));
  }
  return sum;
}

double DustField::optical_depth(const Eigen::Vector3d& start_W, const Eigen::Vector3d& direction_W,
                                double length_m) const {
  if (empty()) {
    return 0.0;
  }
  Passages found;
  find(start_W, direction_W, length_m, found);
  return depth(found, length_m);
}

double DustField::extinction_pm(const Eigen::Vector3d& point_W) const {
  double sum_pm = 0.0;
  for (const Puff& puff : puffs_) {
    sum_pm += puff.peak_pm * std::exp(-(point_W - puff.centre_W).squaredNorm() * puff.exponent_pm2);
  }
  return sum_pm;
}

void DustField::along(const WeatherBeam& beam, double air_pm, std::uint64_t counter,
                      AirPath& path) const {
  if (empty()) {
    return;
  }
  Passages found;
  find(beam.start_W, beam.direction_W, beam.far_m, found);
  if (found.count == 0) {
    return;
  }
  if (parameters_.echo == DustEchoModel::optical_depth) {
    by_optical_depth(beam, counter, found, path);
  } else {
    path.transmission *= std::exp(-2.0 * depth(found, beam.far_m));
    backscatter(beam, air_pm, found, path);
  }
}

void DustField::by_optical_depth(const WeatherBeam& beam, std::uint64_t counter,
                                 const Passages& found, AirPath& path) const {
  const double whole = depth(found, beam.far_m);
  const double drawn = parameters_.threshold_depth * counter_uniform(beam.draw_key, counter);
  if (drawn >= whole) {
    return;
  }
  double low_m = 0.0;
  double high_m = beam.far_m;
  // Bisection for the range at which the depth is the drawn one.
  for (int i = 0; i < 30; ++i) {
    const double middle_m = 0.5 * (low_m + high_m);
    (depth(found, middle_m) < drawn ? low_m : high_m) = middle_m;
  }
  path.transmission = 0.0;
  const double range_m = std::max(0.5 * (low_m + high_m), overlap_end_m_);
  if (range_m >= beam.near_m && range_m <= beam.far_m) {
    add_echo(path, {range_m, std::max(kDustReflectance * -std::expm1(-whole) / (range_m * range_m),
                                      beam.detection_energy)});
  }
}

/// What comes back from each step along the beam.
struct DustField::Echogram {
  double first_m = 0.0;
  double step_m = 0.0;
  std::size_t steps = 0;
  std::array<double, kMostSteps> value{};  ///< First extinction, then returned light per metre.

  [[nodiscard]] double range_m(std::size_t i) const {
    return first_m + static_cast<double>(i) * step_m;
  }
  void add(const Passage& passage);
  /// The pulse over the steps around that one, in metres.
  [[nodiscard]] double averaged(std::size_t i) const;
};

void DustField::Echogram::add(const Passage& passage) {
  const double begin = std::ceil((passage.nearest_m - passage.half_m - first_m) / step_m);
  const double end = std::floor((passage.nearest_m + passage.half_m - first_m) / step_m);
  const auto last = static_cast<double>(steps - 1);
  if (end < 0.0 || begin > last) {
    return;
  }
  const auto i0 = static_cast<std::size_t>(std::max(begin, 0.0));
  const auto i1 = static_cast<std::size_t>(std::min(end, last));
  // A Gaussian at equal steps: each ratio of neighbours is the one before times a constant.
  const double exponent = 0.5 / (passage.sigma_m * passage.sigma_m);
  const double from_m = range_m(i0) - passage.nearest_m;
  double here = passage.peak_pm * std::exp(-from_m * from_m * exponent);
  double ratio = std::exp(-(2.0 * from_m + step_m) * step_m * exponent);
  const double change = std::exp(-2.0 * step_m * step_m * exponent);
  for (std::size_t i = i0; i <= i1; ++i) {
    value[i] += here;
    here *= ratio;
    ratio *= change;
  }
}

double DustField::Echogram::averaged(std::size_t i) const {
  double sum = value[i];
  for (std::size_t j = 1; j < kPulseSteps; ++j) {
    sum += kPulse[j] * ((i >= j ? value[i - j] : 0.0) + (i + j < steps ? value[i + j] : 0.0));
  }
  return sum * step_m;
}

void DustField::backscatter(const WeatherBeam& beam, double air_pm, const Passages& found,
                            AirPath& path) const {
  double begin_m = beam.far_m;
  double end_m = 0.0;
  double most_pm = 0.0;
  for (const Passage& passage : found.span()) {
    begin_m = std::min(begin_m, passage.nearest_m - passage.half_m);
    end_m = std::max(end_m, passage.nearest_m + passage.half_m);
    most_pm += passage.peak_pm;
  }
  begin_m = std::max(begin_m, 0.0);
  end_m = std::min(end_m, beam.far_m);
  const double per_extinction = std::numbers::pi / parameters_.lidar_ratio_sr;
  const double least_m = std::max({begin_m, beam.near_m - beam.pulse_m, overlap_start_m_});
  // At range s no echo can be more than that over s^2.
  const double brightest = per_extinction * most_pm * beam.pulse_m;
  end_m = std::min(end_m, std::sqrt(brightest / beam.detection_energy) + beam.pulse_m);
  if (end_m <= least_m) {
    return;  // too thin or too far to be seen
  }
  Echogram echogram;
  echogram.first_m = begin_m;
  echogram.step_m = beam.pulse_m / kPulseSteps;
  echogram.steps =
      std::min(static_cast<std::size_t>((end_m - begin_m) / echogram.step_m) + 1, kMostSteps);
  for (const Passage& passage : found.span()) {
    echogram.add(passage);
  }
  double before_pm = 0.0;
  double transmission = std::exp(-2.0 * air_pm * begin_m);
  if (begin_m == 0.0) {
    before_pm = echogram.value[0];
  }
  for (std::size_t i = 0; i < echogram.steps; ++i) {
    const double here_pm = echogram.value[i];
    if (i > 0) {
      // Two-way depth of a step by the trapezoidal rule.
      transmission *= fade((before_pm + here_pm + 2.0 * air_pm) * echogram.step_m);
    }
    before_pm = here_pm;
    const double s_m = echogram.range_m(i);
    // Mean over the step, which may be longer than the ramp.
    const double half_m = 0.5 * echogram.step_m;
    const double overlap = (overlap_integral(s_m + half_m, overlap_start_m_, overlap_end_m_) -
                            overlap_integral(s_m - half_m, overlap_start_m_, overlap_end_m_)) /
                           echogram.step_m;
    echogram.value[i] =
        overlap > 0.0 ? per_extinction * here_pm * transmission * overlap / (s_m * s_m) : 0.0;
    if (brightest * transmission < beam.detection_energy * s_m * s_m) {
      echogram.steps = i + 1;  // nothing beyond can be seen
    }
  }
  AirEcho echo;
  double before = 0.0;
  for (std::size_t i = 0; i < echogram.steps; ++i) {
    const double s_m = echogram.range_m(i);
    if (s_m < beam.near_m) {
      continue;
    }
    const double energy = echogram.averaged(i);
    if (energy >= beam.detection_energy) {
      if (echo.energy == 0.0) {
        // Leading edge: linear between the steps about the limit.
        const double share = (beam.detection_energy - before) / (energy - before);
        echo.range_m =
            std::max(s_m - (1.0 - std::clamp(share, 0.0, 1.0)) * echogram.step_m, beam.near_m);
      }
      echo.energy = std::max(echo.energy, energy);
    } else if (echo.energy > 0.0) {
      add_echo(path, echo);
      echo = {};
    }
    before = energy;
  }
  if (echo.energy > 0.0) {
    add_echo(path, echo);
  }
}

}  // namespace rigwire::sim
