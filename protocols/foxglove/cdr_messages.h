// Dense messages for viewers of the Foxglove WebSocket protocol, as bytes rather than as JSON with
// base64: clouds of points, pictures. Channels name the encoding "cdr", and the schema "ros2msg" is
// a text.
//
// CDR is the common data representation of OMG (CORBA 3.3 part 2, section 9.3; DDSI-RTPS 2.3,
// section 10): four bytes that say little-endian, then the members in the order of the schema, each
// number at a multiple of its size counted behind those four; a text is its length with the NUL
// that ends it, u32, and its bytes; a list is its count, u32, and its elements. The schema is the
// definition that foxglove/foxglove-sdk has under schemas/ros2, after which those of the parts
// follow, each behind a line of '='.
//
//   PointCloud   timestamp (i32 s, u32 ns), frame_id, pose (7 f64: x, y, z; x, y, z, w),
//                point_stride u32, fields[] (name, offset u32, type u8), data u8[]
//   RawImage     timestamp, frame_id, width u32, height u32, encoding, step u32, and of our own
//                what the picture was made of: block u64, sent_width u32, sent_height u32, remark;
//                data u8[]
//
// Data comes last in both, wherever the published definition has it: readers use the definition
// that a channel brings along.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace rigwire::protocols::foxglove {

inline constexpr std::string_view kCdrEncoding = "cdr";
inline constexpr std::string_view kCdrSchemaEncoding = "ros2msg";

/// foxglove.NumericType.
enum class NumericType : std::uint8_t { uint8 = 1, float32 = 7 };

struct PackedField {
  std::string_view name;
  std::uint32_t offset = 0;
  NumericType type = NumericType::uint8;
};

struct PointCloudHead {
  std::int64_t unix_ns = 0;  ///< Begin of the point cloud; from 1970 to 2038.
  std::string_view frame_id;
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  ///< x, y, z, w.
  std::uint32_t point_stride = 0;
  std::span<const PackedField> fields;
};

struct RawImageHead {
  std::int64_t unix_ns = 0;  ///< Time of the image; from 1970 to 2038.
  std::string_view frame_id;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string_view encoding;
  std::uint32_t step = 0;  ///< Bytes of a row.
  std::uint64_t block = 0;
  std::uint32_t sent_width = 0;
  std::uint32_t sent_height = 0;
  std::string_view remark;  ///< For people: how to read it.
};

inline constexpr std::string_view kPointCloudSchemaName = "foxglove_msgs/msg/PointCloud";
inline constexpr std::string_view kRawImageSchemaName = "foxglove_msgs/msg/RawImage";
[[nodiscard]] std::string point_cloud_schema();
[[nodiscard]] std::string raw_image_schema();

/// The messages but for their data, of which `data_bytes` are to be appended behind them.
[[nodiscard]] std::string begin_point_cloud(const PointCloudHead& head, std::size_t data_bytes);
[[nodiscard]] std::string begin_raw_image(const RawImageHead& head, std::size_t data_bytes);

}  // namespace rigwire::protocols::foxglove
