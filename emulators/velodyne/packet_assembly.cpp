#include "emulators/velodyne/packet_assembly.h"

#include <algorithm>
#include <cassert>

#include "sim/samples/wide_vectors.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::BlockEcho;
using velodyne::ReturnMode;

constexpr std::uint32_t kDistance = 0xFFFF;

/// Makes of the three echoes of each shot the two that are reported.
RIGWIRE_WIDE_VECTORS
void pair_up(EncodedReturns& strongest, EncodedReturns& last, const EncodedReturns& second) {
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    const std::uint32_t farthest = choose(last[i] == 0, strongest[i], last[i]);
    const std::uint32_t best = choose(strongest[i] == 0, farthest, strongest[i]);
    const bool repeated = (best & kDistance) == (farthest & kDistance);
    const std::uint32_t other = choose(second[i] == 0, farthest, second[i]);
    last[i] = farthest;
    strongest[i] = choose(repeated, other, best);
  }
}

}  // namespace

PacketAssembly::PacketAssembly(const velodyne::Model& model, const ReturnEncoder& encode,
                               const NoReturnBytes& no_return)
    : model_(model), encode_(encode) {
  for (std::size_t laser = 0; laser < no_return.size(); ++laser) {
    no_return_[laser] = static_cast<velodyne::ChannelWord>(no_return[laser]) << 16U;
    marks_no_returns_ = marks_no_returns_ || no_return[laser] != 0;
  }
  begin(mode_);
}

void PacketAssembly::begin(ReturnMode mode) {
  if (mode != mode_ || firings_per_packet_ == 0) {
    mode_ = mode;
    firings_per_packet_ = static_cast<int>(velodyne::firings_per_packet(model_, mode));
    lay_out();
  }
  banks_ = 0;
}

void PacketAssembly::lay_out() {
  const auto banks = static_cast<std::size_t>(model_.blocks_per_firing);
  const auto firings = static_cast<std::size_t>(model_.firings_per_block);
  bytes_.fill(0);
  for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
    const velodyne::BlockPlace place = velodyne::block_place(model_, mode_, b);
    if (place.echo != BlockEcho::none) {
      write_.flag(b, velodyne::block_flag(place.first_laser));
      BankBlocks& blocks =
          blocks_[place.first_firing / firings * banks + place.first_laser / kBankLasers];
      (place.echo == BlockEcho::last ? blocks.last : blocks.strongest) = b;
    }
  }
}

bool PacketAssembly::within_block() const {
  return banks_ % (model_.firings_per_block * model_.blocks_per_firing) != 0;
}

int PacketAssembly::firings_left() const {
  return firings_per_packet_ - banks_ / model_.blocks_per_firing;
}

// Writes a bank's returns to the blocks of its firing. In dual return mode the second block has the
// last return; where that is also the strongest, the first block has the second strongest
// (pair_up()).
void PacketAssembly::add(const LidarFiring& bank, std::uint16_t azimuth_counts) {
  assert(!complete());
  const int firing = banks_ / model_.blocks_per_firing;
  const int block_row = firing / model_.firings_per_block;
  const auto within = static_cast<std::size_t>(firing % model_.firings_per_block);
  const BankBlocks& blocks =
      blocks_[static_cast<std::size_t>(block_row * model_.blocks_per_firing) +
              bank.first_laser / kBankLasers];
  const std::size_t lasers = std::min(kBankLasers, model_.lasers.size() - bank.first_laser);
  ++banks_;

  std::array<EncodedReturns, 3> encoded;
  auto& [strongest, last, second] = encoded;
  const bool two = mode_ == ReturnMode::dual;
  if (two && bank.several) {
    encode_.encode(bank, std::array{&bank.strongest, &bank.last, &bank.second}, encoded);
    pair_up(strongest, last, second);
  } else {
    const bool farthest = mode_ == ReturnMode::last && bank.several;
    encode_.encode(bank, std::array{farthest ? &bank.last : &bank.strongest}, encoded);
  }
  if (marks_no_returns_) {
    mark_no_returns(bank.first_laser, strongest);
    if (two && bank.several) {
      mark_no_returns(bank.first_laser, last);
    }
  }
  const auto fill = [&](std::size_t block, const EncodedReturns& echoes) {
    if (within == 0) {
      write_.azimuth(block, azimuth_counts);
    }
    write_.channels(block, within * lasers, std::span(echoes).first(lasers));
  };
  fill(blocks.strongest, strongest);
  if (two) {
    fill(blocks.last, bank.several ? last : strongest);
  }
}

RIGWIRE_WIDE_VECTORS
void PacketAssembly::mark_no_returns(std::size_t first_laser, EncodedReturns& encoded) const {
  const velodyne::ChannelWord* const none = no_return_.data() + first_laser;
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    encoded[i] = choose((encoded[i] & kDistance) == 0, none[i], encoded[i]);
  }
}

}  // namespace rigwire::emulators
