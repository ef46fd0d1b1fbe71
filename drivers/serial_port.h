// The field side of a serial line: opens a terminal (a real port, a USB adapter, a pseudo-terminal
// published by Pty), raw, at one speed.
//
// When the line hangs up (adapter unplugged, other side gone) the port closes and is opened again
// every `reopen_period` until it works; meanwhile status().client_present is false and what is
// written is taken and forgotten, as on a line with nothing plugged in. Bytes that arrived before
// the port was opened are thrown away.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

struct SerialPortSettings {
  std::string path;              ///< "/dev/ttyUSB0", "/tmp/rigwire/gnss".
  std::uint32_t baud = 9600;     ///< bit/s, both directions.
  bool wait_for_device = false;  ///< A path that does not open yet is tried again, not an error.
  std::chrono::milliseconds reopen_period{200};
};

class SerialPort final : public ByteStream {
 public:
  /// Throws EndpointError when the path does not open or is no terminal (unless `wait_for_device`),
  /// std::invalid_argument when a setting makes no sense.
  SerialPort(boost::asio::io_context& context, SerialPortSettings settings);
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  void start(Receiver receiver) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  /// `client_present` says whether the line is open.
  [[nodiscard]] EndpointStatus status() const override;

 private:
  /// Empty when it worked, else the reason.
  [[nodiscard]] std::string try_open();
  void wait_readable();
  /// Reads unasked, every few milliseconds. On a busy machine the kernel hands the bytes of a
  /// pseudo-terminal over, and reports them, up to half a second late; a read fetches them at once.
  void look();
  void read_all();
  void hang_up();
  void reopen_later();

  SerialPortSettings settings_;
  boost::asio::posix::stream_descriptor port_;
  boost::asio::steady_timer reopen_timer_;
  boost::asio::steady_timer look_timer_;
  Receiver receiver_;
  std::vector<std::uint8_t> buffer_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
