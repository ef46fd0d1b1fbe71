#include "sim/excavator/digging_excavator.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kDustSmoothing_s = 0.1;
/// Minimum drop height of soil that slides over the lip.
constexpr double kLeastDrop_m = 0.3;
constexpr double kNoDust_kgps = 1e-7;

ExcavatorParameters with_payload(ExcavatorParameters parameters, const DiggingParameters& digging,
                                 const DiggableTerrain& terrain) {
  const BucketCapacity capacity(digging.bucket, parameters.bucket_tip_m);
  parameters.payload_max_kg =
      std::max(parameters.payload_max_kg, capacity.heaped_m3() * terrain.density_greatest_kgpm3());
  return parameters;
}

}  // namespace

DiggingExcavator::DiggingExcavator(const ExcavatorParameters& parameters,
                                   const DiggingParameters& digging, const Eigen::Isometry3d& X_WC,
                                   Ground& ground)
    : terrain_(ground, digging.terrain),
      excavator_(with_payload(parameters, digging, terrain_), X_WC, &ground),
      bucket_(digging.bucket, parameters.bucket_tip_m, parameters.gravity_mps2, terrain_,
              excavator_.link(Link::bucket)),
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))),
      bucket_tip_m_(parameters.bucket_tip_m),
      bucket_width_m_(digging.bucket.width_m) {
  const auto quantities = excavator_.status_quantities();
  status_quantities_.assign(quantities.begin(), quantities.end());
  status_quantities_.push_back({"payload", "kg"});
  status_quantities_.push_back({"dig depth", "cm"});
  const auto fields = excavator_.truth_fields();
  truth_fields_.assign(fields.begin(), fields.end());
  for (const TruthField& field : fields) {
    excavator_truth_ += field.count;
  }
  for (const char* key : {"bucket_soil_m3", "payload_kg", "dumped_elsewhere_m3", "dig_depth_m"}) {
    truth_fields_.push_back({key, 1});
  }
}

void DiggingExcavator::step(Duration span) {
  while (span > Duration{0} && !non_finite()) {
    const Duration inner = std::min(span, inner_span_);
    inner_step(inner);
    span -= inner;
  }
}

void DiggingExcavator::inner_step(Duration span) {
  const double h = to_seconds(span);
  const BucketGroundLoad load = bucket_.load(h, excavator_.link(Link::bucket));
  excavator_.set_bucket_force(load.force_W, load.point_W);
  excavator_.set_bucket_resistances({load.resistances.data(), load.count});
  excavator_.step(span);
  if (non_finite()) {
    return;
  }
  bucket_.advance(h, excavator_.link(Link::bucket));
  if (bucket_.mass_kg() != payload_kg_) {
    payload_kg_ = bucket_.mass_kg();
    excavator_.set_payload_kg(payload_kg_);
  }
  update_dust(h, excavator_.link(Link::bucket).X_WL);
}

void DiggingExcavator::follow(Duration span, std::span<const LinkMotion> links) {
  const LinkMotion& bucket = links[static_cast<std::size_t>(Link::bucket)];
  if (span <= Duration{0}) {
    bucket_.place(bucket);
    return;
  }
  bucket_.advance(to_seconds(span), bucket);
  update_dust(to_seconds(span), bucket.X_WL);
}

void DiggingExcavator::update_dust(double h, const Eigen::Isometry3d& X_WB) {
  const Eigen::Vector3d lip_W = X_WB * Eigen::Vector3d(bucket_tip_m_, 0.0, 0.0);
  const double height_m = std::max(0.0, lip_W.z() - terrain_.height_m(lip_W.x(), lip_W.y()));
  const double moved_m3 = bucket_.volume_m3() - bucket_m3_;
  bucket_m3_ += moved_m3;
  const double drop_m = moved_m3 < 0.0 ? std::max(height_m, kLeastDrop_m) : kLeastDrop_m;
  // Dust of the soil moved (dust_emitter.h), smoothed by a first-order lag exact over h.
  const double keep = std::exp(-h / kDustSmoothing_s);
  dust_.mass_rate_kgps = keep * dust_.mass_rate_kgps +
                         (1.0 - keep) * dropped_soil_dust_kgpm3(drop_m) * std::abs(moved_m3) / h;
  if (dust_.mass_rate_kgps < kNoDust_kgps) {
    dust_.mass_rate_kgps = 0.0;
  }
  // Half way down, where the falling soil has been stretched into a curtain.
  dust_.position_W = lip_W - Eigen::Vector3d(0.0, 0.0, 0.5 * height_m);
  dust_.height_over_ground_m = 0.5 * height_m;
  dust_.radius_m = 0.5 + 0.25 * height_m;
}

void DiggingExcavator::read_status(std::span<double> values) const {
  const std::size_t own = excavator_.status_quantities().size();
  excavator_.read_status(values.first(own));
  values[own] = bucket_.mass_kg();
  values[own + 1] = bucket_.depth_m() * 100.0;
}

void DiggingExcavator::read_truth(std::span<double> values) const {
  excavator_.read_truth(values.first(excavator_truth_));
  const auto own = values.subspan(excavator_truth_);
  own[0] = bucket_.volume_m3();
  own[1] = bucket_.mass_kg();
  own[2] = bucket_.elsewhere_m3();
  own[3] = bucket_.depth_m();
}

std::vector<BodyPoint> DiggingExcavator::body_points() const {
  std::vector<BodyPoint> points = excavator_.body_points();
  const Eigen::Isometry3d& X_WB = excavator_.link(Link::bucket).X_WL;
  for (const double side : {-0.5, 0.5}) {
    points.push_back(
        {"bucket", X_WB * Eigen::Vector3d(bucket_tip_m_, side * bucket_width_m_, 0.0)});
  }
  return points;
}

std::int64_t DiggingExcavator::balance_units() const {
  return terrain_.gained_units() + bucket_.units() + bucket_.elsewhere_units();
}

}  // namespace rigwire::sim
