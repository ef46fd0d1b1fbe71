#include "protocols/gltf/glb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <string>

#include "protocols/bytes.h"

namespace rigwire::protocols::gltf {
namespace {

using testing::HasSubstr;

constexpr std::array<float, 9> kVertices{0, 0, 0, 2, 0, 0, 0, 3, -1};
constexpr std::array<std::uint32_t, 3> kCorners{0, 1, 2};

std::span<const std::uint8_t> bytes_of(const std::string& file) {
  return {reinterpret_cast<const std::uint8_t*>(file.data()), file.size()};
}

TEST(Glb, HeaderAndChunksHaveTheLengthsThatTheyHave) {
  const Part part{kVertices, kCorners, {0.5F, 0.25F, 1.0F}, {}};
  const std::string file = glb({&part, 1});
  const auto bytes = bytes_of(file);
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(load_little<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(load_little<std::uint32_t>(bytes, 8), file.size());
  const auto json = load_little<std::uint32_t>(bytes, 12);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  EXPECT_EQ(json % 4, 0U);
  const auto binary = load_little<std::uint32_t>(bytes, 20 + json);
  EXPECT_EQ(file.substr(20 + json + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(20 + json + 8 + binary, file.size());
  EXPECT_EQ(binary, 9 * 4 + 3 * 4U);
}

TEST(Glb, ThePositionsAreThereWithTheirBounds) {
  const Part part{kVertices, kCorners, {0.5F, 0.25F, 1.0F}, {}};
  const std::string file = glb({&part, 1});
  EXPECT_THAT(file, HasSubstr(R"("min":[0,0,-1],"max":[2,3,0])"));
  EXPECT_THAT(file, HasSubstr(R"("baseColorFactor":[0.5,0.25,1,1])"));
  const auto bytes = bytes_of(file);
  const std::size_t binary = file.size() - (9 * 4 + 3 * 4);
  for (std::size_t i = 0; i < kVertices.size(); ++i) {
    EXPECT_EQ(std::bit_cast<float>(load_little<std::uint32_t>(bytes, binary + 4 * i)),
              kVertices[i]);
  }
}

TEST(Glb, ColoursOfVerticesAreASecondAttribute) {
  constexpr std::array<std::uint8_t, 12> kColours{1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255};
  const Part part{kVertices, kCorners, {1.0F, 1.0F, 1.0F}, kColours};
  EXPECT_THAT(glb({&part, 1}), HasSubstr(R"("COLOR_0":1)"));
}

TEST(Glb, PartsWithoutTrianglesAreLeftOut) {
  const std::array parts{Part{}, Part{kVertices, kCorners, {}, {}}};
  EXPECT_THAT(glb(parts), HasSubstr(R"("primitives":[{"attributes":{"POSITION":0},"indices":1)"));
  EXPECT_EQ(glb(std::span(parts).first(1)), "");
}

}  // namespace
}  // namespace rigwire::protocols::gltf
