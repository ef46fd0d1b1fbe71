#include "emulators/frame_fault.h"

#include <algorithm>

namespace rigwire::emulators {

using protocols::can::Frame;

void visit(fields::Visitor& v, ShareOfFrames& p) {
  v.number("share", p.share, fields::in("%").above(0).at_most(100),
           "Share of the frames that are affected, drawn for each frame.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, DelayedFramesFault& p) {
  v.duration("delay", p.delay, {1, 60'000'000'000}, "By which frames leave later.");
  visit_ramp(v, p.ramp);
}

template <class Fault>
bool FaultyFrames::happens(SimTime now) {
  const auto fault = faults_.first_grown<Fault>(now);
  return fault && (fault->share >= 1.0 || random_.uniform() < fault->share);
}

void FaultyFrames::freeze(SimTime now, Frame& frame) {
  SimTime since = kNever;
  faults_.each(now, [&](const FrameFault& fault) {
    if (std::holds_alternative<FrozenFramesFault>(fault.what)) {
      since = std::min(since, fault.when.began(now));
    }
  });
  if (since != frozen_since_) {
    frozen_since_ = since;
    frozen_.clear();
  }
  if (since == kNever) {
    return;
  }
  const auto same = [&](const Frame& other) {
    return other.id == frame.id && other.extended == frame.extended;
  };
  const auto held = std::ranges::find_if(frozen_, same);
  if (held == frozen_.end()) {
    frozen_.push_back(frame);
  } else {
    frame = *held;
  }
}

void FaultyFrames::send(SimTime due, const Frame& frame) {
  if (faults_.empty()) {
    output_.send(due, frame);
    return;
  }
  if (happens<LostFramesFault>(due)) {
    return;
  }
  Frame sent = frame;
  freeze(due, sent);
  if (!sent.remote && sent.length > 0 && happens<CorruptedFramesFault>(due)) {
    const std::uint32_t bit = random_.below(std::uint32_t{sent.length} * 8U);
    sent.data[bit / 8] = static_cast<std::uint8_t>(sent.data[bit / 8] ^ 1U << bit % 8);
  }
  const auto late = faults_.first_grown<DelayedFramesFault>(due);
  const bool twice = happens<RepeatedFramesFault>(due);
  last_due_ = std::max(last_due_, late ? due + late->delay : due);
  output_.send(last_due_, sent);
  if (twice) {
    output_.send(last_due_, sent);
  }
}

}  // namespace rigwire::emulators
