// Connects a run's page and other viewers with the run: joins the stream (hil/stream/) with the
// desk. Every command of the desk is a service of the stream, what `set` can set are its
// parameters, the answer to `read` is a channel, and the viewers' transport bar pauses and sets the
// pace.
//
// Runs on the thread of the desk; viewers are on another one (hil/stream/run_stream.h), where what
// they send is parsed before it is handed over.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hil/control/commands.h"
#include "hil/control/desk.h"
#include "hil/control/page_files.h"
#include "hil/executive/crossing.h"
#include "hil/executive/executive.h"
#include "hil/rig/rig.h"
#include "hil/stream/run_stream.h"

namespace rigwire::hil {

/// Returns what a run's stream begins with.
[[nodiscard]] StreamedRun streamed_run(const RigConfiguration& configuration,
                                       const std::string& session);

/// The part of a viewer's `setParameters` that concerns one target.
struct ParameterRequest {
  std::string on;
  ParsedRequest parsed;
};

class Dashboard {
 public:
  /// From now on the stream receives the rig's world; to be called before the run. Everything must
  /// outlive it. `duration`: of the run; empty: it has no end, and the viewers have no transport
  /// bar.
  Dashboard(boost::asio::io_context& io, RunStream& stream, Rig& rig,
            const RigConfiguration& configuration, std::optional<Duration> duration);
  ~Dashboard();
  Dashboard(const Dashboard&) = delete;
  Dashboard& operator=(const Dashboard&) = delete;

  /// Connects the desk; to be called before the first viewer.
  void serve(Desk& desk);
  [[nodiscard]] const PageFiles& files() const { return files_; }
  [[nodiscard]] Viewers& viewers() { return stream_.viewers(); }

 private:
  void tick();
  void offer_commands();
  /// Passes `refused` and further refusals to `done`.
  void set_parameters(std::vector<ParameterRequest> requests, std::vector<std::string> refused,
                      const StreamParameters::Done& done);
  [[nodiscard]] std::string control_playback(const protocols::foxglove::PlaybackControl& control);
  /// Seeks to that instant, with a clock that steps or in a replay; returns the reason when it does
  /// not.
  [[nodiscard]] std::string seek(std::uint64_t unix_ns, const std::string& request);
  void tell_playback(std::string_view request, bool did_seek = false);

  Crossing viewers_thread_;
  Crossing desk_thread_;  ///< Used by the viewers' thread to call the desk.
  boost::asio::steady_timer timer_;
  RunStream& stream_;
  Executive& executive_;
  Desk* desk_ = nullptr;
  PageFiles files_;
  std::optional<Duration> duration_;
  Viewers::ChannelId status_ = 0;
  unsigned ticks_ = 0;
  float speed_ = 1.0F;
  bool told_paused_ = false;
};

}  // namespace rigwire::hil
