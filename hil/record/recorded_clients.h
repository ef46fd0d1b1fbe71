// What the clients of a recorded run did, done again at the same instants: bytes and datagrams,
// connections, frames offered to a bus, and how they had set their end of a wire.
//
// Last among the sources of its executive: at an instant everything of the rig's own goes first, as
// when a client's bytes arrive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/executive/event_source.h"
#include "hil/record/recording.h"
#include "hil/wires/wire_tap.h"

namespace rigwire::hil {

class QueuedOutlet;

class RecordedClients final : public EventSource {
 public:
  /// Reads all of it. Throws as read_recording().
  explicit RecordedClients(const std::filesystem::path& folder);

  /// The outlets of a wire, which must outlive it (Recorder::on_outlet).
  void join(const std::string& wire, QueuedOutlet& outlet) { outlets_[wire].push_back(&outlet); }
  /// For another run: from the start, without outlets.
  void begin_again();

  /// How much there is to do.
  [[nodiscard]] std::size_t size() const { return steps_.size(); }
  /// What cannot be done again, a line each.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  [[nodiscard]] SimTime next_event() const override {
    return giving_ || next_ == steps_.size() ? kNever : steps_[next_].at;
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime now) override;

 private:
  struct Step {
    SimTime at{};
    std::size_t wire = 0;
    WirePiece piece;  ///< Its bytes are those below.
    std::vector<std::uint8_t> bytes;
  };
  class Connections;

  void give(const Step& step);

  std::vector<std::string> wires_;
  std::vector<Step> steps_;
  std::vector<std::string> remarks_;
  std::map<std::string, std::vector<QueuedOutlet*>> outlets_;
  std::size_t next_ = 0;
  bool giving_ = false;  ///< What it gives may ask for its next event.
};

}  // namespace rigwire::hil
