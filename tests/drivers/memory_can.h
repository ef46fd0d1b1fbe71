// A CAN bus without a system: two ends, what one sends the other receives. The in-memory twin of
// SocketCanBus and of slcan, for deterministic tests.
//
// Frames are handed over through the io_context, in order. Each direction holds `queue_frames`
// frames; beyond that send() is false, as ENOBUFS is. Frames sent to an end that has not started
// are lost, as on a bus that nobody listens to.
//
// The device's end is that of an adapter: what the field says of its controller by set_client()
// reaches the device's on_client(), and confirmations and reports reach the field's watchers, in
// order with the frames.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class MemoryCan {
 public:
  explicit MemoryCan(boost::asio::io_context& context, std::size_t queue_frames = 64,
                     const std::string& name = "memory CAN");
  ~MemoryCan();
  MemoryCan(const MemoryCan&) = delete;
  MemoryCan& operator=(const MemoryCan&) = delete;

  /// The emulated devices' end and the field program's end; they live as long as the bus.
  [[nodiscard]] CanBus& device();
  [[nodiscard]] CanBus& field();

  using ConfirmWatcher = std::function<void(bool sent)>;
  using ReportWatcher = std::function<void(const protocols::can::ControllerReport&)>;
  void set_client(const CanClient& client);
  void on_confirm(ConfirmWatcher watcher);
  void on_report(ReportWatcher watcher);

 private:
  class End;
  std::shared_ptr<End> device_;
  std::shared_ptr<End> field_;
};

}  // namespace rigwire::drivers
