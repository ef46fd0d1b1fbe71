// What goes wrong with a node of a CAN bus, whatever it is: its frames, what it measures, and what
// its type has besides.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "emulators/frame_fault.h"
#include "emulators/sample_fault.h"
#include "hil/configuration/fault_window.h"

namespace rigwire::hil {

/// Of a node whose samples no fault can be of.
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

/// Those of its frames and of what it measures.
template <class Sample>
struct NodeFaults {
  std::vector<emulators::FrameFault> frames;
};
template <emulators::HasQuantities Sample>
struct NodeFaults<Sample> {
  std::vector<emulators::FrameFault> frames;
  std::vector<emulators::SampleFault<Sample>> samples;
  bool of_samples = true;  ///< Whether there can be such.
};
/// Acts out those of what it measures.
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
  if constexpr (requires { faults.samples; }) {
    using Measured = emulators::SampleFault<Sample>;
    faults.samples = those_of<Measured>(list);
    faults.of_samples = kIsAlternative<emulators::StuckFault<Sample>, decltype(Mixed::what)>;
  }
  return faults;
}

}  // namespace rigwire::hil
