// Playback of a recording for viewers: where it starts, at which pace, and seeking. A run cannot go
// back: for a seek backward the run ends, and the next one runs to the new instant.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "hil/control/rerun.h"
#include "hil/executive/executive.h"
#include "hil/executive/free_pace.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

class Desk;

class Showing {
 public:
  /// `rerun` must outlive it.
  explicit Showing(Rerun& rerun) : rerun_(rerun), pace_(course_.factor) {}

  [[nodiscard]] Rerun& rerun() { return rerun_; }
  [[nodiscard]] const Rerun& rerun() const { return rerun_; }
  /// Returns the recorded end: time goes no further.
  [[nodiscard]] SimTime end() const { return rerun_.end(); }

  /// Where playback starts, and how.
  struct Course {
    SimTime from{};
    bool stands = false;  ///< Pauses at `from`.
    double factor = 1.0;  ///< Pace, unless paused.
    /// A viewer was connected before: playback waits for it a moment earlier, so that it sees what
    /// leads there.
    bool looked_at = false;
  };
  /// To be called before the run.
  void begin(const Course& course);
  /// Returns whether time is paused at first.
  [[nodiscard]] bool begins_standing() const { return course_.stands || course_.looked_at; }
  /// To be called once the desk exists, with its thread's `io`: moves time to where playback
  /// starts, and pauses it at the recorded end. `is_looked_at`: whether a viewer is connected.
  void steer(Desk& desk, Executive& executive, boost::asio::io_context& io,
             std::function<bool()> is_looked_at);
  [[nodiscard]] FreePace& pace() { return pace_; }
  /// Returns whether time pauses where a seek ends: as `otherwise`, the present state; for the
  /// first seek, as the course says.
  [[nodiscard]] bool stands_then(bool otherwise) {
    return std::exchange(is_coming_, false) ? course_.stands : otherwise;
  }
  /// Shows it again from `from` when this run has ended.
  void show_again(SimTime from, bool stands, double factor);
  [[nodiscard]] const std::optional<Course>& again() const { return again_; }
  /// Sets the address of its page, as ControlServer::address().
  void served_at(std::string address) { address_ = std::move(address); }
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  /// Waits until the viewers are back, or until `latest`; then moves time to where playback starts.
  void go_on_when_looked_at(Desk& desk, Executive& executive, boost::asio::io_context& io,
                            std::chrono::steady_clock::time_point latest);

  Rerun& rerun_;
  Course course_;
  FreePace pace_;
  std::function<bool()> is_looked_at_ = [] { return false; };
  bool is_coming_ = false;  ///< On the way to where playback starts.
  bool was_looked_at_ = false;
  std::optional<Course> again_;
  std::string address_;
};

}  // namespace rigwire::hil
