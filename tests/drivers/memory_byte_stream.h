// A serial line without a system: the in-memory twin of Pty (device end) and SerialPort (client
// end), with the same contract, for deterministic tests.
//
// Bytes written at one end are posted to the other end's receiver through the io_context, in order.
// Each direction holds kCapacity bytes, as the kernel does for a pseudo-terminal; what does not fit
// is refused. Bytes written by the device while no client is open are taken and forgotten, and what
// a client leaves unread goes with it. With several clients open, each byte reaches one of them:
// the one that opened first. The line's speed is at first the one given at construction; the one
// that a client sets stays for the next client.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class MemorySerialLine {
 public:
  static constexpr std::size_t kCapacity = 16384;

  /// `name` is what status() shows; `baud` is the clients' speed, bit/s, until one sets another.
  explicit MemorySerialLine(boost::asio::io_context& context, std::string name = "memory serial",
                            std::uint32_t baud = 38400);
  ~MemorySerialLine();
  MemorySerialLine(const MemorySerialLine&) = delete;
  MemorySerialLine& operator=(const MemorySerialLine&) = delete;

  /// The emulated device's end; lives as long as the line.
  [[nodiscard]] ByteStream& device();
  /// A client opens the line; destroying the returned object closes it. It may outlive the line,
  /// which then counts as hung up.
  [[nodiscard]] std::unique_ptr<ByteStream> open_client();
  /// A client sets the speed of its end, bit/s.
  void set_client_baud(std::uint32_t baud);

  struct State;

 private:
  std::shared_ptr<State> state_;
  std::unique_ptr<ByteStream> device_;
};

}  // namespace rigwire::drivers
