// The Velodyne models that Rigwire knows, as data: a further model is a further row.
//
// Sources: HDL-32E user's manual 63-9113 Rev. H and optical drawing 86-0106 (elevations, vertical
// offsets, which obey offset = 28.83 mm * tan(-elevation)); application note 63-9277 "Packet
// structure and timing definition" (firing times); VLP-16 manual 63-9243 Rev. D, table of factory
// bytes (product ids). Notes and cross-checks: docs/devices/velodyne-hdl-32e.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rigwire::protocols::velodyne {

/// One laser, in firing order, which is also its order inside a block.
struct Laser {
  double elevation_deg = 0.0;  ///< Above the horizontal plane of the sensor.
  double vertical_offset_mm =
      0.0;  ///< Of the beam's exit on the spin axis; lower beams exit higher.
  std::int32_t time_offset_ns = 0;  ///< After the first laser of the same firing.
};

struct Model {
  std::string_view name;               ///< "HDL-32E"
  std::uint8_t product_id = 0;         ///< Second factory byte.
  std::int32_t distance_unit_mm = 0;   ///< One count of the distance field.
  std::int32_t firing_period_ns = 0;   ///< From one firing of all lasers to the next.
  std::int32_t firings_per_block = 0;  ///< 1 where a block holds all lasers once, 2 for 16 lasers.
  double minimum_rotor_rpm = 0.0;
  double maximum_rotor_rpm = 0.0;
  double minimum_range_m = 0.0;  ///< Default window of what the sensor reports.
  double maximum_range_m = 0.0;
  std::span<const Laser> lasers;  ///< In firing order.
};

/// Every known model.
[[nodiscard]] std::span<const Model> models();

/// By name as the data sheet writes it; nullptr when there is none.
[[nodiscard]] const Model* find_model(std::string_view name);

/// By the second factory byte of a data packet; nullptr when there is none.
[[nodiscard]] const Model* find_model(std::uint8_t product_id);

/// Which laser a place in a packet belongs to, and when it fired.
struct Shot {
  std::size_t laser = 0;
  std::int32_t block_offset_ns = 0;   ///< After the first laser of its block.
  std::int32_t packet_offset_ns = 0;  ///< After the packet's timestamp.
};

/// `channel` 0..31 of `block` 0..11, single return mode. Precondition: both in range.
[[nodiscard]] Shot shot(const Model& model, std::size_t block, std::size_t channel);

}  // namespace rigwire::protocols::velodyne
