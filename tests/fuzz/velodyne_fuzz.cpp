// Whatever arrives on the two Velodyne ports: nothing is read past its end, and what is accepted is
// written back to the same bytes.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/points.h"
#include "protocols/velodyne/position_packet.h"

namespace velodyne = rigwire::protocols::velodyne;

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void data_packet(std::span<const std::uint8_t> bytes) {
  const auto decoded = velodyne::decode_data_packet(bytes);
  require(decoded.consumed() <= bytes.size());
  if (!decoded.ok()) {
    require(!decoded.incomplete() || decoded.shortage().had < decoded.shortage().needed);
    require(!decoded.malformed() || decoded.fault().offset < bytes.size());
    return;
  }
  std::array<std::uint8_t, velodyne::kDataPacketSize> again{};
  velodyne::encode(*decoded, again);
  require(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()));
  std::vector<velodyne::Point> points;
  for (const velodyne::Model& model : velodyne::models()) {
    velodyne::append_points(*decoded, model, points);
  }
  for (const velodyne::Point& point : points) {
    require(point.range_m > 0.0F && point.azimuth_rad >= 0.0F && point.azimuth_rad < 6.2832F);
  }
}

void position_packet(std::span<const std::uint8_t> bytes) {
  const auto decoded = velodyne::decode_position_packet(bytes);
  require(decoded.consumed() <= bytes.size());
  if (decoded.ok()) {
    std::array<std::uint8_t, velodyne::kPositionPacketSize> again{};
    velodyne::encode(*decoded, again);
    const auto twice = velodyne::decode_position_packet(again);
    require(twice.ok() && *twice == *decoded);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  data_packet(bytes);
  position_packet(bytes);
  // Most inputs are too short: lay them over valid packets as well.
  std::array<std::uint8_t, velodyne::kDataPacketSize> whole{};
  velodyne::encode(velodyne::DataPacket{}, whole);
  for (std::size_t i = 0; i < size && i < whole.size(); ++i) {
    whole[(i * 97 + size) % whole.size()] ^= bytes[i];
  }
  data_packet(whole);
  position_packet(std::span(whole).first(velodyne::kPositionPacketSize));
  return 0;
}
