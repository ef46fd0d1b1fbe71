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

/// The two echoes of a shot that a dual-return packet reports.
struct Pair {
  Channel strongest;
  Channel last;
};

/// What takes the place of a repeated echo; the same again when there is nothing else.
Channel instead_of(const Channel& repeated, const LidarFiring& bank, std::size_t i,
                   const ReturnEncoder& encode) {
  const Channel second = bank.several ? encode(bank.second[i]) : Channel{};
  return second.distance_counts != 0 ? second : repeated;
}

Pair echoes(const LidarFiring& bank, std::size_t i, const ReturnEncoder& encode) {
  Pair pair;
  pair.strongest = encode(bank.strongest[i]);
  pair.last = bank.several ? encode(bank.last[i]) : pair.strongest;
  if (pair.last.distance_counts == 0) {
    pair.last = pair.strongest;
  } else if (pair.strongest.distance_counts == 0) {
    pair.strongest = pair.last;
  }
  return pair;
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
  if (mode_ != ReturnMode::dual) {
    const BankReturns& reported =
        mode_ == ReturnMode::last && bank.several ? bank.last : bank.strongest;
    for (std::size_t i = 0; i < lasers; ++i) {
      channels[i] = encode_(reported[i]);
    }
    return;
  }
  Block& partner = packet_.blocks[block_index(group, bank_index, 1)];
  partner.flag = block.flag;
  partner.azimuth_counts = block.azimuth_counts;
  Channel* const partners = partner.channels.data() + within * lasers;
  const bool strongest_first = model_.blocks_per_firing == 2;
  for (std::size_t i = 0; i < lasers; ++i) {
    const Pair pair = echoes(bank, i, encode_);
    channels[i] = strongest_first ? pair.strongest : pair.last;
    partners[i] = pair.strongest.distance_counts == pair.last.distance_counts
                      ? instead_of(channels[i], bank, i, encode_)
                  : strongest_first ? pair.last
                                    : pair.strongest;
  }
}

}  // namespace rigwire::emulators
