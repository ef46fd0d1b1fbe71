// A node of a CAN bus that a DBC file and its binding describe: any sensor or actuator with known
// messages, attached to a part of the machine.
//
// What it does on the bus: dbc_traffic.h. What it can be attached to: quantities.h. The clocks of
// its messages and of its samples are the device's own.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "emulators/dbc_node/dbc_traffic.h"
#include "emulators/dbc_node/quantities.h"

namespace rigwire::emulators {

namespace dbc_node_details {

/// The backend's face: commands where it has any.
template <class Backend>
class Face : public Backend {};
template <class Backend>
requires requires {
  typename Backend::Command;
}
class Face<Backend> : public Backend {
 public:
  [[nodiscard]] const typename Backend::Command& command() const override { return command_; }

 protected:
  typename Backend::Command command_{};
};

}  // namespace dbc_node_details

template <class Backend>
class DbcNode final : public CanDevice, public dbc_node_details::Face<Backend> {
  using Of = Attachment<Backend>;

 public:
  /// Throws as DbcTraffic.
  DbcNode(const DbcNodeSettings& settings, FrameOutput& output)
      : traffic_(settings, output), values_(settings.measured.size()) {
    for (const DbcSentMessage& message : settings.sent) {
      for (std::size_t s = 0; s < message.shows.size(); ++s) {
        if (std::holds_alternative<DbcMeasured>(message.shows[s].source)) {
          names_.push_back(message.layout.name + "." + message.layout.signals[s].name);
        }
      }
    }
    std::size_t name = 0;
    for (const DbcSentMessage& message : settings.sent) {
      for (std::size_t s = 0; s < message.shows.size(); ++s) {
        if (std::holds_alternative<DbcMeasured>(message.shows[s].source)) {
          const protocols::can::OwnedSignal& row = message.layout.signals[s];
          quantities_.push_back(
              {names_[name++], row.unit, row.lower, row.upper, std::abs(row.scale)});
        }
      }
    }
    follow(kStart);
  }

  void advance(SimTime now) override {
    traffic_.advance(now);
    follow(now);
  }
  [[nodiscard]] SimTime next_event() const override { return traffic_.next_event(); }
  [[nodiscard]] SamplePlan sample_plan() const override {
    const DbcNodeSettings& settings = traffic_.settings();
    constexpr bool kSamples = !std::is_same_v<Backend, NothingBackend>;
    return {kSamples ? kStart + settings.supply.power_on : kNever, settings.sample_period};
  }
  [[nodiscard]] ReceiveCounters received() const override { return traffic_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override { return traffic_.nominal_rate_hz(); }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override {
    std::vector<protocols::can::OwnedMessage> all;
    for (const DbcSentMessage& message : traffic_.settings().sent) {
      all.push_back(message.layout);
      all.back().sender = name;
      all.back().period_ms =
          static_cast<std::uint32_t>(message.period / std::chrono::milliseconds{1});
    }
    for (const DbcTakenMessage& message : traffic_.settings().taken) {
      all.push_back(message.layout);
      all.back().sender.clear();
    }
    return all;
  }

  void receive(SimTime now, const protocols::can::Frame& frame) override {
    traffic_.receive(now, frame);
    follow(now);
  }
  void controller(SimTime now, const protocols::can::ControllerReport& report) override {
    traffic_.controller(now, report);
  }
  void update(const typename Backend::Sample& sample) override {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = Of::measured()[traffic_.settings().measured[i]].of(sample);
    }
    traffic_.measure(sample.time, values_);
    follow(sample.time);
  }

  /// Return the parts that faults act on: messages, supply, share of messages that are sent.
  [[nodiscard]] DbcTraffic& faults() { return traffic_; }
  [[nodiscard]] Supply& supply() { return traffic_.supply(); }
  [[nodiscard]] Pace& pace() { return traffic_.pace(); }
  [[nodiscard]] const DbcTraffic& traffic() const { return traffic_; }

 private:
  /// Copies the values that the traffic requests at present into the command.
  void follow([[maybe_unused]] SimTime now) {
    // A receiver has nothing to move: its command stays unchanged.
    if constexpr (!std::is_same_v<typename Of::Command, NoCommand>) {
      typename Backend::Command command;
      for (std::size_t i = 0; i < traffic_.moved().size(); ++i) {
        Of::commanded()[traffic_.settings().moved[i]].set(command, traffic_.moved()[i]);
      }
      if (!(command == this->command_)) {
        command.time = now;
        this->command_ = command;
      }
    }
  }

  DbcTraffic traffic_;
  std::vector<double> values_;
  std::vector<std::string> names_;
  std::vector<Quantity> quantities_;
};

}  // namespace rigwire::emulators
