#include "emulators/starfire/node.h"

#include <algorithm>

#include "protocols/vehicle/message.h"

namespace rigwire::emulators {
namespace {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;

constexpr std::array kQuantities{
    within(quantity(vehicle::signal_of(&vehicle::VehiclePosition::latitude_deg)), -90.0, 90.0),
    within(quantity(vehicle::signal_of(&vehicle::VehiclePosition::longitude_deg)), -180.0, 180.0),
    Quantity{"compass bearing", "deg", 0.0, 360.0, 1.0 / 128.0},
    quantity(vehicle::signal_of(&vehicle::VehicleDirectionSpeed::speed_mps), "speed"),
    quantity(vehicle::signal_of(&vehicle::VehicleDirectionSpeed::altitude_m)),
    quantity(vehicle::signal_of(&vehicle::VehiclePosition2::position_dilution), "dilution"),
};

}  // namespace

StarFireNode::StarFireNode(const StarFireSettings& settings, const Calendar& calendar,
                           FrameOutput& output)
    : J1939Device(make_name(settings.name, settings.serial, false), settings.source_address,
                  settings.supply, Duration{0}, output),
      settings_(checked(settings)),
      plan_{calendar.align_to_gps(kStart + settings_.supply.power_on + settings_.start_up,
                                  kStarFirePeriod),
            kStarFirePeriod} {}

void StarFireNode::switched(SimTime now) {
  ready_at_ = supplied() ? now + settings_.start_up : kNever;
  publish_at_ = kNever;
  report_ = {};
  epochs_ = 0;
}

double StarFireNode::nominal_rate_hz() const {
  constexpr double kEachEpoch = 2.0 /*VP, VDS*/ + 1.0 / kQualityEpochs;
  return kEachEpoch / to_seconds(kStarFirePeriod);
}

std::span<const Quantity> StarFireNode::quantities() const {
  return kQuantities;
}

SimTime StarFireNode::next_event() const {
  return std::min(next_node_event(), publish_at_);
}

void StarFireNode::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    advance_node(instant);
    if (publish_at_ == instant) {
      publish_at_ = kNever;
      if (node_.held()) {
        send_group(instant, vehicle::VehiclePosition::kGroup.pgn);
        send_group(instant, vehicle::VehicleDirectionSpeed::kGroup.pgn);
        if (epochs_ % kQualityEpochs == 0) {
          send_group(instant, vehicle::VehiclePosition2::kGroup.pgn);
        }
      }
      ++epochs_;
    }
  }
}

void StarFireNode::update(const GnssSample& sample) {
  advance(sample.time);
  if (sample.time < ready_at_) {
    return;
  }
  report_.take(sample);
  publish_at_ = sample.time + settings_.latency;
  advance(sample.time);
}

J1939Answer StarFireNode::answer_group(SimTime now, std::uint32_t pgn,
                                       std::uint8_t /*destination*/) {
  switch (pgn) {
    case vehicle::VehiclePosition::kGroup.pgn:
      node_.send(now, vehicle::encode(report_.position, address()));
      return J1939Answer::sent;
    case vehicle::VehicleDirectionSpeed::kGroup.pgn:
      node_.send(now, vehicle::encode(report_.direction, address()));
      return J1939Answer::sent;
    case vehicle::VehiclePosition2::kGroup.pgn:
      node_.send(now, vehicle::encode(report_.quality, address()));
      return J1939Answer::sent;
    default:
      return J1939Answer::unknown;
  }
}

void StarFireNode::send_group(SimTime now, std::uint32_t pgn) {
  (void)answer_group(now, pgn, j1939::kGlobalAddress);
}

J1939Reception StarFireNode::obey(SimTime /*now*/, const J1939Message& /*message*/) {
  return J1939Reception::ignored;
}

std::vector<protocols::can::OwnedMessage> StarFireNode::messages(std::string_view name) const {
  const vehicle::LayoutEnds sent{name, node_.address(), j1939::kGlobalAddress};
  const auto every = [](vehicle::Group group, Duration period) {
    group.period = std::chrono::duration_cast<std::chrono::milliseconds>(period);
    return group;
  };
  using vehicle::VehicleDirectionSpeed;
  using vehicle::VehiclePosition;
  return {vehicle::layout<VehiclePosition>(sent, every(VehiclePosition::kGroup, kStarFirePeriod)),
          vehicle::layout<VehicleDirectionSpeed>(
              sent, every(VehicleDirectionSpeed::kGroup, kStarFirePeriod)),
          vehicle::layout<vehicle::VehiclePosition2>(sent)};
}

}  // namespace rigwire::emulators
