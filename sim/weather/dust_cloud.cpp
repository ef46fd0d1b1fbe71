#include "sim/weather/dust_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr double kLeastOpticalDepth = 5e-4;
/// An emitter goes on filling a puff while it is that near to its centre and the puff that young.
constexpr double kReach_sigma = 1.0;
constexpr double kYoung = 2.0;  ///< Its size against that of a fresh one.
constexpr std::size_t kMostEmitters = 32;
constexpr double kUnionPeriod_s = 0.1;
constexpr double kOverlap_sigma = 0.8;
constexpr double kLikeVariance = 1.5;

/// How much a union of the two changes the cloud.
double union_cost(const DustPuff& a, const DustPuff& b) {
  const double spread_m2 = (a.centre_W - b.centre_W).squaredNorm();
  const double sum_m2 = a.variance_m2 + b.variance_m2;
  const double ratio = (a.variance_m2 - b.variance_m2) / sum_m2;
  return a.mass_kg * b.mass_kg / (a.mass_kg + b.mass_kg) * (spread_m2 / sum_m2 + ratio * ratio);
}

}  // namespace

double DustPuff::share_above_ground() const {
  // Normal distribution's share above the ground's plane.
  return 0.5 * std::erfc(-(centre_W.z() - ground_z_m) / std::sqrt(2.0 * variance_m2));
}

DustPuff merged(const DustPuff& a, const DustPuff& b) {
  DustPuff puff;
  puff.mass_kg = a.mass_kg + b.mass_kg;
  const double share = a.mass_kg / puff.mass_kg;
  const Eigen::Vector3d apart = b.centre_W - a.centre_W;
  puff.centre_W = a.centre_W + (1.0 - share) * apart;
  puff.ground_z_m = share * a.ground_z_m + (1.0 - share) * b.ground_z_m;
  // Second moment about the common centre; the separation's square spread evenly over three axes.
  puff.variance_m2 = share * a.variance_m2 + (1.0 - share) * b.variance_m2 +
                     share * (1.0 - share) * apart.squaredNorm() / 3.0;
  return puff;
}

DustCloud::DustCloud(const DustParameters& parameters) : parameters_(parameters) {
  puffs_.reserve(kMostPuffs + 1);
  open_.reserve(kMostEmitters);
}

double DustCloud::airborne_kg() const {
  double sum_kg = 0.0;
  for (const DustPuff& puff : puffs_) {
    sum_kg += puff.mass_kg;
  }
  return sum_kg;
}

void DustCloud::advance(double step_s, const Eigen::Vector2d& wind_mps, double dustiness,
                        std::span<const DustEmitter> emitters) {
  move(step_s, wind_mps);
  since_union_s_ += step_s;
  if (since_union_s_ >= kUnionPeriod_s) {
    since_union_s_ = 0.0;
    unite_overlapping();
  }
  emitters = emitters.first(std::min(emitters.size(), kMostEmitters));
  if (open_.size() != emitters.size()) {
    open_.assign(emitters.size(), kNoPuff);
  }
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const DustEmitter& emitter = emitters[i];
    const double mass_kg = emitter.mass_rate_kgps * dustiness * step_s;
    // Written so that not-a-number is left out.
    if (!(mass_kg > 0.0) || !std::isfinite(mass_kg) || !emitter.position_W.allFinite()) {
      open_[i] = kNoPuff;
      continue;
    }
    const double sigma_m = std::max(0.5 * emitter.radius_m, 0.05);
    balance_.emitted_kg += mass_kg;
    emit(i,
         {emitter.position_W, emitter.position_W.z() - std::max(emitter.height_over_ground_m, 0.0),
          mass_kg, sigma_m * sigma_m});
  }
}

void DustCloud::move(double step_s, const Eigen::Vector2d& wind_mps) {
  const Eigen::Vector2d way_m = step_s * wind_mps;
  for (std::size_t i = 0; i < puffs_.size();) {
    DustPuff& puff = puffs_[i];
    puff.centre_W.head<2>() += way_m;
    puff.centre_W.z() =
        std::max(puff.centre_W.z() - parameters_.settling_mps * step_s, puff.ground_z_m);
    // Diffusion: ds^2 = 2 K dt.
    puff.variance_m2 += 2.0 * parameters_.diffusivity_m2ps * step_s;
    const double height_m = puff.centre_W.z() - puff.ground_z_m;
    // Density at the ground per mass, a Gaussian in height; dm/dt = -v m (that), exact over h.
    const double at_ground_pm =
        std::exp(-0.5 * height_m * height_m / puff.variance_m2) /
        (std::sqrt(2.0 * std::numbers::pi * puff.variance_m2) * puff.share_above_ground());
    const double settled_kg =
        -puff.mass_kg * std::expm1(-parameters_.settling_mps * at_ground_pm * step_s);
    puff.mass_kg -= settled_kg;
    balance_.settled_kg += settled_kg;
    if (parameters_.mass_extinction_m2pkg * puff.mass_kg <
        2.0 * std::numbers::pi * puff.variance_m2 * kLeastOpticalDepth) {
      // A puff that is still being filled may begin faint.
      if (std::ranges::find(open_, i) == open_.end()) {
        balance_.dispersed_kg += puff.mass_kg;
        remove(i);
        continue;
      }
    }
    ++i;
  }
}

void DustCloud::emit(std::size_t emitter, const DustPuff& fresh) {
  if (const std::size_t open = open_[emitter]; open != kNoPuff) {
    DustPuff& puff = puffs_[open];
    const double distance_m2 = (puff.centre_W - fresh.centre_W).squaredNorm();
    if (distance_m2 < kReach_sigma * kReach_sigma * puff.variance_m2 &&
        puff.variance_m2 < kYoung * kYoung * fresh.variance_m2) {
      puff = merged(puff, fresh);
      return;
    }
  }
  if (puffs_.size() == kMostPuffs) {
    make_room();
  }
  open_[emitter] = puffs_.size();
  puffs_.push_back(fresh);
}

void DustCloud::make_room() {
  double least = std::numeric_limits<double>::infinity();
  std::size_t first = 0;
  std::size_t second = 1;
  for (std::size_t i = 0; i < puffs_.size(); ++i) {
    for (std::size_t j = i + 1; j < puffs_.size(); ++j) {
      const double cost = union_cost(puffs_[i], puffs_[j]);
      if (cost < least) {
        least = cost;
        first = i;
        second = j;
      }
    }
  }
  unite(first, second);
}

void DustCloud::unite_overlapping() {
  for (std::size_t i = 0; i < puffs_.size(); ++i) {
    for (std::size_t j = i + 1; j < puffs_.size();) {
      const double smaller_m2 = std::min(puffs_[i].variance_m2, puffs_[j].variance_m2);
      const double larger_m2 = std::max(puffs_[i].variance_m2, puffs_[j].variance_m2);
      if (larger_m2 < kLikeVariance * smaller_m2 &&
          (puffs_[i].centre_W - puffs_[j].centre_W).squaredNorm() <
              kOverlap_sigma * kOverlap_sigma * smaller_m2) {
        unite(i, j);
      } else {
        ++j;
      }
    }
  }
}

void DustCloud::unite(std::size_t kept, std::size_t gone) {
  puffs_[kept] = merged(puffs_[kept], puffs_[gone]);
  for (std::size_t& open : open_) {
    if (open == gone) {
      open = kept;
    }
  }
  remove(gone);
}

void DustCloud::remove(std::size_t puff) {
  puffs_.erase(puffs_.begin() + static_cast<std::ptrdiff_t>(puff));
  for (std::size_t& open : open_) {
    if (open == puff) {
      open = kNoPuff;
    } else if (open != kNoPuff && open > puff) {
      --open;
    }
  }
}

}  // namespace rigwire::sim
