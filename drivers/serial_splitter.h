// A serial line with several ports, as a splitter cable has them: every port receives what the
// device sends, and the device receives only from the first one. What clients of the others write
// is discarded.
//
// on_client() reports the presence and the speed of the first port's client. A port whose client
// does not read loses bytes by itself; the others are not affected.
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
  /// Returns the minimum that any port took: bytes lost at one are lost bytes.
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  /// The first port's address; a client is there when any port has one.
  [[nodiscard]] EndpointStatus status() const override;

 private:
  std::vector<std::unique_ptr<ByteStream>> ports_;
};

}  // namespace rigwire::drivers
