#include "conform/bounds.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace rigwire::conform {

namespace {

/// Counts what comes over one line.
class LineMeter {
 public:
  LineMeter(std::shared_ptr<Bounds> bounds, LineLimits limits)
      : bounds_(std::move(bounds)), limits_(limits) {}

  void asked(Bounds::Instant now) {
    bounds_->check(now);
    taken_ = 0;
  }

  /// Whether a question that ends at `deadline` may wait, or still take what has waited.
  [[nodiscard]] bool may_take(Bounds::Instant now, Bounds::Instant deadline) {
    bounds_->check(now);
    entered_ = now;
    if (now <= deadline) {
      return true;
    }
    if (behind_which_ != deadline) {
      behind_which_ = deadline;
      behind_ = 0;
    }
    return behind_ < limits_.behind;
  }

  void took(std::size_t cost, Bounds::Instant now, Bounds::Instant deadline) {
    bounds_->returned_late(now - std::max(entered_, deadline));
    if (case_ != bounds_->current_case()) {
      case_ = bounds_->current_case();
      taken_ = 0;
    }
    taken_ += cost;
    if (behind_which_ == deadline && now > deadline) {
      behind_ += cost;
    }
    if (taken_ > limits_.question) {
      const std::string most = std::to_string(limits_.question >> 10U) + " KiB";
      taken_ = 0;  // The next question starts with a new allowance.
      throw TooMuch("at most " + most + " between two questions",
                    "more than " + most + ": the device sends without end");
    }
  }

 private:
  std::shared_ptr<Bounds> bounds_;
  LineLimits limits_;
  Bounds::Instant entered_;  ///< When the question that is being asked began to wait.
  std::size_t taken_ = 0;    ///< Since the last question, or the begin of the case.
  std::size_t behind_ = 0;   ///< Behind this deadline.
  std::optional<Bounds::Instant> behind_which_;
  std::uint64_t case_ = 0;
};

class BoundedBytes final : public ByteLine {
 public:
  BoundedBytes(std::unique_ptr<ByteLine> line, std::shared_ptr<Bounds> bounds)
      : line_(std::move(line)), meter_(std::move(bounds), kByteLimits) {}

  bool send(std::span<const std::uint8_t> bytes) override {
    meter_.asked(line_->now());
    return line_->send(bytes);
  }
  bool receive(std::vector<std::uint8_t>& bytes, Clock::time_point deadline) override {
    if (!meter_.may_take(line_->now(), deadline)) {
      return false;
    }
    const std::size_t before = bytes.size();
    const bool came = line_->receive(bytes, deadline);
    meter_.took(bytes.size() - before, line_->now(), deadline);
    return came;
  }
  [[nodiscard]] bool closed() const override { return line_->closed(); }
  [[nodiscard]] Clock::time_point now() const override { return line_->now(); }

 private:
  std::unique_ptr<ByteLine> line_;
  LineMeter meter_;
};

class BoundedFrames final : public CanLine {
 public:
  BoundedFrames(std::unique_ptr<CanLine> line, std::shared_ptr<Bounds> bounds)
      : line_(std::move(line)), meter_(std::move(bounds), kFrameLimits) {}

  bool send(const protocols::can::Frame& frame) override {
    meter_.asked(line_->now());
    return line_->send(frame);
  }
  std::optional<protocols::can::Frame> receive(Clock::time_point deadline) override {
    if (!meter_.may_take(line_->now(), deadline)) {
      return std::nullopt;
    }
    auto frame = line_->receive(deadline);
    meter_.took(frame ? kItem_bytes : 0, line_->now(), deadline);
    return frame;
  }
  [[nodiscard]] Clock::time_point now() const override { return line_->now(); }

 private:
  std::unique_ptr<CanLine> line_;
  LineMeter meter_;
};

class BoundedDatagrams final : public DatagramLine {
 public:
  BoundedDatagrams(std::unique_ptr<DatagramLine> line, std::shared_ptr<Bounds> bounds)
      : line_(std::move(line)), meter_(std::move(bounds), kDatagramLimits) {}

  bool send(std::size_t from_port, const Peer& to, std::span<const std::uint8_t> bytes) override {
    meter_.asked(line_->now());
    return line_->send(from_port, to, bytes);
  }
  std::optional<Datagram> receive(Clock::time_point deadline) override {
    if (!meter_.may_take(line_->now(), deadline)) {
      return std::nullopt;
    }
    auto datagram = line_->receive(deadline);
    meter_.took(datagram ? datagram->bytes.size() + kItem_bytes : 0, line_->now(), deadline);
    return datagram;
  }
  [[nodiscard]] Peer own(std::size_t port) const override { return line_->own(port); }
  [[nodiscard]] std::uint64_t lost_here() const override { return line_->lost_here(); }
  [[nodiscard]] Clock::time_point now() const override { return line_->now(); }

 private:
  std::unique_ptr<DatagramLine> line_;
  LineMeter meter_;
};

}  // namespace

void Bounds::begin() {
  wall_begin_ = std::chrono::steady_clock::now();
  line_begin_.reset();
  line_elapsed_ = {};
}

void Bounds::check(Instant now) {
  if (!line_begin_) {
    line_begin_ = now;
  }
  line_elapsed_ = now - *line_begin_;
  check();
}

void Bounds::check() const {
  if (elapsed() - kGrace > limit_) {
    throw TimeIsUp(text());
  }
}

std::chrono::nanoseconds Bounds::elapsed() const {
  return std::max<std::chrono::nanoseconds>(line_elapsed_,
                                            std::chrono::steady_clock::now() - wall_begin_);
}

std::string Bounds::text() const {
  return "the suite's limit of " +
         std::to_string(std::chrono::duration_cast<std::chrono::seconds>(limit_).count()) +
         " s has passed";
}

bool proves_nothing(const CaseResult& result, const Bounds& bounds) {
  const bool passed = result.verdict != Verdict::fail && result.verdict != Verdict::lenient;
  return !passed && bounds.held_up() > kHeldUp;
}

void note_tries(CaseResult& result, int tries, std::chrono::nanoseconds held_up) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(held_up).count();
  result.steps.insert(result.steps.begin(),
                      Step{.kind = Step::Kind::note,
                           .at = {},
                           .bytes = {},
                           .words = "try " + std::to_string(tries + 1) +
                                    ": in the one before this machine held the suite up for " +
                                    std::to_string(ms) + " ms"});
}

std::unique_ptr<ByteLine> bounded(std::unique_ptr<ByteLine> line, std::shared_ptr<Bounds> bounds) {
  return std::make_unique<BoundedBytes>(std::move(line), std::move(bounds));
}

std::unique_ptr<CanLine> bounded(std::unique_ptr<CanLine> line, std::shared_ptr<Bounds> bounds) {
  return std::make_unique<BoundedFrames>(std::move(line), std::move(bounds));
}

std::unique_ptr<DatagramLine> bounded(std::unique_ptr<DatagramLine> line,
                                      std::shared_ptr<Bounds> bounds) {
  return std::make_unique<BoundedDatagrams>(std::move(line), std::move(bounds));
}

CaseResult not_reached(const CaseIdentity& identity, const Bounds& bounds) {
  return {identity, Verdict::not_reached, "", bounds.text(), {}};
}

}  // namespace rigwire::conform
