#include "drivers/memory_can.h"

#include <boost/asio/post.hpp>
#include <utility>

namespace rigwire::drivers {

class MemoryCan::End final : public CanBus {
 public:
  End(boost::asio::io_context& context, std::size_t capacity, std::string name)
      : context_(context), capacity_(capacity), name_(std::move(name)) {}

  void connect(const std::shared_ptr<End>& peer) { peer_ = peer; }

  void start(Receiver receiver) override { receiver_ = std::move(receiver); }

  bool send(const protocols::can::Frame& frame) override {
    const auto peer = peer_.lock();
    if (!peer || peer->waiting_ == peer->capacity_) {
      return false;
    }
    ++peer->waiting_;
    boost::asio::post(context_, [target = std::weak_ptr<End>(peer), frame] {
      if (const auto end = target.lock()) {
        --end->waiting_;
        if (end->receiver_) {
          end->receiver_(frame);
        }
      }
    });
    return true;
  }

  [[nodiscard]] EndpointStatus status() const override {
    const auto peer = peer_.lock();
    return {name_, peer && peer->receiver_};
  }

 private:
  boost::asio::io_context& context_;
  std::size_t capacity_;
  std::string name_;
  std::weak_ptr<End> peer_;
  Receiver receiver_;
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

}  // namespace rigwire::drivers
