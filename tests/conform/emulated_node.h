// An emulated device on CAN as the far end of a bus, in its own time: nothing waits. What it sends
// may be damaged on the way, one frame at a time, and what is sent to it held back.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "conform/can_line.h"
#include "emulators/device.h"

namespace rigwire::conform {

class EmulatedNode : public CanLine, public emulators::FrameOutput {
 public:
  using Frame = protocols::can::Frame;
  /// Instead of a frame: itself, another, several, or none.
  using Change = std::function<std::vector<Frame>(const Frame& frame)>;

  EmulatedNode(Change saying, Change hearing)
      : saying_(std::move(saying)), hearing_(std::move(hearing)) {}

  bool send(const Frame& frame) override {
    for (const Frame& each : hearing_ ? hearing_(frame) : std::vector{frame}) {
      device().receive(now_, each);
    }
    run(now_);
    return true;
  }
  std::optional<Frame> receive(Clock::time_point deadline) override {
    const SimTime until = kStart + deadline.time_since_epoch();
    while (true) {
      if (!sent_.empty() && sent_.front().first <= now_) {
        const Frame frame = sent_.front().second;
        sent_.pop_front();
        return frame;
      }
      if (now_ >= until) {
        return std::nullopt;
      }
      run(std::min(until, now_ + std::chrono::milliseconds(1)));
    }
  }
  [[nodiscard]] Clock::time_point now() const override {
    return Clock::time_point(now_.time_since_epoch());
  }

  // Takes a frame that the device sends.
  void send(SimTime due, const Frame& frame) override {
    for (const Frame& each : saying_ ? saying_(frame) : std::vector{frame}) {
      sent_.emplace_back(due, each);
    }
  }

 protected:
  [[nodiscard]] virtual emulators::CanDevice& device() = 0;
  /// One sample of what stands at present.
  virtual void feed(SimTime instant) = 0;

  void run(SimTime until) {
    for (SimTime next = device().sample_plan().next_after(now_); next <= until;
         next = device().sample_plan().next_after(next)) {
      now_ = std::max(now_, next);
      feed(next);
    }
    now_ = std::max(now_, until);
    device().advance(now_);
  }

 private:
  Change saying_;
  Change hearing_;
  SimTime now_ = kStart;
  std::deque<std::pair<SimTime, Frame>> sent_;
};

}  // namespace rigwire::conform
