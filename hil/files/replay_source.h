// A piece of a file that is played on a wire (hil/files/replay_reader.h): units with the instants
// at which they are due again.
//
// Instants are absolute, from the zero of the file, and are computed for each unit from its own:
// nothing accumulates. due = (instant - zero - start) / speed + offset, to the nanosecond; with
// `loop` the piece comes again after its length. A unit whose instant is before that of the unit in
// front goes together with that one, and is counted; more than a second back is refused.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/files/replay_reader.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// What the whole piece is.
struct ReplayedSummary {
  ReplayedKind kind = ReplayedKind::bytes;
  std::uint64_t units = 0;
  std::uint64_t bytes = 0;
  std::uint64_t went_back = 0;  ///< Instants before that of the unit in front.
  Duration length{0};           ///< From its first unit to its last.
  /// Destination ports of datagrams, in the order of their first one.
  std::vector<std::uint16_t> to_ports;
  bool truncated = false;                      ///< The file ends in the middle of a unit.
  std::map<std::string, std::uint64_t> notes;  ///< Notes of the reader (ReplayReader::notes()).
};

/// "2 error frames, 1 CAN FD frame", as people read it; empty without notes.
[[nodiscard]] std::string text_of_notes(const std::map<std::string, std::uint64_t>& notes);

class ReplaySource {
 public:
  /// Reads the file once to its end. Throws drivers::EndpointError where it cannot be read,
  /// std::invalid_argument naming what is wrong with it: nothing of a kind that can be played, a
  /// wire that it does not have or has twice, units of two kinds, instants that go back.
  /// `zero_ns`: the instant of the file's own count that is its zero, in place of the settings'.
  explicit ReplaySource(const ReplaySourceSettings& settings,
                        std::optional<std::int64_t> zero_ns = std::nullopt);
  ~ReplaySource();
  ReplaySource(const ReplaySource&) = delete;
  ReplaySource& operator=(const ReplaySource&) = delete;

  [[nodiscard]] const ReplayedSummary& summary() const { return summary_; }
  /// The next unit, null at the end. Valid until the next call. Does not throw: a file that was
  /// changed meanwhile ends where it is no longer whole.
  [[nodiscard]] const ReplayedUnit* next();

 private:
  /// The next of the piece with its instant from the piece's start, cuts taken out; false at its
  /// end.
  bool next_of_piece(Duration& at);
  void rewind();

  ReplaySourceSettings settings_;
  std::optional<std::int64_t> given_zero_ns_;
  ReplayedSummary summary_;
  std::unique_ptr<ReplayReader> reader_;
  ReplayedUnit unit_;
  std::int64_t zero_ns_ = 0;  ///< In the file's own count.
  std::int64_t last_ns_ = 0;
  std::int64_t cut_ns_ = 0;  ///< Taken out so far.
  bool first_ = true;
  std::int64_t rounds_ = 0;
  Duration round_{0};  ///< Length of one round of the loop.
  SimTime last_due_{};
};

}  // namespace rigwire::hil
