// What the tests of suites on CAN have in common: a device with one thing wrong in what it says or
// takes, and the changes of frames that make it so.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "emulated_node.h"

namespace rigwire::conform {

template <class Device>
struct NodeMutant {
  const char* name;
  const char* found_by;  ///< The case that is for it, or its chapter.
  EmulatedNode::Change saying = {};
  EmulatedNode::Change hearing = {};
  std::function<void(Device&)> fault = {};
};
template <class Device>
void PrintTo(const NodeMutant<Device>& mutant, std::ostream* out) {
  *out << mutant.name;
}

using OfFrame = std::function<bool(const EmulatedNode::Frame&)>;

/// Frames for which it holds get changed.
inline EmulatedNode::Change changing(const OfFrame& which,
                                     const std::function<void(EmulatedNode::Frame&)>& change) {
  return [=](const EmulatedNode::Frame& frame) {
    EmulatedNode::Frame other = frame;
    if (which(frame)) {
      change(other);
    }
    return std::vector{other};
  };
}
/// Frames for which it holds are lost.
inline EmulatedNode::Change without(const OfFrame& which) {
  return [=](const EmulatedNode::Frame& frame) {
    return which(frame) ? std::vector<EmulatedNode::Frame>() : std::vector{frame};
  };
}
/// Every second of those for which it holds.
inline OfFrame every_second(const OfFrame& which) {
  return [=, odd = std::make_shared<bool>(false)](const EmulatedNode::Frame& frame) {
    const bool one = which(frame);
    *odd = one != *odd;
    return one && *odd;
  };
}

/// The parameter group of a frame of J1939.
inline std::uint32_t group_of(const EmulatedNode::Frame& frame) {
  const std::uint32_t pgn = frame.id >> 8U & 0x3FFFFU;
  return (pgn >> 8U & 0xFFU) < 240U ? pgn & 0x3FF00U : pgn;
}
inline OfFrame is_group(std::uint32_t pgn) {
  return
      [pgn](const EmulatedNode::Frame& frame) { return frame.extended && group_of(frame) == pgn; };
}
inline OfFrame is_group(std::uint32_t pgn, const OfFrame& and_so) {
  return [=](const EmulatedNode::Frame& frame) {
    return frame.extended && group_of(frame) == pgn && and_so(frame);
  };
}
inline EmulatedNode::Change of_group(std::uint32_t pgn,
                                     const std::function<void(EmulatedNode::Frame&)>& change) {
  return changing(is_group(pgn), change);
}

}  // namespace rigwire::conform
