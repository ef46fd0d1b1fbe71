// What a spinning lidar measures: every laser of every firing is a ray of its own, cast at its own
// instant, rotor azimuth and sensor pose, into the scene as it is at that instant.
//
// Sensor frame S: x forward, y left, z up, origin on the spin axis. A laser with elevation w at
// rotor azimuth a (clockwise from forward, seen from above) starts at (0, 0, vertical offset) and
// points along (cos w cos a, -cos w sin a, sin w).
//
// Echo: a surface of diffuse reflectance rho met at incidence angle theta is seen up to
//   R_det = R_max sqrt(rho cos(theta) / 0.9),
// the range at which it returns as much light as a 90 % target does at R_max (Goodin et al.,
// "Predicting the influence of rain on lidar in ADAS", Electronics 8(1):89, 2019, without rain).
// The reported reflectivity is rho cos(theta): the sensor compensates range, not incidence. One
// echo per shot; beams have no width.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/link_motion.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

struct SpinningLidarParameters {
  double range_sigma_m = 0.02;     ///< Of the Gaussian range noise, independent per shot.
  double housing_radius_m = 0.10;  ///< Rays begin here. Hits nearer than the pattern's minimum
                                   ///< range block the ray and are reported as none.
  int threads = 1;                 ///< That cast, the caller's included. Does not change results.
};

/// Throws std::invalid_argument naming the member, the value found and what is allowed.
void validate(const SpinningLidarParameters& parameters);

/// The rays of one cast, kept for the benchmark: bare Embree on the very same rays.
class RecordedRays {
 public:
  RecordedRays();
  ~RecordedRays();
  RecordedRays(RecordedRays&&) noexcept;
  RecordedRays& operator=(RecordedRays&&) noexcept;

  [[nodiscard]] std::size_t size() const;
  /// Makes the rays as new. Must be called before every cast_bare().
  void reset();
  /// Nothing but the ray caster's own calls, on one thread, in the order and packets of the lidar.
  void cast_bare(const Scene& scene);
  /// Rays that hit something in the last cast_bare().
  [[nodiscard]] std::size_t hits() const;

 private:
  friend class SpinningLidar;
  struct Packets;
  std::unique_ptr<Packets> packets_;
};

class SpinningLidar {
 public:
  /// The pattern, the plan and the rate come from the device (LidarBackend). The rotor stands at
  /// azimuth 0 at the start of the run. Noise depends on (seed, name) and the firing's number only.
  /// Throws std::invalid_argument for bad parameters, a pattern without lasers or with more than
  /// kMaxLasers, or without firing period.
  SpinningLidar(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                const SamplePlan& plan, double rotor_rate_radps, std::uint64_t seed,
                std::string_view name);
  ~SpinningLidar();

  /// From `time` on the rotor turns at this rate; `time` must not decrease from call to call.
  void set_rotor_rate(SimTime time, double rate_radps);
  /// [0, 2 pi).
  [[nodiscard]] double rotor_azimuth_rad(SimTime time) const;

  /// All firings of the plan whose first laser is in (t0, t1], in order, replacing what `firings`
  /// held. The scene must be prepared for the slice [t0, t1]; the mounts are frame S at both ends.
  ///
  /// Lasers of the last firing that fire after t1 (HDL-32E: at most 0.036 ms) are cast from the
  /// sensor pose extrapolated at constant velocity, and see bodies where they are at t1.
  /// Interpolated pose within a firing: first order in time, error below 1e-9 m and 1e-8 rad for
  /// 10 m/s2 and 1 rad/s. Does not allocate once the slices have their usual length.
  void cast(const Scene& scene, SimTime t0, SimTime t1, const LinkMotion& mount_at_t0,
            const LinkMotion& mount_at_t1, std::vector<LidarFiring>& firings,
            std::uint32_t mask = Scene::kSeeEverything);

  /// The rays that cast() would send.
  [[nodiscard]] RecordedRays record(const Scene& scene, SimTime t0, SimTime t1,
                                    const LinkMotion& mount_at_t0, const LinkMotion& mount_at_t1);

  /// Rays cast so far.
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  struct Slice;
  void prepare(const Scene& scene, SimTime t0, SimTime t1, const LinkMotion& mount_at_t0,
               const LinkMotion& mount_at_t1, std::vector<LidarFiring>& firings);
  void cast_block(const Scene& scene, std::size_t block, std::vector<LidarFiring>& firings,
                  std::uint32_t mask) const;

  SpinningLidarParameters parameters_;
  LidarPattern pattern_;
  SamplePlan plan_;
  double rotor_rate_radps_;
  double azimuth_at_change_rad_ = 0.0;
  SimTime rate_changed_ = kStart;
  std::uint64_t noise_key_;
  std::uint64_t rays_ = 0;
  std::unique_ptr<Slice> slice_;
};

}  // namespace rigwire::sim
