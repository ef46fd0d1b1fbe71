// Echoes of beams that have a width, in any weather: each beam is a few sub-rays (beam_sampler.h).
// Eight neighbouring firings of a laser are cast together; their rays go beam by beam into Embree's
// packets. (The same sub-ray of all eight in one packet is 10 to 20 % slower among leaves, and 6 %
// faster among crates.)
//
// Every sub-ray is cast, whatever the middle of the beam hits (MAVS omits the others when the
// middle one hits nothing, and so loses twigs against the sky). link_budget.h sums up their
// returns, echo_detector.h separates echoes and echo_model.h reports them. Sub-rays of a beam leave
// from one point and at one instant.
//
// Blooming: six more rays around the beam carry scattered light; of the surfaces that they hit only
// retro-reflectors are bright enough to count.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/lidar/beam_lanes.h"
#include "sim/lidar/echo_detector.h"
#include "sim/lidar/echo_model.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar_parameters.h"

namespace rigwire::sim {

class BeamCaster {
 public:
  /// Throws std::invalid_argument for bad parameters or a bad beam. Random numbers depend on (seed,
  /// name) only. sub_rays 0 counts as 1.
  BeamCaster(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
             std::uint64_t seed, std::string_view name);

  /// Casts all beams of the block and writes the strongest echo of each; if echoes are to be
  /// separated, also the last and the second strongest one; and, if requested, the truth along the
  /// middle of the beam. May run on many threads, for different blocks. Does not allocate; uses 150
  /// kB of stack.
  void cast(const BlockCast& cast) const;

  /// Rays per beam, those of scattered light included.
  [[nodiscard]] std::size_t rays_per_beam() const { return aims_.size(); }
  [[nodiscard]] const EchoModel& echo_model() const { return model_; }

 private:
  /// The beams of one packet.
  struct Beams;
  /// Their echoes.
  struct Echoes;

  [[nodiscard]] std::span<SubRayHits> hits_of(Beams& beams) const;
  void trace(const BlockCast& cast, const RingPacket& plan, Beams& beams) const;
  void meet_air(const BlockCast& cast, Beams& beams) const;
  void detect(Beams& beams, Echoes& echoes) const;
  void report(const BlockCast& cast, const RingPacket& plan, const Beams& beams,
              const Echoes& echoes) const;

  EchoModel model_;
  EchoRules rules_;
  std::vector<SubRayAim> aims_;  ///< Those of the beam, then scattered light.
  std::vector<float> weights_;   ///< Weights of the beam's own rays.
  std::vector<RayChoice> whole_group_;
  std::vector<RayChoice> last_group_;
  bool compensates_incidence_;
  double divergence_rad_;  ///< Divergence of a round beam of equal cross section.
  std::uint64_t air_key_;
};

}  // namespace rigwire::sim
