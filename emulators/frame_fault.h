// What goes wrong with the frames that a node sends, between its firmware and its controller: the
// bus carries what comes out of it well, with a right CRC.
//
//   faults:
//     - {type: lost, at: 10 s, for: 5 s, share: 20 %}
//     - {type: delayed, at: 20 s, for: 5 s, delay: 80 ms}
//
// What it receives reaches it. Where several of a kind hold at once, the first counts.
#pragma once

#include <variant>
#include <vector>

#include "emulators/device.h"
#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

/// Share of the frames that are affected, drawn for each frame independently.
struct ShareOfFrames {
  double share = 1.0;
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
void visit(fields::Visitor& v, ShareOfFrames& p);

struct LostFramesFault : ShareOfFrames {
  static constexpr fields::Named kNamed{"lost", "Frames of the node are lost."};
};
struct RepeatedFramesFault : ShareOfFrames {
  static constexpr fields::Named kNamed{"repeated", "Frames of the node are sent twice."};
};
struct CorruptedFramesFault : ShareOfFrames {
  static constexpr fields::Named kNamed{
      "corrupted", "A data bit of frames is turned over in the node's memory."};
};
struct DelayedFramesFault {
  static constexpr fields::Named kNamed{"delayed",
                                        "Frames of the node leave later, in their order."};

  Duration delay = std::chrono::milliseconds{100};
  Duration ramp{0};

  void grow(double share) { delay = from_seconds(share * to_seconds(delay)); }
};
struct FrozenFramesFault {
  static constexpr fields::Named kNamed{
      "frozen", "The node repeats what it last sent under each identifier."};
};
void visit(fields::Visitor& v, DelayedFramesFault& p);
inline void visit(fields::Visitor&, FrozenFramesFault&) {}

struct FrameFault {
  FaultPeriod when;
  std::variant<LostFramesFault, RepeatedFramesFault, DelayedFramesFault, CorruptedFramesFault,
               FrozenFramesFault>
      what;
};
inline void visit(fields::Visitor& v, FrameFault& p) {
  visit_fault(v, p);
}

class FaultyFrames final : public FrameOutput {
 public:
  /// `output` must outlive it.
  FaultyFrames(std::vector<FrameFault> faults, std::uint64_t seed, FrameOutput& output)
      : output_(output), faults_(std::move(faults)), random_(seed) {}

  void send(SimTime due, const protocols::can::Frame& frame) override;

  FaultBook<FrameFault>::Id begin(const FrameFault& fault) { return faults_.add(fault); }
  /// Ends a fault from `now` on. Returns false if there is none of that number or it is over.
  bool end(FaultBook<FrameFault>::Id id, SimTime now) { return faults_.end(id, now); }

 private:
  template <class Fault>
  [[nodiscard]] bool happens(SimTime now);
  void freeze(SimTime now, protocols::can::Frame& frame);

  FrameOutput& output_;
  FaultBook<FrameFault> faults_;
  RandomBits random_;
  SimTime last_due_ = kStart;
  SimTime frozen_since_ = kNever;
  std::vector<protocols::can::Frame> frozen_;  ///< The first of each identifier since then.
};

}  // namespace rigwire::emulators
