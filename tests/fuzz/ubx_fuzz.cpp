// UBX frames and messages from arbitrary bytes: what decodes encodes to the same bytes again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "protocols/ubx/configuration.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/version.h"

namespace {

using namespace rigwire::protocols::ubx;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Decode, encode, decode: the second message equals the first (reserved bytes may differ).
template <class Message>
void round_trip(const FrameView& frame) {
  const auto message = decode<Message>(frame);
  if (message.ok()) {
    const auto again = encode(*message);
    const auto reread = decode_frame(again);
    require(reread.ok() && reread->id == frame.id);
    require(*decode<Message>(*reread) == *message);
  }
}

template <class... Messages>
void round_trips(const FrameView& frame) {
  (round_trip<Messages>(frame), ...);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> all(data, size);
  std::size_t at = 0;
  while (at < size) {
    const auto rest = all.subspan(at);
    const auto frame = decode_frame(rest);
    if (frame.incomplete()) {
      require(frame.shortage().had == rest.size() && frame.shortage().needed > rest.size());
    }
    if (!frame.ok()) {
      const std::size_t next = find_sync(all, at + 1);
      require(next > at && next <= size);
      at = next;
      continue;
    }
    require(frame.consumed() == kOverheadBytes + frame->payload.size());
    require(frame.consumed() <= rest.size());
    std::vector<std::uint8_t> again(frame.consumed());
    require(encode_frame(frame->id, frame->payload, again) == again.size());
    require(std::ranges::equal(again, rest.first(again.size())));
    round_trips<NavPosecef, NavPosllh, NavStatus, NavDop, NavSol, NavPvt, NavVelecef, NavVelned,
                NavTimegps, NavTimeutc, NavClock, MonHw, AckAck, AckNak, CfgPrt, CfgMsg, CfgInf,
                CfgRst, CfgRate, CfgCfg, CfgRxm, CfgAnt, CfgSbas, CfgNmea, CfgNavx5, CfgNav5,
                CfgTp5>(*frame);
    if (const auto version = decode_version(*frame); version.ok()) {
      require(decode_version({frame->id, version_payload(*version)}).ok());
    }
    at += frame.consumed();
  }
  return 0;
}
