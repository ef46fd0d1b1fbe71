#include "drivers/serial_port.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "drivers/descriptor.h"
#include "drivers/terminal.h"

namespace rigwire::drivers {
namespace {

constexpr std::size_t kSerialReadSize = 4096;
constexpr int kSerialReadsPerTurn = 8;
/// Input is also looked for this often, unasked: see look().
constexpr std::chrono::milliseconds kLookPeriod{10};

}  // namespace

SerialPort::SerialPort(boost::asio::io_context& context, SerialPortSettings settings)
    : settings_(std::move(settings)),
      port_(context),
      reopen_timer_(context),
      look_timer_(context),
      buffer_(kSerialReadSize) {
  if (settings_.path.empty()) {
    throw std::invalid_argument("serial port: path is empty");
  }
  if (settings_.baud == 0) {
    throw std::invalid_argument("serial port " + settings_.path +
                                ": baud is 0, allowed 1 and more");
  }
  if (settings_.reopen_period.count() <= 0) {
    throw std::invalid_argument("serial port " + settings_.path + ": reopen_period is " +
                                std::to_string(settings_.reopen_period.count()) +
                                " ms, allowed 1 and more");
  }
  const std::string failure = try_open();
  if (!failure.empty()) {
    if (!settings_.wait_for_device) {
      throw EndpointError("serial port " + settings_.path + ": " + failure +
                          "; check the path, that the device is there, and that this user may open "
                          "it (group dialout)");
    }
    reopen_later();
  }
}

std::string SerialPort::try_open() {
  Descriptor terminal(::open(settings_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!terminal.open()) {
    return std::generic_category().message(errno);
  }
  if (!make_terminal_raw(terminal.get(), settings_.baud)) {
    return errno == ENOTTY ? "it is not a terminal" : std::generic_category().message(errno);
  }
  discard_terminal_input(terminal.get());
  port_.assign(terminal.release());
  if (receiver_) {
    wait_readable();
  }
  return {};
}

void SerialPort::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  if (port_.is_open()) {
    wait_readable();
  }
  look();
}

void SerialPort::look() {
  look_timer_.expires_after(kLookPeriod);
  look_timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
        if (error || alive.expired() || !receiver_) {
          return;
        }
        if (port_.is_open()) {
          read_all();
        }
        if (!alive.expired()) {
          look();
        }
      });
}

void SerialPort::wait_readable() {
  port_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                   [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
                     if (alive.expired() || error == boost::asio::error::operation_aborted) {
                       return;
                     }
                     read_all();
                     if (!alive.expired() && port_.is_open()) {
                       wait_readable();
                     }
                   });
}

void SerialPort::read_all() {
  for (int turn = 0; turn < kSerialReadsPerTurn && port_.is_open(); ++turn) {
    const ssize_t count = ::read(port_.native_handle(), buffer_.data(), buffer_.size());
    if (count > 0) {
      const std::weak_ptr<char> alive = alive_;
      receiver_(std::span(buffer_).first(static_cast<std::size_t>(count)));
      if (alive.expired()) {
        return;
      }
      continue;
    }
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      break;
    }
    hang_up();  // end of file or EIO: the other side is gone
    return;
  }
}

void SerialPort::hang_up() {
  boost::system::error_code ignored;
  port_.close(ignored);
  reopen_later();
}

void SerialPort::reopen_later() {
  reopen_timer_.expires_after(settings_.reopen_period);
  reopen_timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
        if (error || alive.expired()) {
          return;
        }
        if (!port_.is_open() && !try_open().empty()) {
          reopen_later();
        }
      });
}

std::size_t SerialPort::write(std::span<const std::uint8_t> bytes) {
  std::size_t taken = 0;
  while (port_.is_open() && taken < bytes.size()) {
    const ssize_t count =
        ::write(port_.native_handle(), bytes.data() + taken, bytes.size() - taken);
    if (count > 0) {
      taken += static_cast<std::size_t>(count);
    } else if (count < 0 && errno == EINTR) {
      continue;
    } else if (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
      hang_up();
    } else {
      return taken;
    }
  }
  return bytes.size();
}

EndpointStatus SerialPort::status() const {
  return {settings_.path, port_.is_open()};
}

}  // namespace rigwire::drivers
