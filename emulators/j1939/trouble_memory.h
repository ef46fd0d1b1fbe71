// The trouble codes of a J1939 node: which are active, which were, how often each one came; and the
// diagnostic messages that report them.
//
// Source: SAE J1939-73, 5.7.1: DM1 goes out every second, and at once on a change, with at least a
// second between two changes reported at once. Clearing (DM3, DM11) does not mend anything: what is
// wrong stays active and counts its occurrences anew from 1.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/j1939/j1939_node.h"
#include "protocols/can/message.h"
#include "protocols/vehicle/diagnostics.h"
#include "protocols/vehicle/message.h"

namespace rigwire::emulators {

class TroubleMemory {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{10};
  static constexpr std::uint64_t kPeriodTicks = 100;
  static constexpr std::uint64_t kPhaseTicks = 50;
  /// Rate of DM1 while nothing changes.
  static constexpr double kRate_hz = 1.0 / to_seconds(kPeriodTicks * kTick);

  /// A kind of trouble.
  struct Kind {
    std::uint32_t spn;
    protocols::vehicle::FailureMode mode;
  };
  /// In the order of their kinds; of more than a report holds the first.
  struct Codes {
    std::array<protocols::vehicle::TroubleCode, protocols::vehicle::kGreatestCodes> codes{};
    std::size_t count = 0;

    friend bool operator==(const Codes&, const Codes&) = default;
  };

  /// Below, kinds are known by their place.
  explicit TroubleMemory(std::span<const Kind> kinds);

  /// Sets whether a kind is active. Each change to active counts as an occurrence.
  void set(std::size_t kind, bool active);
  [[nodiscard]] bool is_active(std::size_t kind) const { return entries_[kind].active; }

  [[nodiscard]] Codes active() const { return select(true); }
  /// Returns the trouble codes that were active and no longer are.
  [[nodiscard]] Codes previous() const { return select(false); }
  /// Restores the state at power-up: active codes become previously active ones.
  void restart();
  void clear_active();
  void clear_previous();

  /// Sends DM1 if it is due in tick `tick` of kTick, or was and could not be sent. Call once for
  /// every tick in which the node may send. The amber lamp is on while anything is active; `stop`
  /// lights the red one.
  void send_due(J1939Node& node, SimTime now, std::uint64_t tick, bool stop = false);
  /// Answers a request for DM1 or DM2, obeys one for DM3 or DM11; nothing where `pgn` is none of
  /// these. A request to everybody clears without a word.
  [[nodiscard]] std::optional<J1939Answer> answer(J1939Node& node, SimTime now, std::uint32_t pgn,
                                                  std::uint8_t destination, bool stop = false);
  /// What it sends by itself and on request.
  static void append_layouts(std::vector<protocols::can::OwnedMessage>& list,
                             const protocols::vehicle::LayoutEnds& sent);

 private:
  struct Entry {
    Kind kind;
    bool active = false;
    std::uint8_t occurrences = 0;
  };
  [[nodiscard]] Codes select(bool active) const;
  [[nodiscard]] bool is_due(std::uint64_t tick);
  [[nodiscard]] protocols::vehicle::TroubleReport report(const Codes& codes, bool stop) const;

  std::vector<Entry> entries_;
  Codes reported_;
  std::optional<std::uint64_t> last_change_;
  bool postponed_ = false;
};

}  // namespace rigwire::emulators
