#include "emulators/velodyne/packet_assembly.h"

#include <algorithm>
#include <cassert>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::Block;
using velodyne::BlockEcho;
using velodyne::Channel;
using velodyne::ReturnMode;

constexpr std::uint32_t kDistance = 0xFFFF;

/// Chooses without branches; the masks are all ones or all zeros.
constexpr std::uint32_t mask(bool condition) {
  return 0U - static_cast<std::uint32_t>(condition);
}
constexpr std::uint32_t choose(std::uint32_t which, std::uint32_t yes, std::uint32_t no) {
  return (yes & which) | (no & ~which);
}

/// Makes of the three echoes of each shot the two that are reported.
void pair_up(EncodedReturns& strongest, EncodedReturns& last, const EncodedReturns& second) {
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    const std::uint32_t farthest = choose(mask(last[i] == 0), strongest[i], last[i]);
    const std::uint32_t best = choose(mask(strongest[i] == 0), farthest, strongest[i]);
    const bool repeated = (best & kDistance) == (farthest & kDistance);
    const std::uint32_t other = choose(mask(second[i] == 0), farthest, second[i]);
    last[i] = farthest;
    strongest[i] = choose(mask(repeated), other, best);
  }
}

void store(const EncodedReturns& echoes, std::size_t count, Channel* channels) {
  for (std::size_t i = 0; i < count; ++i) {
    channels[i] = channel_of(echoes[i]);
  }
}

}  // namespace

PacketAssembly::PacketAssembly(const velodyne::Model& model, const ReturnEncoder& encode)
    : model_(model), encode_(encode) {
  begin(mode_);
}

void PacketAssembly::begin(ReturnMode mode) {
  if (mode != mode_ || firings_per_packet_ == 0) {
    mode_ = mode;
    firings_per_packet_ = static_cast<int>(velodyne::firings_per_packet(model_, mode));
    packet_.blocks = {};
    for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
      places_[b] = velodyne::block_place(model_, mode, b);
      packet_.blocks[b].flag = places_[b].echo == BlockEcho::none
                                   ? std::uint16_t{0}
                                   : velodyne::block_flag(places_[b].first_laser);
    }
  }
  banks_ = 0;
}

bool PacketAssembly::within_block() const {
  return banks_ % (model_.firings_per_block * model_.blocks_per_firing) != 0;
}

int PacketAssembly::firings_left() const {
  return firings_per_packet_ - banks_ / model_.blocks_per_firing;
}

void PacketAssembly::add(const LidarFiring& bank, std::uint16_t azimuth_counts) {
  assert(!complete());
  const auto firing = static_cast<std::size_t>(banks_ / model_.blocks_per_firing);
  const std::size_t within = firing % static_cast<std::size_t>(model_.firings_per_block);
  const std::size_t lasers = std::min(kBankLasers, model_.lasers.size() - bank.first_laser);
  ++banks_;

  EncodedReturns strongest;
  EncodedReturns last;
  if (mode_ == ReturnMode::dual && bank.several) {
    EncodedReturns second;
    encode_.encode(bank, bank.strongest, strongest);
    encode_.encode(bank, bank.last, last);
    encode_.encode(bank, bank.second, second);
    pair_up(strongest, last, second);
  } else {
    const bool farthest = mode_ == ReturnMode::last && bank.several;
    encode_.encode(bank, farthest ? bank.last : bank.strongest, strongest);
  }
  for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
    const velodyne::BlockPlace& place = places_[b];
    if (place.echo == BlockEcho::none || place.first_firing != firing - within ||
        place.first_laser != bank.first_laser) {
      continue;
    }
    Block& block = packet_.blocks[b];
    if (within == 0) {
      block.azimuth_counts = azimuth_counts;
    }
    store(place.echo == BlockEcho::last && bank.several ? last : strongest, lasers,
          block.channels.data() + within * lasers);
  }
}

}  // namespace rigwire::emulators
