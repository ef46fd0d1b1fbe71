#include "protocols/velodyne/packet_layout.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::array<std::uint16_t, 4> kFlags{kFlagLasers0To31, kFlagLasers32To63,
                                              kFlagLasers64To95, kFlagLasers96To127};
constexpr std::size_t kBankLasers = 32;
constexpr std::uint8_t kProductVlp32aOrB = 0x23;

std::size_t banks(const Model& model) {
  return static_cast<std::size_t>(model.blocks_per_firing);
}

}  // namespace

BlockPlace block_place(const Model& model, ReturnMode mode, std::size_t block) {
  assert(block < kBlocksPerPacket);
  const auto firings = static_cast<std::size_t>(model.firings_per_block);
  const std::size_t blocks = banks(model);
  if (mode != ReturnMode::dual) {
    return {block / blocks * firings, block % blocks * kBankLasers, BlockEcho::single};
  }
  if (model.status_channel) {
    return {block / (2 * blocks), block % blocks * kBankLasers,
            block / blocks % 2 == 0 ? BlockEcho::strongest : BlockEcho::last};
  }
  const std::size_t firing = block / (2 * blocks);
  if (firing >= firings_per_packet(model, mode)) {
    return {0, 0, BlockEcho::none};
  }
  return {firing * firings, block / 2 % blocks * kBankLasers,
          block % 2 == 0 ? BlockEcho::last : BlockEcho::strongest};
}

std::uint16_t block_flag(std::size_t first_laser) {
  assert(first_laser / kBankLasers < kFlags.size());
  return kFlags[first_laser / kBankLasers];
}

std::size_t firings_per_packet(const Model& model, ReturnMode mode) {
  const std::size_t blocks = banks(model) * (mode == ReturnMode::dual ? 2 : 1);
  return kBlocksPerPacket / blocks * static_cast<std::size_t>(model.firings_per_block);
}

std::int32_t packet_period_ns(const Model& model, ReturnMode mode) {
  return static_cast<std::int32_t>(firings_per_packet(model, mode)) * model.firing_period_ns;
}

Shot shot(const Model& model, ReturnMode mode, std::size_t block, std::size_t channel) {
  const BlockPlace place = block_place(model, mode, block);
  assert(place.echo != BlockEcho::none && channel < kChannelsPerBlock);
  const std::size_t lasers = std::min(model.lasers.size(), kBankLasers);
  const std::size_t firing_in_block = channel / lasers;
  Shot result;
  result.laser = place.first_laser + channel % lasers;
  result.firing = place.first_firing + firing_in_block;
  result.echo = place.echo;
  result.block_offset_ns = static_cast<std::int32_t>(firing_in_block) * model.firing_period_ns +
                           model.lasers[result.laser].time_offset_ns;
  result.packet_offset_ns = static_cast<std::int32_t>(place.first_firing) * model.firing_period_ns +
                            result.block_offset_ns - model.timestamp_lag_ns;
  return result;
}

Recognition recognize(const DataPacket& packet) {
  const auto has = [&packet](std::uint16_t flag) {
    return std::ranges::find(packet.blocks, flag, &Block::flag) != packet.blocks.end();
  };
  const Model* by_id = find_model(packet.product_id);
  if (has(kFlagLasers64To95) || has(kFlagLasers96To127)) {
    if (by_id == nullptr || by_id->blocks_per_firing != 4) {
      return {nullptr, "blocks of 128 lasers, product id of another model"};
    }
    return {by_id, {}};
  }
  if (has(kFlagLasers32To63)) {
    return {nullptr, "an HDL-64E: its status channel says S2 or S3, one packet does not"};
  }
  if (by_id != nullptr && by_id->blocks_per_firing == 1) {
    return {by_id, {}};
  }
  if (by_id != nullptr) {
    return {nullptr, "blocks of 32 lasers, product id of a model with more"};
  }
  if (packet.product_id == kProductVlp32aOrB) {
    return {nullptr, "product id 0x23 is a VLP-32A or a VLP-32B"};
  }
  if (packet.product_id == 0) {
    return {nullptr, "no product id: an HDL-32E or a VLP-16 with old firmware"};
  }
  return {nullptr, "unknown product id"};
}

ReturnMode return_mode(const DataPacket& packet, const Model& model) {
  if (model.status_channel) {
    const bool dual = packet.blocks[0].azimuth_counts == packet.blocks[2].azimuth_counts;
    return dual && model.dual_return ? ReturnMode::dual : ReturnMode::strongest;
  }
  switch (packet.return_mode_byte) {
    case static_cast<std::uint8_t>(ReturnMode::last):
      return ReturnMode::last;
    case static_cast<std::uint8_t>(ReturnMode::dual):
      return ReturnMode::dual;
    default:
      return ReturnMode::strongest;
  }
}

}  // namespace rigwire::protocols::velodyne
