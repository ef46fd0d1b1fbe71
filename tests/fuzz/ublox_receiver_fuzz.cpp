// An emulated receiver fed arbitrary bytes in arbitrary pieces: what it puts out is always whole
// sentences and frames, in chunks that a UART can carry, at times that never go back. The first
// byte chooses whether the client changes its speed and the supply is switched, too.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "emulators/ublox/receiver.h"
#include "protocols/nmea/sentence.h"
#include "protocols/ubx/frame.h"
#include "supply_switch.h"

namespace {

using namespace std::chrono_literals;
using namespace rigwire;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

class Line final : public emulators::ByteOutput {
 public:
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    require(due >= last_due_ && !bytes.empty() && bytes.size() <= 8);
    last_due_ = due;
    all_.insert(all_.end(), bytes.begin(), bytes.end());
  }
  /// Only a reset may cut a message; it is followed by the next one's start.
  void check(bool resets) const {
    for (std::size_t at = 0; at < all_.size();) {
      const auto rest = std::span(all_).subspan(at);
      if (const auto frame = protocols::ubx::decode_frame(rest); frame.ok()) {
        at += frame.consumed();
      } else if (const auto line = protocols::nmea::decode_sentence(rest); line.ok()) {
        at += line.consumed();
      } else {
        require(resets);
        ++at;
      }
    }
  }

 private:
  SimTime last_due_{};
  std::vector<std::uint8_t> all_;
};

GnssSample sample_at(SimTime time) {
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = 49.0;
  sample.longitude_deg = 8.0;
  sample.horizontal_dilution = sample.vertical_dilution = sample.position_dilution = 1.0;
  sample.horizontal_accuracy_m = 2.0;
  for (std::uint8_t prn = 1; prn <= 5; ++prn) {
    sample.satellites.push_back({prn, 1.0, 1.0, 40.0, true, true});
  }
  return sample;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  Line line;
  emulators::UbloxReceiver receiver(emulators::UbloxSettings{}, calendar, line);
  receiver.advance(kStart + 1s);
  std::span<const std::uint8_t> rest(data, size);
  const std::uint8_t choices = size > 0 ? data[0] : 0;
  const bool changes_speed = (choices & 0x40U) != 0;
  const bool switches = (choices & 0x80U) != 0;
  SimTime now = kStart + 1s;
  for (int step = 0; !rest.empty() && step < 64; ++step) {
    const std::size_t piece = step == 63 ? rest.size() : rest[0] % 64 + std::size_t{1};
    const std::size_t taken = piece < rest.size() ? piece : rest.size();
    if (changes_speed) {
      constexpr std::uint32_t kSpeeds[]{0, 4800, 9600, 115200};
      receiver.set_client(now, {rest[0] % 2 == 0, kSpeeds[rest[0] / 2 % 4]});
    }
    if (switches) {
      test::switch_supply(receiver, now, rest[0] % 8 != 0);
      receiver.external_interrupt(now, rest[0] % 2 == 0);
    }
    receiver.receive(now, rest.first(taken));
    rest = rest.subspan(taken);
    const SimTime sample = receiver.sample_plan().next_after(now);
    if (sample != kNever && step % 4 == 0 && sample < now + 70s) {
      receiver.update(sample_at(sample));
      now = sample;
    } else {
      now += 20ms;
      receiver.advance(now);
    }
  }
  require(receiver.received().bytes <= size);
  now += 200s;
  receiver.advance(now);
  require(receiver.next_event() > now);
  line.check(receiver.counters().resets > 0 || changes_speed || switches);
  return 0;
}
