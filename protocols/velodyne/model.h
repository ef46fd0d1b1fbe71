// The Velodyne models that Rigwire knows, as data: a further model is a further row, and a further
// table of lasers (laser_tables.h).
//
// Sources: HDL-32E user's manual 63-9113 Rev. H, application note 63-9277 "Packet structure and
// timing definition"; VLP-16 manual 63-9243 Rev. D (product ids, factory bytes); VLP-32C manual
// 63-9325 Rev. B; HDL-64E S2.1 and S3 manuals (63-HDL64ES3 Rev. K), firing tables; VLS-128 manual
// 63-9483 Rev. A (draft), chapter 9. Beam divergence: VLS-128 manual, appendix F, and VLP-16 data
// sheet; HDL models as peers use them. VLS-128 since firmware 5.2.3.0: manual Rev. 4, as cited by
// velodyne_decoder. Nearest ranges, source ports, bytes without return: the public captures of
// sim/lidar/velodyne_heads.h. Format page: docs/devices/velodyne-packets.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rigwire::protocols::velodyne {

/// One laser. True azimuth = reported azimuth of its firing, moved on by the rotor until it fires,
/// + azimuth offset.
struct Laser {
  double elevation_deg = 0.0;       ///< Above the horizontal plane of the sensor.
  double azimuth_offset_deg = 0.0;  ///< Clockwise; calibration files print it with the opposite
                                    ///< sign, as rot_correction.
  double vertical_offset_mm =
      0.0;  ///< Height of the beam's exit on the spin axis; lower beams exit higher.
  double horizontal_offset_mm = 0.0;  ///< Offset of the beam's exit, to the right of the beam.
  std::int32_t time_offset_ns = 0;    ///< After the first laser of the same firing.
};

/// Content of bytes 14 to 205 of a model's position packets.
enum class PositionLayout : std::uint8_t {
  none,      ///< HDL-64E: no position packets; time and pulse state go by the status channel.
  inertial,  ///< HDL-32E: gyroscopes, accelerometers, temperatures.
  plain,     ///< VLP-16: nothing but time and pulse state.
  extended,  ///< Firmware from mid-2018: temperatures, calibration of the converters, status.
};

/// Full angles at 1/e2 of the intensity.
struct BeamDivergence {
  double horizontal_mrad = 0.0;
  double vertical_mrad = 0.0;
};

/// Fields in the IP headers of a model's packets.
struct PacketHeaders {
  std::uint8_t data_time_to_live = 255;
  bool data_unfragmented = true;
  std::uint8_t position_time_to_live = 64;
};

/// The reflectivity byte of a shot whose distance is 0. Each laser has its own, from `least` to
/// `greatest`.
struct NoReturnBytes {
  std::uint8_t least = 0;
  std::uint8_t greatest = 0;
};

struct Model {
  std::string_view name;               ///< "HDL-32E"
  std::string_view firmware{};         ///< "5.1.7"; empty where they do not differ.
  std::uint8_t product_id = 0;         ///< Second factory byte; 0 where there is none (HDL-64E).
  std::int32_t distance_unit_mm = 0;   ///< One count of the distance field.
  std::int32_t firing_period_ns = 0;   ///< From one firing of all lasers to the next.
  std::int32_t firings_per_block = 0;  ///< 1 where a block holds 32 lasers once, 2 for 16 lasers.
  std::int32_t blocks_per_firing = 1;  ///< 2 for 64 lasers, 4 for 128.
  /// The packet's timestamp is so long after the first laser of its first firing: 0 but for the
  /// VLS-128, whose timestamp belongs to the fourth group of eight.
  std::int32_t timestamp_lag_ns = 0;
  double minimum_rotor_rpm = 0.0;
  double maximum_rotor_rpm = 0.0;
  double minimum_range_m = 0.0;  ///< Default window of what the sensor reports.
  double maximum_range_m = 0.0;
  BeamDivergence divergence;
  double pulse_ns = 5.0;
  PositionLayout position_layout = PositionLayout::inertial;
  bool status_channel = false;    ///< HDL-64E: factory bytes carry a rotating status instead.
  bool dual_return = false;       ///< Can send two returns per shot.
  bool web_interface = false;     ///< VLP family and VLS-128.
  std::uint16_t source_port = 0;  ///< Source port of data packets; 0: the destination's.
  PacketHeaders headers{};
  NoReturnBytes no_return{};
  std::span<const Laser> lasers;  ///< In the order of their numbers, which is that in blocks.
};

/// Every known model, with each firmware that differs; of a name and of an id the newest first.
[[nodiscard]] std::span<const Model> models();

/// By name as the data sheet writes it, the newest firmware first; nullptr when there is none.
[[nodiscard]] const Model* find_model(std::string_view name);

/// With that firmware.
[[nodiscard]] const Model* find_model(std::string_view name, std::string_view firmware);

/// By the second factory byte of a data packet; nullptr when there is none, or for 0.
[[nodiscard]] const Model* find_model(std::uint8_t product_id);

}  // namespace rigwire::protocols::velodyne
