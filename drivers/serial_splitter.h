// A serial line with several plugs, as a splitter cable has them: every port hears what the device
// sends, and only the first one is heard by it. What clients of the others write goes nowhere.
//
// The first port's client is the line's: its presence and its speed are told by on_client(). A port
// whose client does not read loses bytes by itself; the others go on.
#pragma once

#include <memory>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class SerialSplitter final : public ByteStream {
 public:
  /// Throws std::invalid_argument when there is no port.
  explicit SerialSplitter(std::vector<std::unique_ptr<ByteStream>> ports);

  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override;
  /// The least that any port took: bytes lost at one are lost bytes.
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  /// The first port's address; a client is there when any port has one.
  [[nodiscard]] EndpointStatus status() const override;

 private:
  std::vector<std::unique_ptr<ByteStream>> ports_;
};

}  // namespace rigwire::drivers
