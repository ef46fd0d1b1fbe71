// The sensor's input for a receiver's pulse per second and sentences: what arrives when, what state
// the input is in, and when it sets the sensor's clock.
//
//   pulse                    ┌──┐                              ┌──┐
//                       ─────┘  └──────────────────────────────┘  └──
//   sentence                       ░░░░$GPRMC of that pulse░░░░
//                                 ↑ sentence_delay after the pulse's end, 75 ms at 9600 baud
//
// The input synchronises from the first pulse on and is locked once good pulses have come for the
// qualifier's delay. Locked, each pulse sets the counter: wholly when a sentence that counts has
// come for the pulse before, otherwise to the nearest second. Without a pulse for 1.5 s the input
// is absent and the counter runs on by itself.
//
// Sources: HDL-32E user's manual 63-9113 Rev. E and H, "GPS and PPS" (20 to 200 ms of pulse, 50 to
// 500 ms of pause, 9600 baud); VLP-16 user's manual 63-9243 Rev. D, pulse and receiver qualifiers.
// The 1.5 s, and what counts as an error, are this project's choice: the manuals only name the
// states.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "emulators/velodyne/sensor_clock.h"
#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/gprmc.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

class TimeInput {
 public:
  /// Keeps references; all must outlive it. The settings are valid.
  TimeInput(const VelodyneSettings& settings, const VelodyneFaults& faults,
            const Calendar& calendar);

  /// Forgets everything; sets the clock: to zero, or to true time with an ideal source.
  void power_up(SimTime now, SensorClock& clock);
  /// What the receiver measured; the next sentence says it.
  void observe(const GnssSample& sample);

  /// The next pulse or end of a sentence.
  [[nodiscard]] SimTime next_event() const;
  /// The next whole second of true time, with or without a pulse.
  [[nodiscard]] SimTime next_second() const { return next_second_; }
  /// Does what is due at next_event(). Precondition: it is due.
  void handle_event(SensorClock& clock);

  [[nodiscard]] protocols::velodyne::PulseState state(SimTime now) const;
  /// The last sentence, with CR LF; empty before the first one.
  [[nodiscard]] std::string_view sentence();
  /// What it says; nothing before the first one.
  [[nodiscard]] const std::optional<protocols::velodyne::RecommendedMinimum>& said() const {
    return said_;
  }
  /// The last one came within 2.5 s.
  [[nodiscard]] bool sentences_arrive(SimTime now) const;
  /// The last pulse that was received; nothing while the input is absent.
  [[nodiscard]] std::optional<SimTime> last_pulse(SimTime now) const;
  /// "49 30.0000N 007 45.0000E" in the form of the sentence; empty without a fix.
  [[nodiscard]] std::string position() const;

 private:
  struct Fix {
    bool valid = false;
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double speed_mps = 0.0;
    double course_deg = 0.0;
  };

  [[nodiscard]] bool receiver_speaks(SimTime now) const;
  [[nodiscard]] bool pulse_arrives(SimTime now) const;
  [[nodiscard]] bool sentence_arrives(SimTime now) const;
  void handle_pulse(SimTime pulse, SensorClock& clock);
  void write_sentence(SimTime of_pulse);

  const VelodyneSettings& settings_;
  const VelodyneFaults& faults_;
  const Calendar& calendar_;
  Duration sentence_complete_after_;
  SimTime next_second_{};
  SimTime next_sentence_ = kNever;

  protocols::velodyne::PulseState state_ = protocols::velodyne::PulseState::absent;
  SimTime last_pulse_{};
  SimTime good_since_{};
  /// The pulse whose sentence, of the kind that sets the time, came last.
  SimTime timed_pulse_ = kNever;

  Fix fix_;
  std::optional<SimTime> heard_;
  Duration heard_period_{0};
  std::optional<protocols::velodyne::RecommendedMinimum> said_;
  std::optional<protocols::velodyne::GprmcText> text_;  ///< Text of `said_`, made on request.
  SimTime sentence_at_{};
};

}  // namespace rigwire::emulators
