// The device's side of a serial line: the master of a pseudo-terminal, its slave published under a
// path of the user's choice.
//
// - The slave is raw from the start and again whenever the last client has left; the speed that a
//   client sets stays, as on a real port.
// - While nobody has the slave open, what is written is taken and forgotten, and what the last
//   client left unread is thrown away: the next client starts with fresh bytes. (The kernel would
//   keep up to 16 KiB for it.) A client that closes and another that opens within the same few
//   milliseconds, between two looks at the line, count as one.
// - A client is noticed at the next write, or at most kPresencePeriod after it came.
// - Nothing blocks. With a client that does not read, the kernel takes about 16 KiB and then
//   refuses; write() then returns less than was offered.
//
// The path is a symbolic link, replaced at once when it is dangling or older than the terminal that
// it names (left by a process that was killed), refused when it is anything else's: a file, a link
// to something that is no pseudo-terminal, or a link that a running program keeps. Ownership is
// held by an abstract Unix socket, which the kernel releases however the process ends; it is seen
// within one network namespace.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class Pty final : public ByteStream {
 public:
  /// How often an unused line is looked at.
  static constexpr std::chrono::milliseconds kPresencePeriod{10};

  /// Opens the pair and publishes the slave at `link`; its parent directories are created. An empty
  /// `link` publishes nothing. Throws EndpointError.
  Pty(boost::asio::io_context& context, std::filesystem::path link);
  ~Pty() override;
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  void start(Receiver receiver) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] EndpointStatus status() const override;

  /// The speed in bit/s that the slave is set to at this moment (38400 until a client sets one).
  [[nodiscard]] std::uint32_t client_baud() const;
  /// The slave itself, "/dev/pts/3".
  [[nodiscard]] const std::string& slave_name() const { return slave_name_; }

 private:
  void publish();
  void wait_readable();
  void wait_presence();
  /// Reads what there is, then knows whether the slave is open.
  void drain_master();
  void note_presence(bool present);
  [[nodiscard]] bool hung_up() const;

  std::filesystem::path link_;
  std::string slave_name_;
  int descriptor_ = -1;  ///< Of the master; owned by master_.
  boost::asio::posix::stream_descriptor master_;
  boost::asio::posix::stream_descriptor ownership_;  ///< The abstract socket.
  boost::asio::steady_timer presence_timer_;
  Receiver receiver_;
  std::vector<std::uint8_t> buffer_;
  bool published_ = false;
  bool present_ = false;
  bool reading_ = false;  ///< A wait for bytes is pending.
  /// Handlers that the system already queued find out by this that the object has gone.
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
