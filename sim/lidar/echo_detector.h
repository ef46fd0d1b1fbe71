// Finds the echoes in the returns of the parts of a beam.
//
// Each part is a pulse of the full length. Overlapping pulses cannot be separated: parts nearer to
// each other than half a pulse's length in space (c tau / 2) make one echo, at the mean of their
// ranges weighted by their energies. That mean may lie where nothing is: a mixed pixel. Farther
// apart they are separate echoes, and the receiver reports those beyond its threshold and its
// minimum separation.
//
// A slanting surface returns one long pulse, although the few parts that represent it may be
// farther apart than a pulse: each part therefore fills its patch of the surface, and patches that
// touch belong together. HELIOS++ (Winiwarter et al., Remote Sensing of Environment 269, 2022) and
// RGL put returns into bins of a waveform instead; whether two parts merge there depends on where
// the bin's edge falls.
#pragma once

#include <cstddef>
#include <span>

namespace rigwire::sim {

/// One part of a beam and what it returned; or an echo made of some.
struct EchoPart {
  float range_m = 0.0F;
  float energy = 0.0F;      ///< > 0
  float brightness = 0.0F;  ///< Energy times range squared.
  float patch_m = 0.0F;     ///< Half the depth of the surface that it represents.
};

struct EchoRules {
  float pulse_m = 0.75F;      ///< Half the pulse's length in space.
  float separation_m = 1.0F;  ///< The weaker of two echoes nearer to each other is lost.
  float threshold = 0.0F;     ///< Minimum energy of a detected echo.
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
