// A rerun in front of who looks on: from where it is shown, at which pace, and where it is sent
// back to. A run cannot go back, so that it ends, and the next one goes as far as it was sent.
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

  /// From where, and how.
  struct Course {
    SimTime from{};
    bool stands = false;  ///< There.
    double factor = 1.0;  ///< Else at this pace.
    /// Somebody looked on before, and is waited for a moment earlier, to see what leads there.
    bool looked_at = false;
  };
  /// Before the run.
  void begin(const Course& course);
  /// Whether time stands at first.
  [[nodiscard]] bool begins_standing() const { return course_.stands || course_.looked_at; }
  /// When the desk is, whose thread `io` is of: time goes where it is to begin, and at the recorded
  /// end it stands. `is_looked_at`: whether somebody looks on.
  void steer(Desk& desk, Executive& executive, boost::asio::io_context& io,
             std::function<bool()> is_looked_at);
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
  /// Once those who look on are back, or long enough: from where time stands to where it is to be.
  void go_on_when_looked_at(Desk& desk, Executive& executive, boost::asio::io_context& io,
                            std::chrono::steady_clock::time_point latest);

  Rerun& rerun_;
  Course course_;
  FreePace pace_;
  std::function<bool()> is_looked_at_ = [] { return false; };
  bool is_coming_ = false;  ///< To where it is to begin.
  bool was_looked_at_ = false;
  std::optional<Course> again_;
  std::string address_;
};

}  // namespace rigwire::hil
