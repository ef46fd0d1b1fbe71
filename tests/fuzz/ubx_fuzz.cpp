// UBX frames and messages from arbitrary bytes: what decodes encodes to the same bytes again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/information.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/signal_security.h"
#include "protocols/ubx/timing.h"
#include "protocols/ubx/version.h"

namespace {

using namespace rigwire::protocols::ubx;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Decode, encode, decode, encode: the second bytes equal the first (reserved bytes may differ from
/// the input's). Bytes, not messages: a float that is not a number equals nothing.
template <class Message>
void round_trip(const FrameView& frame) {
  const auto message = decode<Message>(frame);
  if (message.ok()) {
    const auto once = encode(*message);
    const auto reread = decode_frame(once);
    require(reread.ok() && reread->id == frame.id);
    require(encode(*decode<Message>(*reread)) == once);
  }
}

template <class... Messages>
void round_trips(const FrameView& frame) {
  (round_trip<Messages>(frame), ...);
}

template <class Head, class Block>
std::vector<std::uint8_t> encoded(const Blocks<Head, Block>& message) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < message.size(); ++i) {
    blocks.push_back(message[i]);
  }
  std::vector<std::uint8_t> bytes(frame_size<Head, Block>(blocks.size()));
  require(encode_blocks(message.head(), std::span<const Block>(blocks), std::span(bytes)) ==
          bytes.size());
  return bytes;
}

template <class Head, class Block>
void block_round_trip(const FrameView& frame) {
  const auto message = decode_blocks<Head, Block>(frame);
  if (message.ok()) {
    const auto once = encoded(*message);
    const auto reread = decode_frame(once);
    require(reread.ok() && reread->payload.size() == frame.payload.size());
    require(encoded(*decode_blocks<Head, Block>(*reread)) == once);
  }
}

void every_message(const FrameView& frame) {
  round_trips<NavPosecef, NavPosllh, NavStatus, NavDop, NavSol, NavPvt, NavPvt92, NavVelecef,
              NavVelned, NavTimegps, NavTimeutc, NavClock, NavTimels, NavEoe, NavAopstatus,
              NavHpposecef, NavHpposllh, NavCov, NavRelposned, NavTimeglo, NavTimebds, NavTimegal,
              NavOdo, NavSvin>(frame);
  round_trips<MonHw, MonHw2, MonMsgpp, MonRxbuf, MonTxbuf, MonRxr, TimTp, TimTm2, RxmSfrb, AidIni,
              AidHui, AidAlmHead, AidAlm, AidEphHead, AidEph, AckAck, AckNak, MonGnss, MonPatchHead,
              SecUniqid, LogInfo, RxmRtcm>(frame);
  round_trips<CfgPrt, CfgMsg, CfgInf, CfgRst, CfgRate, CfgCfg, CfgRxm, CfgAnt, CfgSbas, CfgNmea,
              CfgNavx5, CfgNav5, CfgTp5, CfgDat, CfgPm2, CfgUsb, CfgOdo, CfgPms>(frame);
  block_round_trip<NavSvinfoHead, NavSvinfoChannel>(frame);
  block_round_trip<NavSatHead, NavSatBlock>(frame);
  block_round_trip<NavSigHead, NavSigBlock>(frame);
  block_round_trip<NavOrbHead, NavOrbBlock>(frame);
  block_round_trip<NavDgpsHead, NavDgpsBlock>(frame);
  block_round_trip<NavSbasHead, NavSbasBlock>(frame);
  block_round_trip<MonIoHead, MonIoPort>(frame);
  block_round_trip<MonRfHead, MonRfBlock>(frame);
  block_round_trip<MonCommsHead, MonCommsPort>(frame);
  block_round_trip<SecSigHead, SecSigBlock>(frame);
  block_round_trip<SecSiglogHead, SecSiglogEvent>(frame);
  block_round_trip<RxmRawHead, RxmRawBlock>(frame);
  block_round_trip<RxmSfrbxHead, RxmSfrbxWord>(frame);
  block_round_trip<RxmRawxHead, RxmRawxBlock>(frame);
  block_round_trip<RxmSvsiHead, RxmSvsiBlock>(frame);
  block_round_trip<CfgGnssHead, CfgGnssBlock>(frame);
  if (const auto text = decode_information(frame); text.ok()) {
    std::vector<std::uint8_t> bytes(kOverheadBytes + frame.payload.size());
    require(encode_information(*text, bytes) == bytes.size());
    require(*decode_information(*decode_frame(bytes)) == *text);
  }
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
    every_message(*frame);
    if (const auto version = decode_version(*frame); version.ok()) {
      require(decode_version({frame->id, version_payload(*version)}).ok());
    }
    at += frame.consumed();
  }
  return 0;
}
