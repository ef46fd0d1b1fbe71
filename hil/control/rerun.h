// A recorded run once more: its configuration on wires of its own, which nobody hears, with what
// its clients did and what governed it at their instants. It runs freely, so that it is the
// recorded run to the byte as far as that did not hang on the wall clock (docs/replay.md). `rigwire
// replay FOLDER --verify` compares it, `--dashboard` shows it (hil/control/showing.h).
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/loopback_claims.h"
#include "hil/files/private_folder.h"
#include "hil/record/recorded_clients.h"
#include "hil/record/recording.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

class Desk;
class Recorder;

class Rerun {
 public:
  /// Reads all of the recording. Throws std::invalid_argument for a folder that is none, and what
  /// its rig is refused by; drivers::EndpointError where there is no room for wires.
  explicit Rerun(const std::filesystem::path& recording);
  ~Rerun();
  Rerun(const Rerun&) = delete;
  Rerun& operator=(const Rerun&) = delete;

  /// What is not as in the recorded run, and what is not done again.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }
  [[nodiscard]] const RecordingContents& contents() const { return contents_; }
  [[nodiscard]] const RigConfiguration& recorded() const { return recorded_; }
  /// With wires of its own.
  [[nodiscard]] const RigConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] const OwnEnds& own_ends() const { return own_ends_; }
  [[nodiscard]] std::size_t client_acts() const { return clients_.size(); }
  /// For what is needed on the way; removed with it.
  [[nodiscard]] const std::filesystem::path& folder() const { return own_.path(); }
  /// Up to where the recording tells anything: reads all of it.
  [[nodiscard]] SimTime last_instant() const;
  /// Of the recorded run; of one that was killed the last instant.
  [[nodiscard]] SimTime end() const { return end_; }
  /// What happened in it: messages of TruthTrack::events.
  [[nodiscard]] const std::vector<RecordedAct>& events() const { return events_; }

  // One run, in this order, and when it is over the next one. What is given must outlive it.

  /// Nothing is left of the run before.
  void begin_again() { clients_.begin_again(); }
  /// Before the rig is made.
  void join(Recorder& recorder);
  /// When it is, before the desk: what they did, and when the truth followed.
  void add_clients(Rig& rig);
  /// When the desk is. `refused` hears of what it does not do again.
  void govern(Desk& desk, const std::function<void(const std::string& what)>& refused) const;

 private:
  class NoCanEnd;

  std::filesystem::path recording_;
  RecordingContents contents_;
  RigConfiguration recorded_;
  RecordedClients clients_;
  SimTime end_{};
  std::vector<RecordedAct> events_;
  std::vector<std::string> remarks_;
  PrivateFolder own_;
  drivers::LoopbackClaims claims_;
  RigConfiguration configuration_;
  std::map<std::string, std::unique_ptr<NoCanEnd>> can_ends_;
  OwnEnds own_ends_;
};

}  // namespace rigwire::hil
