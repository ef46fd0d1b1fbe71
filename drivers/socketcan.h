// A CAN interface of the kernel (vcan0, can0), by a raw socket. Used by both sides.
//
// - Receives every data and remote frame that others put on the interface, this host's other
//   programs included, own frames not. CAN FD frames are refused and counted. Error frames are
//   decoded and reported by on_report().
// - Frames that the interface's queue does not take wait here (can_transmit_queue.h), kWaiting at
//   most, and are tried again every kRetryPeriod.
// - report() sends the report as an error frame where the interface is virtual (vcan, vxcan): there
//   the bus model is the bus, and tools see its errors as they would a real one's. A real interface
//   has errors of its own.
// - An interface that goes down, or whose bus is off, takes no frames; they are lost and counted,
//   and everything goes on when it comes up. One that is removed is looked for every kSearchPeriod
//   and opened again under its name. status() says "(down)" and "(removed)".
// - The kernel does not report to the sender when a frame has gone out.
//
// On vcan the kernel silently drops frames for a receiver that does not read; they are counted
// where the kernel reports them.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "drivers/can_transmit_queue.h"
#include "drivers/endpoints.h"

namespace rigwire::drivers {

/// Whether the kernel has CAN sockets at all. With an interface name: whether that exists too.
[[nodiscard]] bool socketcan_available();
[[nodiscard]] bool socketcan_available(const std::string& interface);

struct SocketCanCounters {
  std::uint64_t dropped = 0;        ///< By the kernel, because this socket's buffer was full.
  std::uint64_t fd_frames = 0;      ///< CAN FD frames, not taken.
  std::uint64_t error_frames = 0;   ///< Received.
  std::uint64_t interruptions = 0;  ///< Times that the interface went down or away.
};

class SocketCanBus final : public CanBus {
 public:
  static constexpr std::size_t kWaiting = 256;
  static constexpr std::chrono::milliseconds kRetryPeriod{1};
  static constexpr std::chrono::milliseconds kSearchPeriod{250};

  /// `bit_rate_bps` is what the interface's must be if it has one; 0: whatever it is. Throws
  /// EndpointError when the kernel has no CAN, the interface is missing, is no CAN interface, or is
  /// down, the message says how to make one; std::invalid_argument naming both rates when the
  /// interface has another.
  SocketCanBus(boost::asio::io_context& context, std::string interface,
               std::uint32_t bit_rate_bps = 0);
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  using ReportWatcher = std::function<void(const protocols::can::ControllerReport&)>;
  /// Calls `watcher` for every error frame. To be called before start().
  void on_report(ReportWatcher watcher) { watcher_ = std::move(watcher); }

  void start(Receiver receiver) override;
  /// True when the interface has the frame, or it waits. False when it is lost.
  bool send(const protocols::can::Frame& frame) override;
  bool report(const protocols::can::ControllerReport& report, Stamp stamp) override;
  /// client_present: a frame of another node has arrived.
  [[nodiscard]] EndpointStatus status() const override;

  [[nodiscard]] const SocketCanCounters& counters() const { return counters_; }
  /// State last seen; a downed interface that came up is noticed with the next frame or status().
  [[nodiscard]] CanLink link() const { return queue_.link(); }

 private:
  bool offer(const can_frame& frame);
  void wait_readable();
  void wait_to_retry();
  void wait_to_search();
  void read_all();
  void take(const can_frame& frame);
  /// What a change of the queue's link asks for.
  void follow_link();

  std::string interface_;
  bool virtual_ = false;
  boost::asio::posix::stream_descriptor socket_;
  boost::asio::steady_timer retry_timer_;
  boost::asio::steady_timer search_timer_;
  CanTransmitQueue queue_;
  Receiver receiver_;
  ReportWatcher watcher_;
  CanLink known_link_ = CanLink::up;
  bool started_ = false;
  bool heard_ = false;
  bool retrying_ = false;
  bool searching_ = false;
  /// The kernel's count of dropped frames for the present socket.
  std::uint32_t dropped_by_socket_ = 0;
  SocketCanCounters counters_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
