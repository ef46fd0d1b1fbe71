// What goes wrong with a node of a CAN bus, whatever it is: its frames, its program, what it
// measures, and what its type has besides.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "emulators/firmware_fault.h"
#include "emulators/frame_fault.h"
#include "emulators/sample_fault.h"
#include "hil/configuration/fault_window.h"

namespace rigwire::hil {

/// Sample type of a node whose samples have no faults.
struct NoSample {};

template <class Sample, class... Own>
struct NodeFaultOf {
  using Type = MixedFault<Own..., emulators::FrameFault>;
};
template <emulators::HasQuantities Sample, class... Own>
struct NodeFaultOf<Sample, Own...> {
  using Type = MixedFault<Own..., emulators::FrameFault, emulators::SampleFault<Sample>>;
};
/// A fault of a node that takes such samples; `Own` are those of its type.
template <class Sample, class... Own>
using NodeFault = typename NodeFaultOf<Sample, Own...>::Type;

/// Faults of a node's frames and of its firmware.
struct AnyNodeFaults {
  std::vector<emulators::FrameFault> frames;
  std::vector<emulators::PaceFault> pace;        ///< For an emulator with pace().
  std::vector<emulators::RefusalFault> refusal;  ///< For an emulator with refusal().
};
/// Faults of a node, those of its samples included.
template <class Sample>
struct NodeFaults : AnyNodeFaults {};
template <emulators::HasQuantities Sample>
struct NodeFaults<Sample> : AnyNodeFaults {
  std::vector<emulators::SampleFault<Sample>> samples;
  bool of_samples = true;  ///< Whether the node's samples can have faults.
};
/// Applies the faults of a node's samples.
template <class Sample>
class NodeSamples {
 public:
  NodeSamples(const NodeFaults<Sample>& /*faults*/, std::uint64_t /*seed*/) {}
  void lay_over(Sample& /*sample*/) {}
};
template <emulators::HasQuantities Sample>
class NodeSamples<Sample> : public emulators::FaultySamples<Sample> {
 public:
  NodeSamples(const NodeFaults<Sample>& faults, std::uint64_t seed)
      : emulators::FaultySamples<Sample>(faults.samples, seed) {}
};

template <class Sample, class Mixed>
[[nodiscard]] NodeFaults<Sample> node_faults(const std::vector<Mixed>& list) {
  NodeFaults<Sample> faults;
  faults.frames = those_of<emulators::FrameFault>(list);
  faults.pace = those_of<emulators::PaceFault>(list);
  faults.refusal = those_of<emulators::RefusalFault>(list);
  if constexpr (requires { faults.samples; }) {
    using Measured = emulators::SampleFault<Sample>;
    faults.samples = those_of<Measured>(list);
    faults.of_samples = kIsAlternative<emulators::StuckFault<Sample>, decltype(Mixed::what)>;
  }
  return faults;
}

}  // namespace rigwire::hil
