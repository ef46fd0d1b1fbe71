// Echoes out of what the parts of a beam return.
//
// Each part is a pulse of the full length. Pulses that overlap cannot be told apart: parts nearer
// to each other than half a pulse's length in space (c tau / 2) make one echo, at the mean of their
// ranges weighted by their energies. That mean may lie where nothing is: a mixed pixel. Farther
// apart they are echoes of their own, of which a receiver tells those that its threshold and its
// minimum separation let it tell.
//
// A surface that slants away returns one long pulse, although the few parts that stand for it may
// be farther apart than a pulse: each part therefore fills its patch of the surface, and patches
// that meet belong together. HELIOS++ (Winiwarter et al., Remote Sensing of Environment 269, 2022)
// and RGL put returns into bins of a waveform instead; two parts there merge or not by where the
// bin's edge falls.
#pragma once

#include <cstddef>
#include <span>

namespace rigwire::sim {

/// One part of a beam and what it returned; or an echo made of some.
struct EchoPart {
  float range_m = 0.0F;
  float energy = 0.0F;      ///< > 0
  float brightness = 0.0F;  ///< Energy times range squared.
  float patch_m = 0.0F;     ///< Half the depth of the surface that it stands for.
};

struct EchoRules {
  float pulse_m = 0.75F;      ///< Half the pulse's length in space.
  float separation_m = 1.0F;  ///< The weaker of two echoes nearer to each other is lost.
  float threshold = 0.0F;     ///< Least energy of an echo that is seen.
};

/// What a receiver reports of one shot. An echo with energy 0 is none.
struct DetectedEchoes {
  std::size_t count = 0;  ///< Number of separate echoes.
  EchoPart strongest;
  EchoPart second;  ///< The second strongest.
  EchoPart last;    ///< The farthest: one of these, or a third one.
  bool last_is_strongest = true;
  bool last_is_second = false;
};

/// Uses `parts` as its working space and does not allocate. Of equally strong echoes the nearer one
/// is taken for the stronger.
[[nodiscard]] DetectedEchoes detect_echoes(std::span<EchoPart> parts, const EchoRules& rules);

}  // namespace rigwire::sim
