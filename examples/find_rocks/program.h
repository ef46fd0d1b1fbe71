// The program between the camera's wire and the rocks: opens the camera, evaluates the newest
// picture whenever it is done with the last one, and reports what it finds.
//
//   waiting --a picture--> looking     waiting, looking --no picture for --patience--> ended (4)
//   any --interrupt, time over--> ended (0)
//
// While the camera is choosing its exposure, as after it was switched on, its pictures are too
// bright or too dark to be matched in, and are passed over as well.
//
// Pictures are evaluated in a thread of their own, so that meanwhile packets are taken and the
// camera's heartbeat is kept. Of pictures that come while one is evaluated, only the newest is
// used.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "field/gige_wire.h"
#include "field/json_line.h"
#include "find_rocks/options.h"
#include "find_rocks/rock_finder.h"
#include "find_rocks/rock_tracker.h"

namespace rigwire::find_rocks {

/// What the program asks of any stereo camera.
[[nodiscard]] field::GigeClientSettings camera_settings(std::uint32_t packet_size);

class Program {
 public:
  /// Opens the sockets. Throws drivers::EndpointError or std::runtime_error.
  Program(boost::asio::io_context& context, const Options& options);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Returns the exit status.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  /// A picture as it came, kept.
  struct Taken {
    std::uint64_t block = 0;
    std::uint64_t timestamp = 0;
    double camera_s = 0.0;
    std::optional<double> exposure_us;
    int width = 0;
    int height = 0;
    StereoGeometry geometry;
    std::vector<std::uint8_t> disparity;
    std::vector<std::uint8_t> confidence;
  };

  void take(const field::GigeBlock& block);
  /// Whether the camera has settled on an exposure; notes that of the newest picture.
  [[nodiscard]] bool settled(std::optional<double> exposure_us);
  void look();
  void seen(const Taken& picture, const FoundRocks& found);
  void tick();
  void print_table() const;
  void log(const Taken& picture, const FoundRocks& found);
  void stop(int status, const std::string& why);
  void say(const std::string& text) const;
  [[nodiscard]] std::chrono::nanoseconds now() const { return Clock::now() - started_; }

  boost::asio::io_context& context_;
  Options options_;
  Clock::time_point started_ = Clock::now();
  field::LineFile log_;
  field::LineFile csv_;
  field::GigeWire camera_;
  boost::asio::signal_set signals_;
  boost::asio::steady_timer timer_;
  RockTracker tracker_;
  FoundRocks found_;
  std::deque<double> exposures_us_;  ///< Exposure times of the last pictures.
  std::optional<Taken> next_;        ///< Next picture to be evaluated.
  bool looking_ = false;
  std::uint64_t pictures_ = 0;     ///< Pictures evaluated.
  std::uint64_t passed_over_ = 0;  ///< Pictures skipped while another one was evaluated.
  std::uint64_t unsettled_ = 0;    ///< Pictures taken while the camera was choosing its exposure.
  std::uint64_t unusable_ = 0;     ///< Blocks without a readable disparity.
  std::string geometry_trouble_;
  std::chrono::nanoseconds heard_{0};
  std::chrono::nanoseconds next_table_{0};
  std::string said_;
  std::optional<int> status_;
  boost::asio::thread_pool worker_{1};  ///< The last: joined before what it uses is gone.
};

}  // namespace rigwire::find_rocks
