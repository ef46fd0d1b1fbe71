#include "memory_can.h"

#include <boost/asio/post.hpp>
#include <utility>

namespace rigwire::drivers {

class MemoryCan::End final : public CanBus {
 public:
  End(boost::asio::io_context& context, std::size_t capacity, std::string name)
      : context_(context), capacity_(capacity), name_(std::move(name)) {}

  void connect(const std::shared_ptr<End>& peer) { peer_ = peer; }

  void start(Receiver receiver) override { receiver_ = std::move(receiver); }

  void on_client(ClientWatcher watcher) override { client_watcher_ = std::move(watcher); }

  bool send(const protocols::can::Frame& frame) override {
    const auto peer = peer_.lock();
    if (!peer || peer->waiting_ == peer->capacity_) {
      return false;
    }
    ++peer->waiting_;
    to_peer([frame](End& end) {
      --end.waiting_;
      if (end.receiver_) {
        end.receiver_(frame);
      }
    });
    return true;
  }

  void confirm(bool sent, Stamp /*stamp*/) override {
    to_peer([sent](End& end) {
      if (end.confirm_watcher) {
        end.confirm_watcher(sent);
      }
    });
  }

  bool report(const protocols::can::ControllerReport& report, Stamp /*stamp*/) override {
    to_peer([report](End& end) {
      if (end.report_watcher) {
        end.report_watcher(report);
      }
    });
    return true;
  }

  void set_client(const CanClient& client) {
    to_peer([client](End& end) {
      if (end.client_watcher_ && client != end.told_) {
        end.told_ = client;
        end.client_watcher_(client);
      }
    });
  }

  [[nodiscard]] EndpointStatus status() const override {
    const auto peer = peer_.lock();
    return {name_, peer && peer->receiver_};
  }

  ConfirmWatcher confirm_watcher;
  ReportWatcher report_watcher;

 private:
  /// Through the io_context, if the other end is still there then.
  template <class Action>
  void to_peer(Action action) {
    boost::asio::post(context_, [target = peer_, action] {
      if (const auto end = target.lock()) {
        action(*end);
      }
    });
  }

  boost::asio::io_context& context_;
  std::size_t capacity_;
  std::string name_;
  std::weak_ptr<End> peer_;
  Receiver receiver_;
  ClientWatcher client_watcher_;
  CanClient told_;
  std::size_t waiting_ = 0;
};

MemoryCan::MemoryCan(boost::asio::io_context& context, std::size_t queue_frames,
                     const std::string& name)
    : device_(std::make_shared<End>(context, queue_frames, name)),
      field_(std::make_shared<End>(context, queue_frames, name)) {
  device_->connect(field_);
  field_->connect(device_);
}

MemoryCan::~MemoryCan() = default;

CanBus& MemoryCan::device() {
  return *device_;
}
CanBus& MemoryCan::field() {
  return *field_;
}

void MemoryCan::set_client(const CanClient& client) {
  field_->set_client(client);
}
void MemoryCan::on_confirm(ConfirmWatcher watcher) {
  field_->confirm_watcher = std::move(watcher);
}
void MemoryCan::on_report(ReportWatcher watcher) {
  field_->report_watcher = std::move(watcher);
}

}  // namespace rigwire::drivers
