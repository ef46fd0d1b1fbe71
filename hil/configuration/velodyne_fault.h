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
#include "fields/visitor.h"

namespace rigwire::hil {

struct LostPacketsFault {
  static constexpr fields::Named kNamed{"lost_packets", "Packets are lost on the way."};

  double probability = 0.01;
};
struct SwappedPacketsFault {
  static constexpr fields::Named kNamed{"swapped_packets",
                                        "Data packets change places with their successors."};

  double probability = 0.01;
};
struct DuplicatedPacketsFault {
  static constexpr fields::Named kNamed{"duplicated_packets", "Packets arrive twice."};

  double probability = 0.01;
};
struct DeadLaserFault {
  static constexpr fields::Named kNamed{"dead_laser", "Some lasers see nothing."};

  int first = 0;
  int last = 0;
};
struct DirtyWindowFault {
  static constexpr fields::Named kNamed{"dirty_window", "Dirt on a sector of the window."};

  double from_deg = 0.0;
  double to_deg = 10.0;
  double transmission = 0.5;
};
struct MotorStallFault {
  static constexpr fields::Named kNamed{"motor_stall", "The rotor runs down."};
};
struct PulseLossFault {
  static constexpr fields::Named kNamed{"pulse_loss", "No pulse per second arrives."};
};
struct PulseNoiseFault {
  static constexpr fields::Named kNamed{"pulse_noise",
                                        "Pulses at wrong times between the right ones."};
};
struct SentenceLossFault {
  static constexpr fields::Named kNamed{"sentence_loss", "No sentence arrives."};
};
struct ClockOffsetFault {
  static constexpr fields::Named kNamed{"clock_offset", "Timestamps are off."};

  double offset_s = 1.0;
};
struct HourOverrunFault {
  static constexpr fields::Named kNamed{"hour_overrun",
                                        "The timestamp passes 3600 s before it wraps."};

  double overrun_s = 0.05;
};
struct FactoryBytesFault {
  static constexpr fields::Named kNamed{"factory_bytes",
                                        "The last two bytes of data packets are wrong."};

  std::uint8_t return_mode = 0;
  std::uint8_t product = 0;
};

using VelodyneFaultSettings =
    std::variant<LostPacketsFault, SwappedPacketsFault, DuplicatedPacketsFault, DeadLaserFault,
                 DirtyWindowFault, MotorStallFault, PulseLossFault, PulseNoiseFault,
                 SentenceLossFault, ClockOffsetFault, HourOverrunFault, FactoryBytesFault>;

struct VelodyneFaultConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
  VelodyneFaultSettings settings;

  [[nodiscard]] std::string_view type() const { return fields::chosen_name(settings); }
};

[[nodiscard]] std::vector<emulators::VelodyneFault> velodyne_faults(
    const std::vector<VelodyneFaultConfiguration>& faults);

namespace detail {
inline void visit_probability(fields::Visitor& v, double& probability) {
  v.number("probability", probability, fields::in("%").above(0).at_most(100),
           "Probability with which it happens to each packet.");
}
}  // namespace detail

inline void visit(fields::Visitor& v, LostPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
inline void visit(fields::Visitor& v, SwappedPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
inline void visit(fields::Visitor& v, DuplicatedPacketsFault& p) {
  detail::visit_probability(v, p.probability);
}
inline void visit(fields::Visitor& v, DeadLaserFault& p) {
  v.integer("first", p.first, fields::IntegerRule{0, 127},
            "First laser that sees nothing, by the model's numbers, which count from 0.");
  v.integer("last", p.last, fields::IntegerRule{0, 127}, "Last laser that sees nothing, included.");
}
inline void visit(fields::Visitor& v, DirtyWindowFault& p) {
  v.number("from", p.from_deg, fields::in("deg").stored_as("deg").between(0, 360),
           "Azimuth at which the dirt begins, clockwise.");
  v.number("to", p.to_deg, fields::in("deg").stored_as("deg").between(0, 360),
           "Azimuth at which the dirt ends; may lie beyond 0.");
  v.number("transmission", p.transmission, fields::in("%").between(0, 100),
           "Share of the light that passes the dirt, one way.");
}
inline void visit(fields::Visitor&, MotorStallFault&) {}
inline void visit(fields::Visitor&, PulseLossFault&) {}
inline void visit(fields::Visitor&, PulseNoiseFault&) {}
inline void visit(fields::Visitor&, SentenceLossFault&) {}
inline void visit(fields::Visitor& v, ClockOffsetFault& p) {
  v.number("offset", p.offset_s, fields::in("s").between(-3600, 3600),
           "How far the timestamps are off; not 0.");
}
inline void visit(fields::Visitor& v, HourOverrunFault& p) {
  v.number("overrun", p.overrun_s, fields::in("s").above(0).at_most(1),
           "How far the timestamp passes the hour.");
}
inline void visit(fields::Visitor& v, FactoryBytesFault& p) {
  v.integer("return_mode", p.return_mode, fields::IntegerRule{0, 255},
            "Byte in place of the return mode.");
  v.integer("product", p.product, fields::IntegerRule{0, 255},
            "Byte in place of the product's number.");
}

inline void visit(fields::Visitor& v, VelodyneFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
  v.duration("for", p.length, {1'000'000, fields::kYear_ns}, "How long the fault lasts.");
  v.required("type");
  v.variant("type", p.settings, "Which fault it is.");
}

}  // namespace rigwire::hil
