#include "sim/lidar/beam_caster.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "fields/constants.h"
#include "sim/lidar/beam_air.h"
#include "sim/lidar/beam_sampler.h"
#include "sim/lidar/counter_noise.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr std::size_t kMostSubRays = 1000 + 6;

SubRayAim aim_of(const SubRay& ray) {
  // Place in the plane across the beam at distance 1, and one over the ray's length to it.
  const double right = std::tan(ray.right_rad);
  const double up = std::tan(ray.up_rad);
  return {.right = static_cast<float>(right),
          .up = static_cast<float>(up),
          .shrink = static_cast<float>(1.0 / std::sqrt(1.0 + right * right + up * up)),
          .weight = static_cast<float>(ray.weight),
          .patch_right = static_cast<float>(0.5 * ray.spacing_right_rad),
          .patch_up = static_cast<float>(0.5 * ray.spacing_up_rad)};
}

/// The z axes of the sensor, one per lane.
std::array<LaneArray, 3> spin_axes(const FiringBlock& block, const LaneMap& map) {
  std::array<LaneArray, 3> axis;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto column = block.lanes.R(6 + i);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      axis[i][lane] = column(static_cast<Eigen::Index>(map.firing[lane]));
    }
  }
  return axis;
}

/// Returns the packets of a group, beam by beam: rays of one beam mostly hit the same surfaces.
std::vector<RayChoice> choices(std::size_t sub_rays) {
  std::vector<RayChoice> result(sub_rays);
  for (std::size_t i = 0; i < sub_rays * kLanes; ++i) {
    const std::size_t beam = i / sub_rays;
    result[i / kLanes].ray[i % kLanes] = static_cast<std::int32_t>(i % sub_rays * kLanes + beam);
    result[i / kLanes].beam[i % kLanes] = static_cast<std::int32_t>(beam);
  }
  return result;
}

/// Writes the truth from the hits of the beams' middle rays.
void tell_truth(const Scene::Internals& scene, const RTCRayHit8& packet, const RayChoice& choice,
                const HitSurfaces& surfaces, std::array<LidarShotTruth, kLanes>& truth) {
  const SurfaceNumbers surface(packet.hit);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (choice.ray[lane] == choice.beam[lane]) {  // sub-ray 0
      truth[static_cast<std::size_t>(choice.beam[lane])] =
          surface[lane] == RTC_INVALID_GEOMETRY_ID
              ? LidarShotTruth{}
              : LidarShotTruth{packet.ray.tfar[lane], scene.instance_of[surface[lane]],
                               surfaces.cosine[lane]};
    }
  }
}

void set_lane(EchoLanes& lanes, std::size_t lane, const EchoPart& echo) {
  lanes.range_m[lane] = echo.range_m;
  lanes.energy[lane] = echo.energy;
  lanes.brightness[lane] = echo.brightness;
}

/// The order of a shot's echoes once some were lost, or left the range window by their errors.
void close_ranks(LidarReturn& strongest, LidarReturn& second, LidarReturn& last) {
  const auto none = [](const LidarReturn& echo) { return !(echo.range_m > 0.0F); };
  if (none(strongest)) {
    strongest = none(second) ? last : second;
    second = {};
  }
  if (none(last)) {
    last = second.range_m > strongest.range_m ? second : strongest;
  }
  if (none(second) && last != strongest) {
    second = last;
  }
}

}  // namespace

struct BeamCaster::Beams {
  RTCRayHit8 middle{};  ///< Where the middles go. Not cast.
  Across across;
  std::array<LidarShotTruth, kLanes> truth;
  ShotNumbers shots{};
  std::array<AirEchoes, kLanes> air;
  std::array<SubRayHits, kMostSubRays> hits;
  /// Parts of the beam that is worked on.
  std::array<EchoPart, kMostSubRays + kMaxAirEchoes> parts;
};

struct BeamCaster::Echoes {
  EchoLanes strongest;
  EchoLanes second;
  EchoLanes last;
  bool any_second = false;
  bool any_third = false;  ///< `last` holds echoes that are neither of the others.
  std::array<bool, kLanes> last_is_strongest{};
  std::array<bool, kLanes> last_is_second{};
};

BeamCaster::BeamCaster(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                       std::uint64_t seed, std::string_view name)
    : model_(parameters, pattern, seed, name),
      compensates_incidence_(parameters.compensates_incidence),
      divergence_rad_(
          std::sqrt(pattern.beam.horizontal_divergence_rad * pattern.beam.vertical_divergence_rad)),
      air_key_(RandomStream(seed, std::string(name) + "/air").bits()) {
  // Half a pulse's length in space, c tau / 2.
  rules_.pulse_m = static_cast<float>(0.5 * kSpeedOfLight_mps * to_seconds(pattern.beam.pulse));
  rules_.separation_m = static_cast<float>(parameters.echo_separation_m);
  rules_.threshold = model_.threshold();
  for (const SubRay& ray : sample_beam(pattern.beam, sim::rays_per_beam(parameters, false))) {
    aims_.push_back(aim_of(ray));
    weights_.push_back(aims_.back().weight);
  }
  if (parameters.blooming_share > 0.0) {
    for (const SubRay& ray :
         sample_halo(parameters.blooming_angle_rad, parameters.blooming_share)) {
      aims_.push_back(aim_of(ray));
    }
  }
  whole_group_ = choices(RayGroup::kMostSubRays);
  const std::size_t rest = aims_.size() % RayGroup::kMostSubRays;
  last_group_ = rest == 0 ? whole_group_ : choices(rest);
}

std::span<SubRayHits> BeamCaster::hits_of(Beams& beams) const {
  return std::span(beams.hits).first(aims_.size());
}

void BeamCaster::cast(const BlockCast& cast) const {
  const FlushDenormals flush;
  const bool air = cast.weather != nullptr && cast.weather->present();
  Beams beams;
  for (const RingPacket& plan : cast.packets) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      beams.shots[lane] = cast.shot_number(plan.map.firing[lane], plan.map.laser[lane]);
    }
    trace(cast, plan, beams);
    if (air) {
      meet_air(cast, beams);
    }
    Echoes echoes;
    detect(beams, echoes);
    report(cast, plan, beams, echoes);
  }
}

/// Casts all sub-rays of a packet's beams, at most RayGroup::kMostSubRays of each beam at a time,
/// and computes the energy that each receives in clear air (receive_hits()).
void BeamCaster::trace(const BlockCast& cast, const RingPacket& plan, Beams& beams) const {
  const Scene::Internals& in = cast.scene.internals();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid;
  valid.fill(-1);

  const GrainLattice lattice(in.origin_W);
  fill_packet(cast.block, plan, cast.limits, beams.middle);
  const RTCRay8& middle = beams.middle.ray;
  look_across(middle, spin_axes(cast.block, plan.map), beams.across);
  RayGroup group;
  for (std::size_t first = 0; first < aims_.size(); first += RayGroup::kMostSubRays) {
    const std::size_t count = std::min(RayGroup::kMostSubRays, aims_.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      aim_rays(middle, beams.across, aims_[first + i], i, group);
    }
    for (const RayChoice& choice : first + count < aims_.size() ? whole_group_ : last_group_) {
      RTCRayHit8 packet;
      load_rays(middle, group, choice, packet);
      in.intersect(valid.data(), context, packet);
      HitSurfaces surfaces;
      meet_surfaces(in.shading.data(), packet, surfaces);
      if (in.varies) {
        vary_reflectance(in, lattice, packet, surfaces.reflectance);
      }
      store_hits(packet, surfaces, choice, group);
      if (first == 0 && !cast.truth.empty()) {
        tell_truth(in, packet, choice, surfaces, beams.truth);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Reception reception{.minimum_m = model_.minimum_range_m(),
                                .retro_alone = first + i >= weights_.size(),
                                .compensates_incidence = compensates_incidence_};
      receive_hits(group, i, beams.across, aims_[first + i], reception, beams.hits[first + i]);
    }
  }
}

void BeamCaster::meet_air(const BlockCast& cast, Beams& beams) const {
  const RTCRay8& ray = beams.middle.ray;
  const Eigen::Vector3d& origin_W = cast.scene.internals().origin_W;
  const Duration length = cast.slice.t1 - cast.slice.t0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    WeatherBeam beam;
    beam.start_W =
        origin_W +
        Eigen::Vector3f(ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]).cast<double>();
    beam.direction_W =
        Eigen::Vector3f(ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]).cast<double>();
    beam.near_m = model_.air_minimum_range_m();
    beam.far_m = static_cast<double>(cast.limits.far_m);
    beam.focus_m = model_.air_focus_range_m();
    beam.divergence_rad = divergence_rad_;
    beam.pulse_m = static_cast<double>(rules_.pulse_m);
    // Instant of the shot, from Embree's time of 0 .. 1 over the slice.
    beam.time =
        cast.slice.t0 + Duration{static_cast<Duration::rep>(static_cast<double>(ray.time[lane]) *
                                                            static_cast<double>(length.count()))};
    beam.detection_energy = model_.air_threshold();
    beam.draw_key = counter_bits(air_key_, beams.shots[lane]);
    beams.air[lane] = pass_air(*cast.weather, beam, weights_, hits_of(beams), lane);
  }
}

void BeamCaster::detect(Beams& beams, Echoes& echoes) const {
  const std::span<const SubRayHits> hits = hits_of(beams);
  LaneArray near_m;
  LaneArray far_m;
  find_extent(hits, near_m, far_m);
  sum_up(hits, near_m, echoes.strongest);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    echoes.last_is_strongest[lane] = true;
    const AirEchoes& air = beams.air[lane];
    if (air.count == 0 && far_m[lane] - near_m[lane] <= rules_.pulse_m) {
      continue;  // one echo at most, summed up already
    }
    std::span<EchoPart> parts = beams.parts;
    std::size_t count = 0;
    for (const SubRayHits& hit : hits) {
      if (hit.energy[lane] > 0.0F) {
        parts[count++] = {hit.range_m[lane], hit.energy[lane], hit.brightness[lane],
                          hit.patch_m[lane]};
      }
    }
    for (std::size_t k = 0; k < air.count; ++k) {
      parts[count++] = air.parts[k];
    }
    const DetectedEchoes detected = detect_echoes(parts.first(count), rules_);
    set_lane(echoes.strongest, lane, detected.strongest);
    set_lane(echoes.second, lane, detected.second);
    echoes.last_is_strongest[lane] = detected.last_is_strongest;
    echoes.last_is_second[lane] = detected.last_is_second;
    echoes.any_second = echoes.any_second || detected.count > 1;
    if (!detected.last_is_strongest && !detected.last_is_second) {
      set_lane(echoes.last, lane, detected.last);
      echoes.any_third = true;
    }
  }
}

void BeamCaster::report(const BlockCast& cast, const RingPacket& plan, const Beams& beams,
                        const Echoes& echoes) const {
  const EightReturns strongest = model_.report(echoes.strongest, beams.shots, EchoRank::strongest);
  EightReturns second{};
  EightReturns last{};
  if (cast.several && echoes.any_second) {
    second = model_.report(echoes.second, beams.shots, EchoRank::second);
  }
  if (cast.several && echoes.any_third) {
    last = model_.report(echoes.last, beams.shots, EchoRank::last);
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t laser = plan.map.laser[lane];
    const std::size_t bank = cast.bank_of(plan.map.firing[lane], laser);
    const std::size_t i = laser % kBankLasers;
    LidarFiring& firing = cast.firings[bank];
    firing.strongest[i] = strongest[lane];
    if (cast.several) {
      firing.several = true;
      firing.second[i] = second[lane];
      firing.last[i] = echoes.last_is_strongest[lane] ? strongest[lane]
                       : echoes.last_is_second[lane]  ? second[lane]
                                                      : last[lane];
      close_ranks(firing.strongest[i], firing.second[i], firing.last[i]);
    }
    if (!cast.truth.empty()) {
      cast.truth[bank][i] = beams.truth[lane];
    }
  }
}

}  // namespace rigwire::sim
