// Where the samples of one sensor arrive: the emulator that takes them, and what is on its way to
// it.
//
// Owns the samples that wait, and nothing else. Nothing in it throws in steady state.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "emulators/device.h"
#include "hil/executive/event_source.h"
#include "hil/executive/shelves.h"

namespace rigwire::hil {

/// Samples of one kind that wait until the device's time has reached them. Memory stays within
/// twice of what ever waited at once.
template <class Sample>
class SampleInbox {
 public:
  void put(const Sample& sample) {
    if (taken_ > 0 && 2 * taken_ >= waiting_.size()) {
      waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(taken_));
      taken_ = 0;
    }
    waiting_.push_back(sample);
  }
  [[nodiscard]] SimTime next() const {
    return taken_ == waiting_.size() ? kNever : waiting_[taken_].time;
  }
  /// Precondition: next() != kNever. The reference holds until put().
  const Sample& take() { return waiting_[taken_++]; }
  /// Samples that there is memory for.
  [[nodiscard]] std::size_t capacity() const { return waiting_.capacity(); }

 private:
  std::vector<Sample> waiting_;
  std::size_t taken_ = 0;
};

/// What the executive sees of every station.
class Station : public EventSource {
 public:
  /// `device` must outlive it.
  explicit Station(emulators::Device& device) : device_(device) {}

  [[nodiscard]] emulators::Device& device() { return device_; }
  [[nodiscard]] const emulators::Device& device() const { return device_; }
  /// Takes what lies on its shelf, to be given to the device at each sample's own instant. Returns
  /// how many that are.
  virtual std::size_t take(StationIndex self, const Shelves& samples) = 0;
  /// Adds to `requests` what the device wants of the truth and has not asked for yet: its sample
  /// plan (SamplePlan), and what it commands.
  virtual void collect(StationIndex self, Shelves& requests) {
    for (const auto& put : std::exchange(orders_, {})) {
      put(self, requests);
    }
    const SamplePlan plan = device_.sample_plan();
    if (plan != announced_plan_) {
      announced_plan_ = plan;
      requests.of<SamplePlan>(self).push_back(plan);
    }
  }

  /// Goes to the truth with the next requests, once.
  template <class Order>
  void send(const Order& order) {
    orders_.push_back([order](StationIndex self, Shelves& requests) {
      requests.of<Order>(self).push_back(order);
    });
  }

 private:
  emulators::Device& device_;
  SamplePlan announced_plan_;
  std::vector<std::function<void(StationIndex, Shelves&)>> orders_;
};

/// A class of device that takes samples (emulators/backends.h): Backend::Sample has a member
/// `time`.
template <class Backend>
concept TakesSamples = requires(Backend& backend, const typename Backend::Sample& sample) {
  backend.update(sample);
  { sample.time } -> std::convertible_to<SimTime>;
};

/// A backend that also sends commands to the truth. Equal commands are sent once.
template <class Backend>
concept Commands = requires(const Backend& backend) {
  { backend.command() } -> std::same_as<const typename Backend::Command&>;
};

/// A backend whose samples are too frequent to wake up for each: they are taken when the packet
/// that they fill is complete.
template <class Backend>
concept Gathers = requires(const Backend& backend) {
  { backend.packet_complete_at() } -> std::same_as<SimTime>;
};

namespace station_details {

/// The command that the truth knows of.
template <class Backend>
struct Announced {};
template <Commands Backend>
struct Announced<Backend> {
  typename Backend::Command command;
};

}  // namespace station_details

/// The station of a device of that class, whatever the class. A device that commands nothing at the
/// start has a default-constructed command: it is not sent.
template <TakesSamples Backend>
class StationOf final : public Station {
 public:
  using Sample = typename Backend::Sample;

  /// Both are the same emulator as a rule. They must outlive the station.
  StationOf(emulators::Device& device, Backend& backend) : Station(device), backend_(backend) {}

  [[nodiscard]] SimTime next_event() const override {
    return std::min(device().next_event(), inbox_.next());
  }

  [[nodiscard]] SimTime next_wakeup() const override {
    if constexpr (Gathers<Backend>) {
      return std::min(device().next_event(), backend_.packet_complete_at());
    } else {
      return next_event();
    }
  }

  void advance(SimTime now) override {
    while (inbox_.next() <= now) {
      backend_.update(inbox_.take());
    }
    device().advance(now);
  }

  std::size_t take(StationIndex self, const Shelves& samples) override {
    const std::vector<Sample>* shelf = samples.find<Sample>(self);
    if (shelf == nullptr) {
      return 0;
    }
    for (const Sample& sample : *shelf) {
      inbox_.put(sample);
    }
    return shelf->size();
  }

  void collect(StationIndex self, Shelves& requests) override {
    Station::collect(self, requests);
    if constexpr (Commands<Backend>) {
      const typename Backend::Command& command = backend_.command();
      if (command != announced_.command) {
        announced_.command = command;
        requests.of<typename Backend::Command>(self).push_back(command);
      }
    }
  }

 private:
  Backend& backend_;
  SampleInbox<Sample> inbox_;
  [[no_unique_address]] station_details::Announced<Backend> announced_;
};

}  // namespace rigwire::hil
