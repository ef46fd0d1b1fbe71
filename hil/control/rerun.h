// Runs a recorded run again: its configuration on private wires that no program receives, with the
// recorded actions of its clients and the recorded commands at their instants. It runs freely, and
// repeats the recorded run to the byte as far as that did not depend on the wall clock
// (docs/replay.md). `rigwire replay FOLDER --verify` compares it, `--dashboard` shows it
// (hil/control/showing.h).
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
  /// Reads all of the recording. Throws std::invalid_argument for a folder that is no recording and
  /// for what is wrong with its rig; drivers::EndpointError when private wires cannot be made.
  explicit Rerun(const std::filesystem::path& recording);
  ~Rerun();
  Rerun(const Rerun&) = delete;
  Rerun& operator=(const Rerun&) = delete;

  /// Returns what differs from the recorded run, and what is not repeated.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }
  [[nodiscard]] const RecordingContents& contents() const { return contents_; }
  [[nodiscard]] const RigConfiguration& recorded() const { return recorded_; }
  /// Returns the configuration with wires of its own.
  [[nodiscard]] const RigConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] const OwnEnds& own_ends() const { return own_ends_; }
  [[nodiscard]] std::size_t client_acts() const { return clients_.size(); }
  /// Returns a folder for temporary files, which is removed with this object.
  [[nodiscard]] const std::filesystem::path& folder() const { return own_.path(); }
  /// Returns the last instant of anything in the recording, all of which it reads.
  [[nodiscard]] SimTime last_instant() const;
  /// Returns the end of the recorded run; for a run that was killed, its last instant.
  [[nodiscard]] SimTime end() const { return end_; }
  /// Returns the events of the recorded run: messages of TruthTrack::events.
  [[nodiscard]] const std::vector<RecordedAct>& events() const { return events_; }

  // For each run, to be called in this order. The arguments must outlive the run.

  /// Resets the state of the previous run.
  void begin_again() { clients_.begin_again(); }
  /// Connects the recorded clients to the outlets of the rig; to be called before the rig is made.
  void join(Recorder& recorder);
  /// Adds the recorded actions of the clients and the instants at which the truth followed them; to
  /// be called after the rig is made, before the desk is.
  void add_clients(Rig& rig);
  /// Executes the recorded commands; to be called after the desk is made. `refused` is called for
  /// each command that it does not repeat.
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
