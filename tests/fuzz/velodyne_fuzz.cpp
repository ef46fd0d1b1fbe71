// Whatever arrives on the two Velodyne ports: nothing is read past its end, and what is accepted is
// written back to the same bytes. The status channel of an HDL-64E takes any sequence of type and
// value.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/packet_layout.h"
#include "protocols/velodyne/points.h"
#include "protocols/velodyne/position_packet.h"
#include "protocols/velodyne/status_channel.h"

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
  const velodyne::Recognition recognition = velodyne::recognize(*decoded);
  require((recognition.model == nullptr) != recognition.doubt.empty());
  std::vector<velodyne::Point> points;
  for (const velodyne::Model& model : velodyne::models()) {
    velodyne::PointReader reader(model);
    reader.append(*decoded, points);
    reader.append(*decoded, points);
    for (const velodyne::Point& point : points) {
      require(point.range_m > 0.0F && point.azimuth_rad >= 0.0F && point.azimuth_rad < 6.2832F);
      require(point.laser < model.lasers.size());
    }
    points.clear();
  }
}

/// Any record that passes its check is written back to what it says, and lasers that a client would
/// take measure what they were told.
void status_record(std::span<const std::uint8_t> bytes) {
  const auto decoded = velodyne::decode_status_record(bytes);
  if (!decoded.ok()) {
    return;
  }
  std::array<std::uint8_t, velodyne::kStatusRecordSize> again{};
  velodyne::encode(*decoded, again);
  const auto twice = velodyne::decode_status_record(again);
  require(twice.ok() && *twice == *decoded);
  try {
    validate(decoded->calibration);
  } catch (const std::invalid_argument&) {
    return;
  }
  for (const velodyne::Hdl64eLaser& laser : decoded->calibration.lasers) {
    const double counts = velodyne::raw_counts(laser, 30.0, 100.0);
    require(std::abs(velodyne::corrected(laser, counts, 100.0).range_m - 30.0) < 1e-3);
    const double seen = velodyne::corrected_intensity(laser, 128, counts);
    require(seen >= laser.min_intensity && seen <= laser.max_intensity);
  }
}

void status_channel(std::span<const std::uint8_t> bytes) {
  velodyne::StatusReader reader;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    (void)reader.add({bytes[i], bytes[i + 1]});
  }
  // The bytes are also laid over a channel in order, so that records do complete.
  velodyne::StatusRecord record;
  record.format = bytes.size() % 2 == 0 ? velodyne::StatusFormat::s2 : velodyne::StatusFormat::s3;
  record.calibration = velodyne::nominal_calibration(*velodyne::find_model("HDL-64E S2"));
  std::array<std::uint8_t, velodyne::kStatusRecordSize> whole{};
  velodyne::encode(record, whole);
  for (std::size_t i = 0; i < bytes.size() && i < whole.size(); ++i) {
    whole[(i * 97 + bytes.size()) % whole.size()] ^= bytes[i];
  }
  status_record(whole);
  const std::uint16_t check = velodyne::status_crc(whole);
  whole[velodyne::kStatusRecordSize - 2] = static_cast<std::uint8_t>(check & 0xFFU);
  whole[velodyne::kStatusRecordSize - 1] = static_cast<std::uint8_t>(check >> 8U);
  status_record(whole);
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
  status_record(bytes);
  status_channel(bytes);
  // Most inputs are too short: lay them over valid packets as well.
  std::array<std::uint8_t, velodyne::kDataPacketSize> whole{};
  velodyne::encode(velodyne::DataPacket{}, whole);
  for (std::size_t i = 0; i < size && i < whole.size(); ++i) {
    whole[(i * 97 + size) % whole.size()] ^= bytes[i];
  }
  data_packet(whole);
  // And the same as two returns.
  whole[1204] = static_cast<std::uint8_t>(velodyne::ReturnMode::dual);
  data_packet(whole);
  position_packet(std::span(whole).first(velodyne::kPositionPacketSize));
  return 0;
}
