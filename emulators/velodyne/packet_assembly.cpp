#include "emulators/velodyne/packet_assembly.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::Block;
using velodyne::Channel;
using velodyne::ReturnMode;

constexpr std::array<std::uint16_t, kMaxBanks> kFlags{
    velodyne::kFlagLasers0To31, velodyne::kFlagLasers32To63, velodyne::kFlagLasers64To95,
    velodyne::kFlagLasers96To127};

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

int PacketAssembly::firings_per_packet(const velodyne::Model& model, ReturnMode mode) {
  const int blocks = model.blocks_per_firing * (mode == ReturnMode::dual ? 2 : 1);
  return static_cast<int>(velodyne::kBlocksPerPacket) / blocks * model.firings_per_block;
}

void PacketAssembly::begin(ReturnMode mode) {
  if (mode != mode_ || firings_per_packet_ == 0) {
    mode_ = mode;
    firings_per_packet_ = firings_per_packet(model_, mode);
    packet_.blocks = {};
    const auto filled = static_cast<std::size_t>(firings_per_packet_ / model_.firings_per_block *
                                                 model_.blocks_per_firing) *
                        (mode == ReturnMode::dual ? 2 : 1);
    for (std::size_t b = filled; b < velodyne::kBlocksPerPacket; ++b) {
      packet_.blocks[b].flag = 0;
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

std::size_t PacketAssembly::block_index(std::size_t group, std::size_t bank,
                                        std::size_t partner) const {
  const auto banks = static_cast<std::size_t>(model_.blocks_per_firing);
  if (mode_ != ReturnMode::dual) {
    return group * banks + bank;
  }
  return banks == 2 ? group * 4 + partner * 2 + bank : (group * banks + bank) * 2 + partner;
}

void PacketAssembly::add(const LidarFiring& bank, std::uint16_t azimuth_counts) {
  assert(!complete());
  const int firing = banks_ / model_.blocks_per_firing;
  const auto group = static_cast<std::size_t>(firing / model_.firings_per_block);
  const auto within = static_cast<std::size_t>(firing % model_.firings_per_block);
  const auto bank_index = static_cast<std::size_t>(banks_ % model_.blocks_per_firing);
  const std::size_t lasers = std::min(kBankLasers, model_.lasers.size() - bank_index * kBankLasers);
  ++banks_;

  Block& block = packet_.blocks[block_index(group, bank_index, 0)];
  if (within == 0) {
    block.flag = kFlags[bank_index];
    block.azimuth_counts = azimuth_counts;
  }
  Channel* const channels = block.channels.data() + within * lasers;
  EncodedReturns first;
  if (mode_ != ReturnMode::dual) {
    encode_.encode(mode_ == ReturnMode::last && bank.several ? bank.last : bank.strongest, first);
    store(first, lasers, channels);
    return;
  }
  Block& partner = packet_.blocks[block_index(group, bank_index, 1)];
  partner.flag = block.flag;
  partner.azimuth_counts = block.azimuth_counts;
  Channel* const partners = partner.channels.data() + within * lasers;
  encode_.encode(bank.strongest, first);
  if (!bank.several) {
    store(first, lasers, channels);
    store(first, lasers, partners);
    return;
  }
  EncodedReturns last;
  EncodedReturns second;
  encode_.encode(bank.last, last);
  encode_.encode(bank.second, second);
  pair_up(first, last, second);
  const bool strongest_first = model_.blocks_per_firing == 2;
  store(strongest_first ? first : last, lasers, channels);
  store(strongest_first ? last : first, lasers, partners);
}

}  // namespace rigwire::emulators
