#include "sim/scene/colour_texture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rigwire::sim {
namespace {

constexpr float kFull = 65535.0F;

/// Texels of a finer side that texel `i` of the coarser one covers, with their shares.
struct Cover {
  std::size_t first = 0;
  std::size_t count = 0;
  std::array<double, 3> share{};
};

Cover cover(std::size_t i, std::size_t coarse, std::size_t fine) {
  // Texel i reaches from i fine / coarse to (i + 1) fine / coarse; in units of 1 / coarse texels.
  const std::size_t begin = i * fine;
  const std::size_t end = begin + fine;
  Cover found{begin / coarse, 0, {}};
  for (std::size_t t = found.first; t * coarse < end && found.count < found.share.size(); ++t) {
    const std::size_t from = std::max(begin, t * coarse);
    const std::size_t to = std::min(end, (t + 1) * coarse);
    found.share[found.count++] = static_cast<double>(to - from) / static_cast<double>(fine);
  }
  return found;
}

/// Keeps a coordinate within what floats count texels by.
float reduced(float coordinate, TextureEdge edge) {
  switch (edge) {
    case TextureEdge::repeats:
      return coordinate - std::floor(coordinate);
    case TextureEdge::mirrors:
      return coordinate - 2.0F * std::floor(0.5F * coordinate);
    case TextureEdge::stays:
      break;
  }
  return std::clamp(coordinate, -1.0F, 2.0F);
}

std::size_t texel(int place, int count, TextureEdge edge) {
  switch (edge) {
    case TextureEdge::repeats:
      place %= count;
      return static_cast<std::size_t>(place < 0 ? place + count : place);
    case TextureEdge::mirrors:
      place %= 2 * count;
      place = place < 0 ? place + 2 * count : place;
      return static_cast<std::size_t>(place < count ? place : 2 * count - 1 - place);
    case TextureEdge::stays:
      break;
  }
  return static_cast<std::size_t>(std::clamp(place, 0, count - 1));
}

}  // namespace

double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

ColourTexture::ColourTexture(std::string name, std::size_t columns, std::size_t rows,
                             std::vector<Texel> texels) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("texture '" + name + "': " + what);
  };
  if (columns < 1 || columns > kMostTexels || rows < 1 || rows > kMostTexels) {
    refuse("is " + std::to_string(columns) + " x " + std::to_string(rows) +
           " pixels, allowed: 1 to " + std::to_string(kMostTexels) + " along a side");
  }
  if (texels.size() != columns * rows) {
    refuse("has " + std::to_string(texels.size()) + " pixels for " +
           std::to_string(columns * rows));
  }
  constexpr auto kMost = static_cast<std::uint16_t>(kMostAlbedo * 65535.0);
  for (Texel& texel : texels) {
    for (std::size_t band = 0; band < 3; ++band) {
      texel[band] = std::min(texel[band], kMost);
    }
  }
  levels_.push_back({columns, rows, std::move(texels)});
  while (levels_.back().columns > 1 || levels_.back().rows > 1) {
    levels_.push_back(coarser(levels_.back()));
  }
  // From the coarsest on: what does not count takes the colour around it.
  for (std::size_t l = levels_.size() - 1; l-- > 0;) {
    Level& fine = levels_[l];
    const Level& coarse = levels_[l + 1];
    for (std::size_t r = 0; r < fine.rows; ++r) {
      for (std::size_t c = 0; c < fine.columns; ++c) {
        Texel& own = fine.texels[r * fine.columns + c];
        if (own[3] == 0) {
          const std::size_t at_row = std::min(r * coarse.rows / fine.rows, coarse.rows - 1);
          const std::size_t at = std::min(c * coarse.columns / fine.columns, coarse.columns - 1);
          std::copy_n(coarse.texels[at_row * coarse.columns + at].begin(), 3, own.begin());
        }
      }
    }
  }
}

ColourTexture::Level ColourTexture::coarser(const Level& fine) {
  Level level{
      std::max<std::size_t>(1, fine.columns / 2), std::max<std::size_t>(1, fine.rows / 2), {}};
  level.texels.reserve(level.columns * level.rows);
  for (std::size_t r = 0; r < level.rows; ++r) {
    const Cover rows = cover(r, level.rows, fine.rows);
    for (std::size_t c = 0; c < level.columns; ++c) {
      const Cover columns = cover(c, level.columns, fine.columns);
      // Mean over what counts; of nothing but holes the plain one.
      std::array<double, 3> counted{};
      std::array<double, 3> plain{};
      double counts = 0.0;
      for (std::size_t j = 0; j < rows.count; ++j) {
        for (std::size_t k = 0; k < columns.count; ++k) {
          const Texel& from = fine.texels[(rows.first + j) * fine.columns + columns.first + k];
          const double share = rows.share[j] * columns.share[k];
          for (std::size_t band = 0; band < 3; ++band) {
            plain[band] += share * from[band];
            counted[band] += share * from[3] * from[band];
          }
          counts += share * from[3];
        }
      }
      Texel& mean = level.texels.emplace_back();
      for (std::size_t band = 0; band < 3; ++band) {
        const double value = counts > 0.0 ? counted[band] / counts : plain[band];
        mean[band] = static_cast<std::uint16_t>(std::lround(value));
      }
      mean[3] = static_cast<std::uint16_t>(
          counts > 0.0 ? std::max(1.0, std::min(counts + 0.5, 65535.0)) : 0.0);
    }
  }
  return level;
}

std::size_t ColourTexture::memory_bytes() const {
  std::size_t bytes = 0;
  for (const Level& level : levels_) {
    bytes += level.texels.size() * sizeof(Texel);
  }
  return bytes;
}

void ColourTexture::add(const Level& level, const Place& place, float weight,
                        std::array<float, 3>& sum) {
  const auto columns = static_cast<int>(level.columns);
  const auto rows = static_cast<int>(level.rows);
  const float x = place.u * static_cast<float>(columns) - 0.5F;
  const float y = place.v * static_cast<float>(rows) - 0.5F;
  const float left = std::floor(x);
  const float low = std::floor(y);
  const float right_share = x - left;
  const float high_share = y - low;
  const auto c = static_cast<int>(left);
  const auto r = static_cast<int>(low);
  const std::array<std::size_t, 2> at_columns{texel(c, columns, place.edge_u),
                                              texel(c + 1, columns, place.edge_u)};
  const std::array<std::size_t, 2> at_rows{texel(r, rows, place.edge_v),
                                           texel(r + 1, rows, place.edge_v)};
  const std::array<float, 2> across{1.0F - right_share, right_share};
  const std::array<float, 2> up{weight * (1.0F - high_share), weight * high_share};
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t k = 0; k < 2; ++k) {
      const Texel& from = level.texels[at_rows[j] * level.columns + at_columns[k]];
      const float share = up[j] * across[k];
      for (std::size_t band = 0; band < 3; ++band) {
        sum[band] += share * static_cast<float>(from[band]);
      }
    }
  }
}

std::array<float, 3> ColourTexture::mean(float u, float v, const TextureFootprint& seen,
                                         TextureEdge edge_u, TextureEdge edge_v) const {
  const auto columns = static_cast<float>(levels_.front().columns);
  const auto rows = static_cast<float>(levels_.front().rows);
  // In texels. Beyond a few pictures, and where it is no number, there is nothing but their mean.
  const auto length = [&](float& du, float& dv) {
    const float found = std::hypot(du * columns, dv * rows);
    const float most = 4.0F * std::max(columns, rows);
    if (found < most) {
      return found;
    }
    du = 0.0F;
    dv = 0.0F;
    return most;
  };
  TextureFootprint way = seen;
  const float across = length(way.across_u, way.across_v);
  const float along = length(way.along_u, way.along_v);
  const bool slanted = along >= across;
  const float long_way = slanted ? along : across;
  const float short_way = slanted ? across : along;
  // The number of places is how often the shorter way fits into the longer one; the level is the
  // one whose texels are as wide as the shorter way.
  const float wide = std::max({short_way, long_way / static_cast<float>(kMostProbes), 1.0F});
  const int probes = std::clamp(static_cast<int>(std::ceil(long_way / wide)), 1, kMostProbes);
  const float level = std::min(std::log2(wide), static_cast<float>(levels_.size() - 1));
  const auto finer = static_cast<std::size_t>(level);
  const std::size_t next = std::min(finer + 1, levels_.size() - 1);
  const float coarse_share = level - static_cast<float>(finer);
  const float du = slanted ? way.along_u : way.across_u;
  const float dv = slanted ? way.along_v : way.across_v;
  std::array<float, 3> sum{};
  for (int k = 0; k < probes; ++k) {
    const float shift = (static_cast<float>(k) + 0.5F) / static_cast<float>(probes) - 0.5F;
    const Place place{reduced(u + shift * du, edge_u), reduced(v + shift * dv, edge_v), edge_u,
                      edge_v};
    add(levels_[finer], place, 1.0F - coarse_share, sum);
    if (coarse_share > 0.0F) {
      add(levels_[next], place, coarse_share, sum);
    }
  }
  const float scale = 1.0F / (kFull * static_cast<float>(probes));
  return {sum[0] * scale, sum[1] * scale, sum[2] * scale};
}

}  // namespace rigwire::sim
