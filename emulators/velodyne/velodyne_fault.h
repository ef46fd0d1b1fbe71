// Defects of the sensor itself, of its window, of its time input and of the cable behind it; each
// one holds for a stretch of the run. What the air does to the beams is the weather's
// (sim/weather/weather.h).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class VelodyneFaultKind : std::uint8_t {
  lost_packets,        ///< Each packet of either port is lost with `probability`.
  swapped_packets,     ///< A data packet changes places with the next one with `probability`.
  duplicated_packets,  ///< Each packet of either port is sent twice with `probability`.
  dead_laser,          ///< Lasers `first_laser` .. `last_laser` see nothing.
  /// Dirt on the window between two azimuths: light passes it with `transmission`, out and back.
  dirty_window,
  motor_stall,    ///< The rotor runs down; the setting stands.
  pulse_loss,     ///< No pulse per second arrives; sentences do.
  pulse_noise,    ///< Pulses at wrong times between the right ones: the input reports an error.
  sentence_loss,  ///< No sentence arrives; pulses do.
  clock_offset,   ///< Timestamps are off by `seconds`.
  hour_overrun,   ///< The timestamp wraps `seconds` too late and so passes 3600 s.
  factory_bytes,  ///< The last two bytes of data packets are `return_mode_byte`, `product_id`.
};

struct VelodyneFault {
  VelodyneFaultKind kind = VelodyneFaultKind::lost_packets;
  Duration begin{0};              ///< Since the start of the run.
  Duration end{0};                ///< Later than begin; the fault holds in [begin, end).
  double probability = 0.0;       ///< (0, 1]
  int first_laser = 0;            ///< By the model's numbers, which count from 0.
  int last_laser = 0;             ///< Included.
  double sector_start_deg = 0.0;  ///< Azimuth, [0, 360), clockwise; the sector may contain 0.
  double sector_end_deg = 0.0;    ///< [0, 360], not the start.
  double transmission = 1.0;      ///< One way, [0, 1].
  double seconds = 0.0;  ///< clock_offset: -3600 .. 3600, not 0; hour_overrun: above 0 .. 1.
  std::uint8_t return_mode_byte = 0;
  std::uint8_t product_id = 0;

  [[nodiscard]] bool holds(SimTime instant) const {
    const Duration since_start = instant - kStart;
    return since_start >= begin && since_start < end;
  }
};

/// The word for it in messages and configurations, for example "lost_packets".
[[nodiscard]] std::string_view name(VelodyneFaultKind kind);

/// The first fault of a kind that holds at an instant; nullptr without one.
[[nodiscard]] const VelodyneFault* find_fault(std::span<const VelodyneFault> faults,
                                              VelodyneFaultKind kind, SimTime instant);

}  // namespace rigwire::emulators
