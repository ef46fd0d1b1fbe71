#include "protocols/foxglove/cdr_messages.h"

#include <bit>
#include <concepts>
#include <utility>

#include "protocols/bytes.h"

namespace rigwire::protocols::foxglove {
namespace {

class CdrWriter {
 public:
  explicit CdrWriter(std::size_t room) {
    bytes_.reserve(room);
    bytes_.append({'\0', '\1', '\0', '\0'});  // little-endian, no options
  }

  template <std::unsigned_integral Number>
  void put(Number number) {
    const std::size_t over = (bytes_.size() - kHeaderBytes) % sizeof(Number);
    bytes_.append(over == 0 ? 0 : sizeof(Number) - over, '\0');
    std::array<std::uint8_t, sizeof(Number)> bytes{};
    store_little(std::span(bytes), 0, number);
    bytes_.append(bytes.begin(), bytes.end());
  }
  void put(double number) { put(std::bit_cast<std::uint64_t>(number)); }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kHeaderBytes = 4;
  std::string bytes_;
};

constexpr std::size_t kHeadRoom = 256;

CdrWriter begin(std::int64_t unix_ns, std::string_view frame_id, std::size_t data_bytes) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  CdrWriter cdr(kHeadRoom + frame_id.size() + data_bytes);
  cdr.put(static_cast<std::uint32_t>(unix_ns / kSecond_ns));
  cdr.put(static_cast<std::uint32_t>(unix_ns % kSecond_ns));
  cdr.put(frame_id);
  return cdr;
}

/// The definition of a part of a message.
std::string part(std::string_view name, std::string_view members) {
  return std::string(80, '=') + "\nMSG: " + std::string(name) + "\n" + std::string(members);
}

std::string time_part() {
  return part("builtin_interfaces/Time",
              "int32 sec\n"
              "uint32 nanosec\n");
}

}  // namespace

std::string point_cloud_schema() {
  return "builtin_interfaces/Time timestamp\n"
         "string frame_id\n"
         "geometry_msgs/Pose pose\n"
         "uint32 point_stride\n"
         "foxglove_msgs/PackedElementField[] fields\n"
         "uint8[] data\n" +
         time_part() +
         part("geometry_msgs/Pose",
              "geometry_msgs/Point position\n"
              "geometry_msgs/Quaternion orientation\n") +
         part("geometry_msgs/Point",
              "float64 x\n"
              "float64 y\n"
              "float64 z\n") +
         part("geometry_msgs/Quaternion",
              "float64 x\n"
              "float64 y\n"
              "float64 z\n"
              "float64 w\n") +
         part("foxglove_msgs/PackedElementField",
              "string name\n"
              "uint32 offset\n"
              "uint8 type\n");
}

std::string raw_image_schema() {
  return "builtin_interfaces/Time timestamp\n"
         "string frame_id\n"
         "uint32 width\n"
         "uint32 height\n"
         "string encoding\n"
         "uint32 step\n"
         "uint64 block\n"
         "uint32 sent_width\n"
         "uint32 sent_height\n"
         "string remark\n"
         "uint8[] data\n" +
         time_part();
}

std::string begin_point_cloud(const PointCloudHead& head, std::size_t data_bytes) {
  CdrWriter cdr = begin(head.unix_ns, head.frame_id, data_bytes);
  for (const double part : head.position_m) {
    cdr.put(part);
  }
  for (const double part : head.orientation) {
    cdr.put(part);
  }
  cdr.put(head.point_stride);
  cdr.put(static_cast<std::uint32_t>(head.fields.size()));
  for (const PackedField& field : head.fields) {
    cdr.put(field.name);
    cdr.put(field.offset);
    cdr.put(static_cast<std::uint8_t>(field.type));
  }
  cdr.put(static_cast<std::uint32_t>(data_bytes));
  return cdr.take();
}

std::string begin_raw_image(const RawImageHead& head, std::size_t data_bytes) {
  CdrWriter cdr = begin(head.unix_ns, head.frame_id, data_bytes);
  cdr.put(head.width);
  cdr.put(head.height);
  cdr.put(head.encoding);
  cdr.put(head.step);
  cdr.put(head.block);
  cdr.put(head.sent_width);
  cdr.put(head.sent_height);
  cdr.put(head.remark);
  cdr.put(static_cast<std::uint32_t>(data_bytes));
  return cdr.take();
}

}  // namespace rigwire::protocols::foxglove
