// What a spinning lidar measures: every laser of every firing is a ray of its own, cast at its own
// instant, rotor azimuth and sensor pose, into the scene as it is at that instant.
//
// Frames, offsets and directions of the lasers: sim/samples/lidar_sample.h. Heads have up to 128
// lasers in banks of 32. What comes back from a ray: clear_echo.h.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/lidar/rotor.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

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

class SpinningLidar final : public LidarSensor {
 public:
  /// The pattern, the plan and the command come from the device (LidarBackend). Noise depends on
  /// (seed, name) and the firing's number only. Throws std::invalid_argument for bad parameters, a
  /// pattern without lasers or with more than kMaxLasers, or without firing period.
  SpinningLidar(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                const SamplePlan& plan, const LidarCommand& command, std::uint64_t seed,
                std::string_view name, const RotorParameters& rotor = {});
  ~SpinningLidar() override;

  void command(SimTime time, const LidarCommand& command) override;

  /// Lasers of the last firing that fire after t1 (HDL-32E: at most 0.036 ms) are cast from the
  /// sensor pose extrapolated at constant velocity, and see bodies where they are at t1.
  /// Poses between: firing_block.h. A firing is in view or not as a whole, by the rotor's azimuth
  /// at its first laser. Does not allocate once the slices have their usual length.
  void cast(const Scene& scene, const LidarSlice& slice, const Weather* weather,
            std::vector<LidarFiring>& firings, std::vector<LidarBankTruth>* truth) override;

  /// The rays that cast() would send.
  [[nodiscard]] RecordedRays record(const Scene& scene, const LidarSlice& slice);

  [[nodiscard]] std::uint64_t rays() const override { return rays_; }

 private:
  struct Slice;
  /// Firings and blocks of the slice. `rotor` is at an instant not after its start.
  void prepare(const Scene& scene, const LidarSlice& slice, Rotor& rotor,
               std::vector<LidarFiring>& firings) const;
  /// Whether the lasers fire with the rotor there.
  [[nodiscard]] bool fires_at(double azimuth_rad) const;

  SpinningLidarParameters parameters_;
  LidarPattern pattern_;
  SamplePlan plan_;
  LidarCommand command_;
  double view_width_rad_ = 0.0;  ///< 0: all round.
  Rotor rotor_;
  std::uint64_t rays_ = 0;
  std::unique_ptr<Slice> slice_;
};

}  // namespace rigwire::sim
