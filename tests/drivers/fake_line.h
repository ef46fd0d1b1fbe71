#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

/// A serial line whose far end is the test: what was written, and how much more it takes.
class FakeLine final : public ByteStream {
 public:
  void start(Receiver receiver) override { receiver_ = std::move(receiver); }
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t taken = std::min(bytes.size(), room);
    written.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    room -= taken;
    return taken;
  }
  [[nodiscard]] EndpointStatus status() const override { return {"fake line", true}; }

  void feed(std::string_view text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    receiver_(bytes);
  }
  /// The far end goes away.
  void hang_up() { watcher_({}); }
  /// What was written since the last call.
  std::string take() { return std::exchange(written, {}); }

  std::string written;
  std::size_t room = 1'000'000;

 private:
  Receiver receiver_;
  ClientWatcher watcher_;
};

}  // namespace rigwire::drivers
