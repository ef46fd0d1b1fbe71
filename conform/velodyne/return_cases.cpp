// Cases of the return mode that packets report, and of the returns that they contain.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/velodyne/velodyne_rows.h"

namespace rigwire::conform {

namespace velodyne = protocols::velodyne;
using velodyne::kBlocksPerPacket;
using velodyne::kChannelsPerBlock;

namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kFactory = "63-9243 Rev. D, 9.3, factory bytes";
constexpr const char* kDual = "63-9243 Rev. D, 9.3, dual return";

void known_mode(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "return mode 0x37, 0x38 or 0x39", [](const VelodyneData& packet) {
    const std::uint8_t mode = packet.return_mode();
    return mode >= 0x37 && mode <= 0x39 ? Wrong() : byte_text(mode);
  });
}

void one_mode(Trial& trial, const Log& log, const Claims&) {
  const std::uint8_t first = log.data().front().return_mode();
  each(trial, log.data(), "one return mode in all packets", [&](const VelodyneData& packet) {
    return packet.return_mode() == first ? Wrong() : byte_text(packet.return_mode());
  });
}

std::string claimed_mode(const Log& log, const Claims& claims) {
  return claims.return_mode.empty() ? "no return mode is claimed" : a_model(log, claims);
}

void returns_as_claimed(Trial& trial, const Log& log, const Claims& claims) {
  const bool strongest_or_last = log.model()->status_channel && !log.dual();
  const std::string_view found = return_mode_name(log.mode());
  trial.expect(found == claims.return_mode || (strongest_or_last && claims.return_mode == "last"),
               "return mode " + claims.return_mode, std::string(found));
}

void known_product(Trial& trial, const Log& log, const Claims&) {
  // 0x23 are the VLP-32A and VLP-32B, 0x31 the Velarray, 0x63 a VLS-128 by the table of Rev. D.
  static constexpr std::array<std::uint8_t, 8> kIds{0x21, 0x22, 0x23, 0x24, 0x28, 0x31, 0x63, 0xA1};
  each(trial, log.data(), "a product id that there is", [](const VelodyneData& packet) {
    return std::ranges::find(kIds, packet.product()) != kIds.end() ? Wrong()
                                                                   : byte_text(packet.product());
  });
}

void one_product(Trial& trial, const Log& log, const Claims&) {
  const std::uint8_t first = log.data().front().product();
  each(trial, log.data(), "one product id in all packets", [&](const VelodyneData& packet) {
    return packet.product() == first ? Wrong() : byte_text(packet.product());
  });
}

std::string claimed_product(const Log& log, const Claims& claims) {
  const std::string status = factory_bytes(log, claims);
  return claims.model.empty() ? "no model is claimed" : status;
}

void product_as_claimed(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "the product id of the claimed model", [&](const VelodyneData& packet) {
    return packet.product() == log.model()->product_id ? Wrong() : byte_text(packet.product());
  });
}

/// A block and the one that holds the other return of its firing; blocks of both, by laser.
struct Pair {
  std::size_t last = 0;
  std::size_t other = 0;
};
std::vector<Pair> pairs_of(const Log& log) {
  std::vector<Pair> pairs;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const velodyne::BlockPlace place = velodyne::block_place(*log.model(), log.mode(), b);
    for (std::size_t c = 0; c < kBlocksPerPacket; ++c) {
      const velodyne::BlockPlace other = velodyne::block_place(*log.model(), log.mode(), c);
      if (place.echo == velodyne::BlockEcho::last && other.echo == velodyne::BlockEcho::strongest &&
          place.first_firing == other.first_firing && place.first_laser == other.first_laser) {
        pairs.push_back({b, c});
      }
    }
  }
  return pairs;
}

void pairs_have_one_azimuth(Trial& trial, const Log& log, const Claims&) {
  const std::vector<Pair> pairs = pairs_of(log);
  each(trial, log.data(), "one azimuth in both blocks of a pair", [&](const VelodyneData& packet) {
    for (const Pair& pair : pairs) {
      if (packet.azimuth(pair.last) != packet.azimuth(pair.other)) {
        return Wrong("blocks " + std::to_string(pair.last) + " and " + std::to_string(pair.other) +
                     ": " + std::to_string(packet.azimuth(pair.last)) + " and " +
                     std::to_string(packet.azimuth(pair.other)));
      }
    }
    return Wrong();
  });
}

void both_or_none(Trial& trial, const Log& log, const Claims&) {
  const std::vector<Pair> pairs = pairs_of(log);
  each(trial, log.data(), "a single return in both blocks of a pair",
       [&](const VelodyneData& packet) {
         for (const Pair& pair : pairs) {
           for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
             if ((packet.distance(pair.last, c) == 0) != (packet.distance(pair.other, c) == 0)) {
               return Wrong("channel " + std::to_string(c) + " of block " +
                            std::to_string(pair.last) + " alone, or of its pair");
             }
           }
         }
         return Wrong();
       });
}

/// Statistics of shots with two returns: their number, the number in which the last return is
/// nearer, and the min distance between the two, counts.
struct Apart {
  std::size_t pairs = 0;
  std::size_t wrong = 0;
  unsigned least = 0xFFFF;
};
Apart apart(const Log& log) {
  const std::vector<Pair> pairs = pairs_of(log);
  Apart found;
  for (const VelodyneData& packet : log.data()) {
    for (const Pair& pair : pairs) {
      for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
        const unsigned last = packet.distance(pair.last, c);
        const unsigned other = packet.distance(pair.other, c);
        if (last != other) {
          ++found.pairs;
          found.wrong += last < other ? 1U : 0U;
          found.least = std::min(found.least, last > other ? last - other : other - last);
        }
      }
    }
  }
  return found;
}

void last_is_last(Trial& trial, const Log& log, const Claims&) {
  const Apart found = apart(log);
  if (found.pairs == 0) {
    return trial.not_applicable("no shot had two returns");
  }
  trial.expect(found.wrong * 50 <= found.pairs,
               "the farther return in the place of the last return, but for one in fifty",
               std::to_string(found.wrong) + " of " + std::to_string(found.pairs) + " otherwise");
}

void two_returns_found(Trial& trial, const Log& log, const Claims&) {
  const Apart found = apart(log);
  trial.observe(std::to_string(found.pairs) + " shots had two returns" +
                (found.pairs == 0
                     ? ""
                     : ", at least " +
                           number_text(found.least * 1e-3 * log.model()->distance_unit_mm) +
                           " m apart"));
}

}  // namespace

std::vector<VelodyneRow> velodyne_return_rows() {
  return {
      {"returns", "The return mode is one that there is", kFactory, kMust, factory_bytes,
       known_mode},
      {"returns", "The return mode is the same in all packets", kFactory, kMust, factory_bytes,
       one_mode},
      {"returns", "The return mode is the claimed one", kFactory, kMust, claimed_mode,
       returns_as_claimed},
      {"returns", "The product id is one that there is", kFactory, kMust, factory_bytes,
       known_product},
      {"returns", "The product id is the same in all packets", kFactory, kMust, factory_bytes,
       one_product},
      {"returns", "The product id is the claimed model's", kFactory, kMust, claimed_product,
       product_as_claimed},
      {"returns", "Two returns have one azimuth", kDual, kMust, two_returns,
       pairs_have_one_azimuth},
      {"returns", "A single return is said twice", kDual, kMust, two_returns, both_or_none},
      {"returns", "The last return is the farther one", kDual, kMust, two_returns, last_is_last},
      {"returns", "How many shots have two returns", kDual, kObserved, two_returns,
       two_returns_found},
  };
}

}  // namespace rigwire::conform
