// Detection of false and of disturbed signals by an emulated u-blox receiver, from what it receives
// alone: NAV-STATUS spoofDetState, SEC-SIG, SEC-SIGLOG.
//
// False signals of one transmitter are as strong as each other, wherever their satellites seem to
// be; real ones differ by elevation, antenna and surroundings. So the change from one to the other,
// either way, is abrupt: of six satellites or more that are received at two epochs in a row, the
// strengths come together and rise, or fall and go apart. Only the change is seen, as u-blox says
// of its own ("detection is not possible if the receiver is started under spoofing conditions"): a
// receiver that begins under false signals reports none. It counts for one epoch in NAV-STATUS and
// for ten seconds in SEC-SIG (the real "cool off period" is not documented), in which the log's
// event times out. The thresholds are chosen: fading of an open sky or a drive through a wood does
// not reach them.
//
// Jamming is the rise of the noise floor in each band.
//
// Sources: ZED-F9P integration manual UBX-18010802, section 3.14; interface description HPG 1.50,
// UBXDOC-963802114-12815, sections 3.15.20 "UBX-NAV-STATUS", 3.18.2 and 3.18.3.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class UbloxSignalSecurity {
 public:
  static constexpr std::size_t kMostEvents = 16;

  enum class Detection : std::uint8_t { abrupt_change = 3, jamming = 4 };  // SEC-SIGLOG's numbers
  enum class EventKind : std::uint8_t { started, stopped, triggered, timed_out };
  struct Event {
    SimTime at{};
    Detection detection = Detection::abrupt_change;
    EventKind kind = EventKind::started;
  };

  /// Power-on or reset: the log is empty.
  void restart();
  /// Evaluates one epoch. `satellites`: those that the receiver knows of. `sensitive`:
  /// CFG-SEC-JAMDET_SENSITIVITY_HI.
  void look(SimTime now, const std::vector<SatelliteView>& satellites, const RadioState& radio,
            bool has_fix, bool sensitive);

  /// Returns the spoofing state of this epoch, coded as in NAV-STATUS: 0 unknown, 1 none, 2
  /// indicated, 3 indicated by several systems.
  [[nodiscard]] std::uint8_t spoofing_now() const { return spoofing_now_; }
  /// Returns the spoofing state, coded as in SEC-SIG: 0 unknown, 1 none, 2 indicated.
  [[nodiscard]] std::uint8_t spoofing() const;
  [[nodiscard]] std::uint8_t jamming() const { return jamming_; }
  [[nodiscard]] bool jammed(bool second_band) const {
    return second_band ? second_jammed_ : first_jammed_;
  }
  /// Oldest first.
  [[nodiscard]] const std::deque<Event>& log() const { return log_; }
  /// Returns the time of the last epoch.
  [[nodiscard]] SimTime time() const { return now_; }

 private:
  void note(Detection detection, EventKind kind);

  SimTime now_ = kNever;
  bool has_fix_ = false;
  std::vector<SatelliteView> before_;  ///< Tracked at the epoch before.
  std::vector<double> strengths_before_;
  std::vector<double> strengths_;
  std::uint8_t spoofing_now_ = 0;
  std::uint8_t jamming_ = 0;
  bool first_jammed_ = false;
  bool second_jammed_ = false;
  SimTime indicated_until_ = kNever;  ///< While an indication lasts.
  std::deque<Event> log_;
};

}  // namespace rigwire::emulators
