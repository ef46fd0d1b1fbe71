#include "hil/devices/starfire_line.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "drivers/pty.h"
#include "emulators/starfire/node.h"
#include "emulators/starfire/receiver.h"
#include "emulators/ublox/line_quality.h"
#include "hil/executive/station.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

/// Both sides of the receiver as one device: they share the antenna's samples, each taking the
/// epochs of its own plan. Both plans are multiples of GPS time, one period a multiple of the
/// other.
class BothSides final : public emulators::Device, public emulators::GnssBackend {
 public:
  template <class Side>
  void add(Side& side) {
    sides_.push_back({&side, &side});
  }

  void advance(SimTime now) override {
    for (const Side& side : sides_) {
      side.device->advance(now);
    }
  }
  [[nodiscard]] SimTime next_event() const override {
    SimTime next = kNever;
    for (const Side& side : sides_) {
      next = std::min(next, side.device->next_event());
    }
    return next;
  }
  [[nodiscard]] SamplePlan sample_plan() const override {
    SamplePlan both;
    for (const Side& side : sides_) {
      const SamplePlan plan = side.device->sample_plan();
      if (plan.first != kNever && (both.first == kNever || plan.period < both.period)) {
        both.period = plan.period;
      }
      both.first = std::min(both.first, plan.first);
    }
    return both;
  }
  [[nodiscard]] emulators::ReceiveCounters received() const override {
    emulators::ReceiveCounters sum;
    for (const Side& side : sides_) {
      const emulators::ReceiveCounters one = side.device->received();
      sum.bytes += one.bytes;
      sum.accepted += one.accepted;
      sum.ignored += one.ignored;
      sum.malformed += one.malformed;
    }
    return sum;
  }
  [[nodiscard]] double nominal_rate_hz() const override {
    double sum = 0.0;
    for (const Side& side : sides_) {
      sum += side.device->nominal_rate_hz();
    }
    return sum;
  }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override {
    return sides_.front().device->quantities();
  }
  void update(const GnssSample& sample) override {
    for (FixListener* listener : listeners) {
      listener->observe_fix(sample);
    }
    for (const Side& side : sides_) {
      const SamplePlan plan = side.device->sample_plan();
      if (plan.first <= sample.time && (sample.time - plan.first) % plan.period == Duration{0}) {
        side.backend->update(sample);
      }
    }
  }

  std::vector<FixListener*> listeners;  ///< Hear of every fix.

 private:
  struct Side {
    emulators::Device* device;
    emulators::GnssBackend* backend;
  };
  std::vector<Side> sides_;
};

class StarFireLine final : public GnssLine {
 public:
  StarFireLine(const StarFireConfiguration& configuration, const LineContext& context, CanLine* bus)
      : check_baud_(configuration.check_baud), bus_(bus) {
    if (!configuration.path.empty()) {
      pty_.emplace(context.io, configuration.path, configuration.receiver.baud);
      outlet_.emplace(*pty_, own_statistics());
      quality_.emplace(*outlet_, context.device_seed);
      quality_->set_device_baud(configuration.receiver.baud);
      receiver_.emplace(configuration.receiver, context.calendar, *quality_);
      device_.add(*receiver_);
    }
    if (bus != nullptr) {
      exit_ = &bus->add_node(own_statistics());
      node_.emplace(configuration.receiver, context.calendar, *exit_);
      bus->attach(*exit_, *node_);
      device_.add(*node_);
    }
  }

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    if (pty_) {
      executive.add(*outlet_);
      pty_->on_client([this, &executive](const drivers::LineClient& client) {
        executive.arrive();
        quality_->set_client_baud(seen_baud(check_baud_, client.baud));
      });
      pty_->start([this, &executive](std::span<const std::uint8_t> bytes) {
        receiver_->receive(client_arrived(executive), bytes);
      });
    }
    return index;
  }

  void inform(FixListener& listener) override { device_.listeners.push_back(&listener); }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return pty_ ? pty_->status() : bus_->endpoint();
  }
  [[nodiscard]] std::uint64_t frames() const override {
    return (receiver_ ? receiver_->messages_sent() : 0) + on_bus().sent;
  }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + on_bus().overflowed;
  }
  [[nodiscard]] const emulators::Device& device() const override { return device_; }

 private:
  [[nodiscard]] emulators::CanNodeCounters on_bus() const {
    return exit_ == nullptr ? emulators::CanNodeCounters{} : bus_->bus().counters(*exit_);
  }

  BaudCheck check_baud_;
  CanLine* bus_;
  std::optional<drivers::Pty> pty_;  ///< With what follows: only with a serial line.
  std::optional<StreamOutlet> outlet_;
  std::optional<emulators::UbloxLineQuality> quality_;
  std::optional<emulators::StarFireReceiver> receiver_;
  emulators::FrameOutput* exit_ = nullptr;  ///< With the node: only on a bus.
  std::optional<emulators::StarFireNode> node_;
  BothSides device_;
  GnssStation station_{device_, device_};
};

}  // namespace

std::unique_ptr<GnssLine> make_line(const StarFireConfiguration& configuration,
                                    const LineContext& context, CanLine* bus) {
  return std::make_unique<StarFireLine>(configuration, context, bus);
}

}  // namespace rigwire::hil
