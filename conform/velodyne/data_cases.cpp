// What a data packet is made of: blocks, distances, and the lasers behind them.
#include <algorithm>
#include <numeric>

#include "conform/velodyne/velodyne_rows.h"

namespace rigwire::conform {

namespace velodyne = protocols::velodyne;
using velodyne::BlockEcho;
using velodyne::kBlocksPerPacket;
using velodyne::kChannelsPerBlock;

namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kFormat = "63-9113 Rev. H, Packet format; 63-9243 Rev. D, 9.3";
constexpr const char* kModel = "the model's manual: range";

void length(Trial& trial, const Log& log, const Claims&) {
  for (const VelodyneDatagram& datagram : log.data_datagrams()) {
    if (datagram.bytes.size() != velodyne::kDataPacketSize) {
      trial.received(datagram.bytes, "of another length");
      trial.expect(false, "1206 bytes in each data packet", std::to_string(datagram.bytes.size()));
      return;
    }
  }
  trial.expect(true, "1206 bytes in each data packet", "");
}

/// Checks each block of each packet whose place in the firing cycle is known.
template <class Check>
void each_block(Trial& trial, const Log& log, const char* expected, const Check& check) {
  each(trial, log.data(), expected, [&](const VelodyneData& packet) {
    for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
      if (Wrong wrong = check(packet, b, velodyne::block_place(*log.model(), log.mode(), b))) {
        return Wrong("block " + std::to_string(b) + ": " + *wrong);
      }
    }
    return Wrong();
  });
}

void flags(Trial& trial, const Log& log, const Claims&) {
  each_block(trial, log, "in each block the flag of its lasers",
             [](const VelodyneData& packet, std::size_t b, const velodyne::BlockPlace& place) {
               const unsigned right = place.echo == BlockEcho::none
                                          ? velodyne::kFlagEmpty
                                          : velodyne::block_flag(place.first_laser);
               return packet.flag(b) == right ? Wrong() : byte_text(packet.flag(b));
             });
}

void azimuths(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "azimuths of 0 to 35999", [](const VelodyneData& packet) {
    for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
      if (packet.azimuth(b) >= velodyne::kAzimuthCounts) {
        return Wrong(std::to_string(packet.azimuth(b)));
      }
    }
    return Wrong();
  });
}

std::string several_blocks(const Log& log, const Claims& claims) {
  const bool single = log.model() != nullptr && log.model()->blocks_per_firing == 1 && !log.dual();
  return single ? "each block is a firing" : a_model(log, claims);
}

void one_azimuth(Trial& trial, const Log& log, const Claims&) {
  each_block(trial, log, "one azimuth in all blocks of a firing",
             [&](const VelodyneData& packet, std::size_t b, const velodyne::BlockPlace& place) {
               const bool follows =
                   b > 0 && place.echo != BlockEcho::none &&
                   velodyne::block_place(*log.model(), log.mode(), b - 1).first_firing ==
                       place.first_firing;
               return follows && packet.azimuth(b) != packet.azimuth(b - 1)
                          ? Wrong(std::to_string(packet.azimuth(b)))
                          : Wrong();
             });
}

/// Calls `see(laser, distance_counts, reflectivity, azimuth_counts)` for each shot.
template <class See>
void each_shot(const Log& log, const See& see) {
  // The laser at each position is the same in all packets.
  std::array<std::array<std::size_t, kChannelsPerBlock>, kBlocksPerPacket> lasers{};
  std::array<bool, kBlocksPerPacket> holds{};
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    holds[b] = velodyne::block_place(*log.model(), log.mode(), b).echo != BlockEcho::none;
    for (std::size_t c = 0; holds[b] && c < kChannelsPerBlock; ++c) {
      lasers[b][c] = velodyne::shot(*log.model(), log.mode(), b, c).laser;
    }
  }
  for (const VelodyneData& packet : log.data()) {
    for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
      for (std::size_t c = 0; holds[b] && c < kChannelsPerBlock; ++c) {
        see(lasers[b][c], packet.distance(b, c), packet.reflectivity(b, c), packet.azimuth(b));
      }
    }
  }
}

void distances(Trial& trial, const Log& log, const Claims&) {
  unsigned greatest = 0;
  unsigned least = 0xFFFF;
  each_shot(log, [&](std::size_t, unsigned distance, unsigned, unsigned) {
    greatest = std::max(greatest, distance);
    least = distance > 0 ? std::min(least, distance) : least;
  });
  const double unit_m = log.model()->distance_unit_mm * 1e-3;
  if (greatest == 0) {
    return trial.not_applicable("nothing returned");
  }
  trial.expect(greatest * unit_m <= log.model()->maximum_range_m,
               "no return beyond " + number_text(log.model()->maximum_range_m) + " m",
               number_text(greatest * unit_m) + " m");
  trial.expect(least * unit_m >= log.model()->minimum_range_m - unit_m,
               "no return nearer than " + number_text(log.model()->minimum_range_m) + " m",
               number_text(least * unit_m) + " m");
}

void returns(Trial& trial, const Log& log, const Claims&) {
  std::size_t shots = 0;
  std::size_t found = 0;
  each_shot(log, [&](std::size_t, unsigned distance, unsigned, unsigned) {
    ++shots;
    found += distance > 0 ? 1U : 0U;
  });
  trial.observe(number_text(shots == 0
                                ? 0.0
                                : 100.0 * static_cast<double>(found) / static_cast<double>(shots)) +
                " % of the shots return");
}

void any_return(Trial& trial, const Log& log, const Claims&) {
  bool any = false;
  each_shot(log,
            [&](std::size_t, unsigned distance, unsigned, unsigned) { any = any || distance > 0; });
  trial.expect(any, "some shot that returns", "none");
}

// A laser that sees nothing while those above and below it do is dead: what they see lies on both
// sides of it.
void every_laser(Trial& trial, const Log& log, const Claims&) {
  const auto lasers = log.model()->lasers;
  std::vector<std::size_t> found(lasers.size());
  std::size_t shots = 0;
  each_shot(log, [&](std::size_t laser, unsigned distance, unsigned, unsigned) {
    ++shots;
    found[laser] += distance > 0 ? 1U : 0U;
  });
  std::vector<std::size_t> by_elevation(lasers.size());
  std::iota(by_elevation.begin(), by_elevation.end(), 0);
  std::ranges::sort(by_elevation, {}, [&](std::size_t i) { return lasers[i].elevation_deg; });
  const std::size_t often = shots / lasers.size() / 4;
  std::optional<std::size_t> below;  // The last that sees.
  for (std::size_t i = 0; i < by_elevation.size(); ++i) {
    const std::size_t laser = by_elevation[i];
    const bool above =
        std::any_of(by_elevation.begin() + static_cast<std::ptrdiff_t>(i), by_elevation.end(),
                    [&](std::size_t other) { return found[other] > often; });
    trial.expect(found[laser] > 0 || !below || !above,
                 "returns of each laser between those that return a quarter of their shots",
                 "none of laser " + std::to_string(laser));
    below = found[laser] > often ? std::optional(laser) : below;
  }
}

void every_direction(Trial& trial, const Log& log, const Claims&) {
  constexpr unsigned kSectors = 36;
  std::array<std::size_t, kSectors> found{};
  std::array<std::size_t, kSectors> shots{};
  each_shot(log, [&](std::size_t, unsigned distance, unsigned, unsigned azimuth) {
    const unsigned sector = azimuth / (velodyne::kAzimuthCounts / kSectors) % kSectors;
    ++shots[sector];
    found[sector] += distance > 0 ? 1U : 0U;
  });
  for (unsigned sector = 0; sector < kSectors; ++sector) {
    trial.expect(shots[sector] == 0 || found[sector] > 0,
                 "returns from each ten degrees that it looks at",
                 "none from " + std::to_string(sector * 10) + " degrees on");
  }
}

void reflectivities(Trial& trial, const Log& log, const Claims&) {
  std::array<std::size_t, 256> counts{};
  std::size_t all = 0;
  each_shot(log, [&](std::size_t, unsigned distance, unsigned reflectivity, unsigned) {
    counts[reflectivity] += distance > 0 ? 1U : 0U;
    all += distance > 0 ? 1U : 0U;
  });
  std::size_t so_far = 0;
  unsigned median = 0;
  while (median < 255 && (so_far += counts[median]) * 2 < all) {
    ++median;
  }
  const std::size_t retro = std::accumulate(counts.begin() + 101, counts.end(), std::size_t{0});
  trial.observe("half of what returns has " + std::to_string(median) + " or less, " +
                std::to_string(retro) + " of " + std::to_string(all) + " above 100");
}

std::string two_returns_of_128(const Log& log, const Claims& claims) {
  return log.model() != nullptr && log.model()->blocks_per_firing != 4 ? "its blocks are all full"
                                                                       : two_returns(log, claims);
}

void empty_blocks(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "nothing in the last four blocks", [](const VelodyneData& packet) {
    for (std::size_t b = velodyne::kFirstEmptyBlock; b < kBlocksPerPacket; ++b) {
      for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
        if (packet.distance(b, c) != 0 || packet.reflectivity(b, c) != 0) {
          return Wrong("something in block " + std::to_string(b));
        }
      }
    }
    return Wrong();
  });
}

// --- where it comes from ---

void one_sensor(Trial& trial, const Log& log, const Claims&) {
  const DatagramLine::Peer& first = log.data_datagrams().front().from;
  for (const VelodyneDatagram& datagram : log.data_datagrams()) {
    if (!trial.expect(datagram.from == first, "all data packets from one address and port",
                      datagram.from.address + ":" + std::to_string(datagram.from.port))) {
      return;
    }
  }
}

void same_address(Trial& trial, const Log& log, const Claims&) {
  for (const VelodynePosition& packet : log.positions()) {
    const std::string& address = packet.datagram().from.address;
    if (!trial.expect(address == log.data_datagrams().front().from.address,
                      "position packets from the address of the data packets", address)) {
      return;
    }
  }
}

std::string own_source_port(const Log& log, const Claims& claims) {
  return log.model() != nullptr && log.model()->source_port == 0
             ? "it sends from the port that it sends to"
             : a_model(log, claims);
}

void source_port(Trial& trial, const Log& log, const Claims&) {
  const std::uint16_t port = log.data_datagrams().front().from.port;
  trial.expect(port == log.model()->source_port,
               "from port " + std::to_string(log.model()->source_port), std::to_string(port));
}

}  // namespace

std::vector<VelodyneRow> velodyne_data_rows() {
  return {
      {"data", "A data packet has 1206 bytes", kFormat, kMust, nothing, length},
      {"data", "Each block has the flag of its lasers", kFormat, kMust, a_model, flags},
      {"data", "Azimuths are below 36000", kFormat, kMust, nothing, azimuths},
      {"data", "Blocks of one firing have one azimuth", kFormat, kMust, several_blocks,
       one_azimuth},
      {"data", "The blocks behind a dual firing of 128 are empty", "63-9483 Rev. A, 9.3", kShould,
       two_returns_of_128, empty_blocks},
      {"data", "How many shots return", kFormat, kObserved, a_model, returns},
      {"data", "Something returns", kFormat, kShould, a_model, any_return},
      {"data", "Distances are within the model's range", kModel, kShould, a_model, distances},
      {"data", "No laser is blind between those that see", kFormat, kShould, a_model, every_laser},
      {"data", "No direction is blind", kFormat, kShould, a_model, every_direction},
      {"data", "How much of the light returns", "63-9243 Rev. D, reflectivity", kObserved, a_model,
       reflectivities},
      {"source", "One sensor sends to the port", kFormat, kMust, nothing, one_sensor},
      {"source", "Position packets come from the sensor of the data packets", kFormat, kMust,
       position_packets, same_address},
      {"source", "Packets come from the model's port", "public captures (docs/devices/velodyne.md)",
       kShould, own_source_port, source_port},
  };
}

}  // namespace rigwire::conform
