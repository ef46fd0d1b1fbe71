#include "protocols/gltf/glb.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <vector>

#include "protocols/bytes.h"

namespace rigwire::protocols::gltf {
namespace {

constexpr std::uint32_t kMagic = 0x4654'6C67;        // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F'534A;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E'4942;  // "BIN"
constexpr std::size_t kHeaderSize = 4                // magic
                                    + 4              // version
                                    + 4;             // length
constexpr std::size_t kChunkHeaderSize = 4           // length
                                         + 4;        // type

// Constants of accessors and buffer views (3.6.2.2, 5.11.5).
constexpr int kUnsignedByte = 5121;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

void append(std::string& text, std::uint32_t number) {
  std::array<std::uint8_t, 4> bytes{};
  store_little(std::span(bytes), 0, number);
  text.append(bytes.begin(), bytes.end());
}

std::string number(float value) {
  std::array<char, 32> text{};
  const int size = std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(value));
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string triple(const std::array<float, 3>& values) {
  return number(values[0]) + "," + number(values[1]) + "," + number(values[2]);
}

class Writer {
 public:
  void add(const Part& part) {
    const std::size_t vertices = part.vertices.size() / 3;
    std::array<float, 3> low{};
    std::array<float, 3> high{};
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
      const float value = part.vertices[i];
      low[i % 3] = i < 3 ? value : std::min(low[i % 3], value);
      high[i % 3] = i < 3 ? value : std::max(high[i % 3], value);
    }
    std::size_t from = data_.size();
    for (const float value : part.vertices) {
      append(data_, std::bit_cast<std::uint32_t>(value));
    }
    const std::string position =
        accessor(view(from, kArrayBuffer), kFloat, vertices, "VEC3",
                 R"(,"min":[)" + triple(low) + R"(],"max":[)" + triple(high) + "]");
    std::string attributes = R"("POSITION":)" + position;
    if (!part.vertex_colours.empty()) {
      from = data_.size();
      data_.append(part.vertex_colours.begin(), part.vertex_colours.end());
      attributes += R"(,"COLOR_0":)" + accessor(view(from, kArrayBuffer), kUnsignedByte, vertices,
                                                "VEC4", R"(,"normalized":true)");
    }
    from = data_.size();
    for (const std::uint32_t corner : part.corners) {
      append(data_, corner);
    }
    const std::string indices =
        accessor(view(from, kElementArrayBuffer), kUnsignedInt, part.corners.size(), "SCALAR", "");
    primitives_ += (materials_ == 0 ? "" : ",") + (R"({"attributes":{)" + attributes) +
                   R"(},"indices":)" + indices + R"(,"material":)" + std::to_string(materials_) +
                   "}";
    material_list_ += (materials_ == 0 ? "" : ",") +
                      (R"({"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[)" +
                       triple(part.colour) + R"(,1],"metallicFactor":0,"roughnessFactor":0.9}})");
    ++materials_;
  }

  [[nodiscard]] std::string file() {
    std::string json =
        R"({"asset":{"version":"2.0","generator":"rigwire"},"scene":0,"scenes":[{"nodes":[0]}],)"
        R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)" +
        primitives_ + R"(]}],"materials":[)" + material_list_ + R"(],"accessors":[)" + accessors_ +
        R"(],"bufferViews":[)" + views_ + R"(],"buffers":[{"byteLength":)" +
        std::to_string(data_.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    data_.resize((data_.size() + 3) / 4 * 4, '\0');
    std::string file;
    const std::size_t size =
        kHeaderSize + kChunkHeaderSize + json.size() + kChunkHeaderSize + data_.size();
    file.reserve(size);
    append(file, kMagic);
    append(file, 2);
    append(file, static_cast<std::uint32_t>(size));
    append(file, static_cast<std::uint32_t>(json.size()));
    append(file, kJsonChunk);
    file += json;
    append(file, static_cast<std::uint32_t>(data_.size()));
    append(file, kBinaryChunk);
    file += data_;
    return file;
  }
  [[nodiscard]] bool empty() const { return materials_ == 0; }

 private:
  /// Adds a buffer view of the bytes from `from` on and returns its number.
  std::string view(std::size_t from, int target) {
    views_ += (view_count_ == 0 ? "" : ",") +
              (R"({"buffer":0,"byteOffset":)" + std::to_string(from)) + R"(,"byteLength":)" +
              std::to_string(data_.size() - from) + R"(,"target":)" + std::to_string(target) + "}";
    return std::to_string(view_count_++);
  }
  std::string accessor(const std::string& view, int type, std::size_t count, const char* shape,
                       const std::string& more) {
    accessors_ += (accessor_count_ == 0 ? "" : ",") + (R"({"bufferView":)" + view) +
                  R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" +
                  std::to_string(count) + R"(,"type":")" + shape + "\"" + more + "}";
    return std::to_string(accessor_count_++);
  }

  std::string data_;
  std::string primitives_;
  std::string material_list_;
  std::string accessors_;
  std::string views_;
  std::size_t materials_ = 0;
  std::size_t view_count_ = 0;
  std::size_t accessor_count_ = 0;
};

}  // namespace

std::string glb(std::span<const Part> parts) {
  Writer writer;
  for (const Part& part : parts) {
    if (!part.corners.empty()) {
      writer.add(part);
    }
  }
  return writer.empty() ? std::string() : writer.file();
}

}  // namespace rigwire::protocols::gltf
