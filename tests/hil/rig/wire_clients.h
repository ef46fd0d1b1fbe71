// Clients of a rig's wires in the test's own program, in simulated time: what they say at which
// instant, and what they hear. Nobody else is on the wires then.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hil/executive/event_source.h"
#include "hil/wires/outlets.h"
#include "hil/wires/wire_tap.h"

namespace rigwire::hil::test {

class WireClients final : public EventSource {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Unit {
    SimTime at{};
    Bytes bytes;                  ///< Bytes of a serial line, a datagram, a connection.
    protocols::can::Frame frame;  ///< Frame of a bus.
  };

  // Before the run, for each wire in order of time.

  /// A speed on a serial line, how a client takes part in a bus, or a frame.
  void say(const std::string& wire, SimTime at, const WirePiece& piece) {
    steps_.push_back({at, wire, piece, {}});
  }
  void say(const std::string& wire, SimTime at, WirePiece piece, Bytes bytes) {
    steps_.push_back({at, wire, std::move(piece), std::move(bytes)});
  }
  /// Each outlet, with its wire's name (Recorder::on_outlet).
  void join(const std::string& wire, QueuedOutlet& outlet) {
    outlet.cut_off();
    outlet.tell(taps_.emplace(wire, Tap(heard_[wire])).first->second);
    outlets_[wire].push_back(&outlet);
  }

  /// What devices have sent on a wire, in order of time.
  [[nodiscard]] const std::vector<Unit>& heard(const std::string& wire) const {
    static const std::vector<Unit> nothing;
    const auto found = heard_.find(wire);
    return found == heard_.end() ? nothing : found->second;
  }
  [[nodiscard]] std::vector<std::string> wires() const {
    std::vector<std::string> names;
    for (const auto& [wire, outlets] : outlets_) {
      names.push_back(wire);
    }
    return names;
  }

  /// When every step has been added.
  void begin() { std::ranges::stable_sort(steps_, {}, &Step::at); }
  [[nodiscard]] SimTime next_event() const override {
    return saying_ || next_ == steps_.size() ? kNever : steps_[next_].at;
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime now) override {
    saying_ = true;
    while (next_ < steps_.size() && steps_[next_].at <= now) {
      Step& step = steps_[next_++];
      std::visit(
          [&](auto& piece) {
            if constexpr (requires { piece.bytes; }) {
              piece.bytes = step.bytes;
            }
          },
          step.piece);
      EXPECT_TRUE(std::ranges::any_of(
          outlets_[step.wire], [&](QueuedOutlet* outlet) { return outlet->arrive(step.piece); }))
          << step.wire << ": nobody hears it";
    }
    saying_ = false;
  }

 private:
  class Tap final : public WireTap {
   public:
    explicit Tap(std::vector<Unit>& heard) : heard_(&heard) {}
    void sent(SimTime at, const WirePiece& piece) override {
      std::visit(
          [&]<class Piece>(const Piece& one) {
            if constexpr (std::is_same_v<Piece, protocols::can::Frame>) {
              heard_->push_back({at, {}, one});
            } else if constexpr (requires { one.bytes; }) {
              heard_->push_back({at, {one.bytes.begin(), one.bytes.end()}, {}});
            }
          },
          piece);
    }
    void carried(SimTime /*at*/, const WirePiece& /*piece*/) override {}
    void received(const WirePiece& /*piece*/) override {}
    void lost(SimTime /*at*/) override {}

   private:
    std::vector<Unit>* heard_;
  };
  struct Step {
    SimTime at{};
    std::string wire;
    WirePiece piece;
    Bytes bytes;  ///< Bytes of the piece, where it has any.
  };

  std::vector<Step> steps_;
  std::map<std::string, std::vector<Unit>> heard_;
  std::map<std::string, Tap> taps_;
  std::map<std::string, std::vector<QueuedOutlet*>> outlets_;
  std::size_t next_ = 0;
  bool saying_ = false;
};

}  // namespace rigwire::hil::test
