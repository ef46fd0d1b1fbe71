// A recorded run once more: its configuration on wires of its own, which nobody hears, with what
// its clients did and what governed it at their instants. It runs freely, so that it is the
// recorded run to the byte as far as that did not hang on the wall clock (docs/replay.md). `rigwire
// replay FOLDER --verify` compares it, `--dashboard` shows it (hil/control/shown_recording.h).
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/loopback_claims.h"
#include "hil/executive/free_pace.h"
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

  /// Before the rig is made.
  void join(Recorder& recorder);
  /// When it is, before the desk.
  void add_clients(Rig& rig);
  /// When the desk is. `refused` hears of what it does not do again.
  void govern(Desk& desk, const std::function<void(const std::string& what)>& refused) const;

  // Of who shows it.

  /// From where, and how.
  struct Course {
    SimTime from{};
    bool stands = false;  ///< There.
    double factor = 1.0;  ///< Else at this pace.
    /// Somebody looked on before, and is waited for a moment earlier, to see what leads there.
    bool looked_at = false;
  };
  /// Before the run, and of the one before nothing is left.
  void show(const Course& course);
  /// Whether time stands at first.
  [[nodiscard]] bool begins_standing() const { return course_.stands || course_.looked_at; }
  /// When the desk is, whose thread `io` is of: time goes where it is to begin, and at the recorded
  /// end it stands. `is_looked_at`: whether somebody looks on.
  void steer(Desk& desk, boost::asio::io_context& io, std::function<bool()> is_looked_at);
  [[nodiscard]] FreePace& pace() { return pace_; }
  /// Whether time stands where a seek ends: as `otherwise`, which it does now; of the first one as
  /// it is to be where the run is to begin.
  [[nodiscard]] bool stands_then(bool otherwise) {
    return std::exchange(is_coming_, false) ? course_.stands : otherwise;
  }
  /// To be shown anew when it has ended, from there; nothing: not.
  void show_again(SimTime from, bool stands, double factor);
  [[nodiscard]] const std::optional<Course>& again() const { return again_; }
  /// Where its page is, as ControlServer::address().
  void served_at(std::string address) { address_ = std::move(address); }
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  class NoCanEnd;

  /// Once those who look on are back, or long enough: from where time stands to where it is to be.
  void go_on_when_looked_at(Desk& desk, boost::asio::io_context& io,
                            std::chrono::steady_clock::time_point latest);

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
  Course course_;
  FreePace pace_;
  Executive* executive_ = nullptr;  ///< Of the run.
  std::function<bool()> is_looked_at_ = [] { return false; };
  bool is_coming_ = false;  ///< To where it is to begin.
  bool was_looked_at_ = false;
  std::optional<Course> again_;
  std::string address_;
};

}  // namespace rigwire::hil
