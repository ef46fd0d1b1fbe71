// Dense messages for viewers of the Foxglove WebSocket protocol, as bytes rather than as JSON with
// base64: clouds of points. Channels name the encoding "cdr", and the schema "ros2msg" is a text.
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
  std::int64_t unix_ns = 0;  ///< Of its begin; from 1970 to 2038.
  std::string_view frame_id;
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  ///< x, y, z, w.
  std::uint32_t point_stride = 0;
  std::span<const PackedField> fields;
};

inline constexpr std::string_view kPointCloudSchemaName = "foxglove_msgs/msg/PointCloud";
extern const std::string_view kPointCloudSchema;

/// The message but for its data, of which `data_bytes` are to be appended behind it.
[[nodiscard]] std::string begin_point_cloud(const PointCloudHead& head, std::size_t data_bytes);

}  // namespace rigwire::protocols::foxglove
