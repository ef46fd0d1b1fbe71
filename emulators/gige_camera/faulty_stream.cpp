#include "emulators/gige_camera/faulty_stream.h"

namespace rigwire::emulators {

FaultyStream::FaultyStream(DatagramOutput& output, const GigeCameraFaults& faults,
                           std::uint64_t seed, std::size_t longest)
    : output_(output), faults_(faults), random_(seed) {
  held_.reserve(longest);
}

template <class Fault>
bool FaultyStream::happens(SimTime now) {
  const auto fault = faults_.first_grown<Fault>(now);
  return fault && random_.uniform() < fault->share;
}

void FaultyStream::send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
                        bool do_not_fragment) {
  if (faults_.empty() && held_.empty()) {
    output_.send(due, to, bytes, do_not_fragment);
    return;
  }
  if (faults_.first<LinkDownFault>(due) != nullptr || happens<LostStreamPacketsFault>(due)) {
    ++lost_;
    return;
  }
  if (held_.empty() && happens<SwappedStreamPacketsFault>(due)) {
    held_.assign(bytes.begin(), bytes.end());
    held_to_ = to;
    return;
  }
  output_.send(due, to, bytes, do_not_fragment);
  if (happens<DuplicatedStreamPacketsFault>(due)) {
    output_.send(due, to, bytes, do_not_fragment);
  }
  if (!held_.empty()) {
    output_.send(due, held_to_, held_, do_not_fragment);
    held_.clear();
  }
}

}  // namespace rigwire::emulators
