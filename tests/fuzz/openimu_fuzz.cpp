// A device fed with any frames between its ticks: never more than one answer per frame, never a
// data message that its own decoder refuses, and every frame is counted once.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/openimu/openimu335ri.h"
#include "frame_output.h"
#include "protocols/bytes.h"
#include "protocols/openimu/messages.h"

namespace emulators = rigwire::emulators;
namespace openimu = rigwire::protocols::openimu;
using rigwire::protocols::can::Frame;

using rigwire::fuzz::Output;
using rigwire::fuzz::require;

namespace {}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 4 + 1 + 1 + 8;  // identifier, format, length, data
  Output output;
  emulators::OpenImu imu({}, output);
  rigwire::SimTime now = rigwire::kStart;
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord, now += emulators::OpenImu::kTick) {
    imu.update({now, {0.0, 0.0, 9.81}, {}, 25.0});
    Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
    frame.extended = (data[4] & 1U) != 0;
    frame.remote = (data[4] & 2U) != 0;
    frame.length = data[5];
    std::copy_n(data + 6, frame.data.size(), frame.data.begin());
    const std::uint64_t before = output.count;
    imu.receive(now, frame);
    require(output.count <= before + 1);
    ++fed;
    (void)openimu::decode<openimu::Slope>(frame);
    (void)openimu::decode<openimu::AngularRate>(frame);
    (void)openimu::decode<openimu::Acceleration>(frame);
    (void)openimu::decode_setting(frame);
  }
  const auto counters = imu.received();
  require(counters.accepted + counters.ignored + counters.malformed == fed);
  return 0;
}
