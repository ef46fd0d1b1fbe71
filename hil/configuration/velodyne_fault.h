// Faults of a Velodyne lidar: a list in its device's section, each fault with its own keys.
//
//   faults:
//     - {type: lost_packets, at: 10 s, for: 5 s, probability: 1 %}
//     - {type: dirty_window, at: 20 s, for: 60 s, from: 40 deg, to: 60 deg, transmission: 20 %}
//
// They are of the sensor and its cable (emulators/velodyne/velodyne_fault.h); what is in the air is
// the scene's.
#pragma once

#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/velodyne/velodyne_fault.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

struct LostPacketsFault {
  double probability = 0.01;
};
struct SwappedPacketsFault {
  double probability = 0.01;
};
struct DuplicatedPacketsFault {
  double probability = 0.01;
};
struct DeadLaserFault {
  int first = 0;
  int last = 0;
};
struct DirtyWindowFault {
  double from_deg = 0.0;
  double to_deg = 10.0;
  double transmission = 0.5;
};
struct MotorStallFault {};
struct PulseLossFault {};
struct PulseNoiseFault {};
struct SentenceLossFault {};
struct ClockOffsetFault {
  double offset_s = 1.0;
};
struct HourOverrunFault {
  double overrun_s = 0.05;
};
struct FactoryBytesFault {
  std::uint8_t return_mode = 0;
  std::uint8_t product = 0;
};

using VelodyneFaultSettings =
    std::variant<LostPacketsFault, SwappedPacketsFault, DuplicatedPacketsFault, DeadLaserFault,
                 DirtyWindowFault, MotorStallFault, PulseLossFault, PulseNoiseFault,
                 SentenceLossFault, ClockOffsetFault, HourOverrunFault, FactoryBytesFault>;

/// The names of the `type` key, in the order of VelodyneFaultSettings.
inline constexpr std::array<Alternative, 12> kVelodyneFaultTypes{
    {{"lost_packets", "Packets are lost on the way."},
     {"swapped_packets", "Data packets change places with their successors."},
     {"duplicated_packets", "Packets arrive twice."},
     {"dead_laser", "Some lasers see nothing."},
     {"dirty_window", "Dirt on a sector of the window."},
     {"motor_stall", "The rotor runs down."},
     {"pulse_loss", "No pulse per second arrives."},
     {"pulse_noise", "Pulses at wrong times between the right ones."},
     {"sentence_loss", "No sentence arrives."},
     {"clock_offset", "Timestamps are off."},
     {"hour_overrun", "The timestamp passes 3600 s before it wraps."},
     {"factory_bytes", "The last two bytes of data packets are wrong."}}};

struct VelodyneFaultConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
  VelodyneFaultSettings settings;

  [[nodiscard]] std::string_view type() const { return kVelodyneFaultTypes[settings.index()].name; }
};

[[nodiscard]] std::vector<emulators::VelodyneFault> velodyne_faults(
    const std::vector<VelodyneFaultConfiguration>& faults);

namespace detail {
template <class Visitor>
void visit_probability(Visitor& v, double& probability) {
  v.number("probability", probability, in("%").above(0).at_most(100), "Of each packet.");
}
}  // namespace detail

template <class Visitor>
void visit(Visitor& v, LostPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
template <class Visitor>
void visit(Visitor& v, SwappedPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
template <class Visitor>
void visit(Visitor& v, DuplicatedPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
template <class Visitor>
void visit(Visitor& v, DeadLaserFault& p) {
  v.integer("first", p.first, IntegerRule{0, 127}, "By the model's numbers, which count from 0.");
  v.integer("last", p.last, IntegerRule{0, 127}, "Included.");
}
template <class Visitor>
void visit(Visitor& v, DirtyWindowFault& p) {
  v.number("from", p.from_deg, in("deg").stored_as("deg").between(0, 360), "Azimuth, clockwise.");
  v.number("to", p.to_deg, in("deg").stored_as("deg").between(0, 360), "May lie beyond 0.");
  v.number("transmission", p.transmission, in("%").between(0, 100), "Of the light, one way.");
}
template <class Visitor>
void visit(Visitor&, MotorStallFault&) {}
template <class Visitor>
void visit(Visitor&, PulseLossFault&) {}
template <class Visitor>
void visit(Visitor&, PulseNoiseFault&) {}
template <class Visitor>
void visit(Visitor&, SentenceLossFault&) {}
template <class Visitor>
void visit(Visitor& v, ClockOffsetFault& p) {
  v.number("offset", p.offset_s, in("s").between(-3600, 3600), "Of the timestamps; not 0.");
}
template <class Visitor>
void visit(Visitor& v, HourOverrunFault& p) {
  v.number("overrun", p.overrun_s, in("s").above(0).at_most(1), "Beyond the hour.");
}
template <class Visitor>
void visit(Visitor& v, FactoryBytesFault& p) {
  v.integer("return_mode", p.return_mode, IntegerRule{0, 255}, "Instead of the return mode.");
  v.integer("product", p.product, IntegerRule{0, 255}, "Instead of the product's number.");
}

template <class Visitor>
void visit(Visitor& v, VelodyneFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, 31'536'000'000'000'000}, "From the start of the run.");
  v.duration("for", p.length, {1'000'000, 31'536'000'000'000'000}, "How long it lasts.");
  v.required("type");
  v.variant("type", p.settings, kVelodyneFaultTypes, "What happens.");
}

}  // namespace rigwire::hil
