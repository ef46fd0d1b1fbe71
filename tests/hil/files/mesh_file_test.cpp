#include "hil/files/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "small_images.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto file = std::filesystem::temp_directory_path() / ("rigwire_mesh_file_test_" + name);
  std::ofstream(file) << text;
  return file;
}

TEST(MeshFile, HaulTruckHasItsSize) {
  const auto mesh = load_mesh(
      std::filesystem::path(RIGWIRE_SOURCE_DIR) / "configs/scenes/meshes/haul_truck.obj", "truck");
  EXPECT_EQ(mesh.name, "truck");
  EXPECT_GT(mesh.triangles.size(), 300U);
  Eigen::Vector3f lower = mesh.vertices[0];
  Eigen::Vector3f upper = lower;
  for (const auto& vertex : mesh.vertices) {
    lower = lower.cwiseMin(vertex);
    upper = upper.cwiseMax(vertex);
  }
  EXPECT_NEAR(lower.z(), 0.0F, 1e-3F);
  EXPECT_NEAR(upper.z(), 4.3F, 0.1F);
  EXPECT_NEAR(upper.x() - lower.x(), 8.3F, 0.2F);
  EXPECT_NEAR(upper.y() - lower.y(), 3.7F, 0.1F);
}

TEST(MeshFile, PolygonsBecomeTriangles) {
  const auto file = written("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_EQ(load_mesh(file, "square").triangles.size(), 2U);
  std::filesystem::remove(file);
}

TEST(MeshFile, MissingFileIsNamed) {
  EXPECT_THAT(
      [] { (void)load_mesh("/nowhere/truck.obj", "truck"); },
      ThrowsMessage<std::invalid_argument>(AllOf(
          HasSubstr("mesh 'truck'"), HasSubstr("/nowhere/truck.obj"), HasSubstr("no such file"))));
}

TEST(MeshFile, BadContentIsNamed) {
  const auto empty = written("empty.obj", "# nothing\n");
  const auto points = written("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
  const auto nan = written("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto garbage = written("garbage.stl", std::string(200, '\x7f'));
  for (const auto& file : {empty, points, nan, garbage}) {
    EXPECT_THAT([&] { (void)load_mesh(file, "bad"); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(file.string())))
        << file;
    std::filesystem::remove(file);
  }
}

/// A folder of this test's own, gone with it.
class ModelFile : public testing::Test {
 protected:
  ModelFile()
      : folder(std::filesystem::temp_directory_path() /
               (std::string("rigwire_model_file_") +
                testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder);
  }
  ~ModelFile() override { std::filesystem::remove_all(folder); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }

  std::filesystem::path folder;
};

/// Left half opaque, right half clear.
tests::Bytes half_clear() {
  return tests::png(2, 1, 8, 4, {10, 20, 30, 255, 10, 20, 30, 0});
}

constexpr const char* kTwoSurfaces =
    "mtllib tree.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 2\nv 1 0 2\nv 1 1 2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl bark\nf 5 6 7\nusemtl leaf\nf 1/1 2/2 3/3 4/4\n";

TEST_F(ModelFile, MaterialsBecomePartsAndAlphaBecomesHoles) {
  tests::write_file((folder / "leaf.png").string(), half_clear());
  write("tree.mtl", "newmtl bark\nKd 1 1 1\nnewmtl leaf\nmap_Kd leaf.png\n");
  const LoadedModel model = load_model(write("tree.obj", kTwoSurfaces), "tree");
  ASSERT_EQ(model.parts.size(), 2U);
  const auto& bark = model.parts[0].material == "bark" ? model.parts[0] : model.parts[1];
  const auto& leaf = model.parts[0].material == "bark" ? model.parts[1] : model.parts[0];
  EXPECT_EQ(bark.material, "bark");
  EXPECT_EQ(leaf.material, "leaf");
  EXPECT_EQ(bark.name, "tree");
  EXPECT_FALSE(bark.alpha);
  EXPECT_EQ(bark.triangles.size(), 1U);
  ASSERT_TRUE(leaf.alpha);
  EXPECT_EQ(leaf.triangles.size(), 2U);
  EXPECT_TRUE(leaf.alpha->opaque_at(0.25F, 0.5F));
  EXPECT_FALSE(leaf.alpha->opaque_at(0.75F, 0.5F));
  EXPECT_EQ(model.dropped.total(), 0U);
}

TEST_F(ModelFile, MissingTextureIsNamed) {
  write("tree.mtl", "newmtl bark\nKd 1 1 1\nnewmtl leaf\nmap_Kd leaf.png\n");
  const auto file = write("tree.obj", kTwoSurfaces);
  EXPECT_THAT([&] { (void)load_model(file, "tree"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr(file.string()), HasSubstr("texture 'leaf.png'"),
                        HasSubstr("material 'leaf'"), HasSubstr("no such file"))));
}

TEST_F(ModelFile, DamagedTextureIsNamed) {
  write("tree.mtl", "newmtl bark\nKd 1 1 1\nnewmtl leaf\nmap_Kd leaf.png\n");
  write("leaf.png", "no image");
  const auto file = write("tree.obj", kTwoSurfaces);
  EXPECT_THAT([&] { (void)load_model(file, "tree"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("texture 'leaf.png'"), HasSubstr("no PNG"))));
}

TEST_F(ModelFile, BadTrianglesAreLeftOutAndReported) {
  sim::FixedObject object;
  object.mesh = write("odd.obj",
                      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1000000 0 0\nv 2 0 0\n"
                      "f 1 2 3\nf 1 2 4\nf 1 3 5\nf 1 2 6\n")
                    .string();
  std::vector<std::string> report;
  const auto meshes = load_meshes({object, object}, report);
  ASSERT_EQ(meshes.size(), 1U);
  EXPECT_EQ(meshes[0].triangles.size(), 1U);
  ASSERT_EQ(report.size(), 1U) << "once for a file";
  EXPECT_THAT(report[0], AllOf(HasSubstr("3 triangles left out"), HasSubstr("1 not finite"),
                               HasSubstr("1 over 10000"), HasSubstr("1 without area")));
}

TEST_F(ModelFile, FileOfNothingButBadTrianglesIsRefusedWithTheCounts) {
  const auto file = write("odd.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_THAT([&] { (void)load_model(file, "odd"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr(file.string()), HasSubstr("1 without area"))));
}

TEST_F(ModelFile, GltfIsTurnedUprightWithItsEmbeddedTexture) {
  // A triangle from the origin to 2 m forward (glTF's z) and 3 m up (its y), 1 m left (its x).
  const std::vector<float> positions{0, 0, 0, 1, 0, 2, 0, 3, 0};
  const std::vector<float> coordinates{0, 0, 1, 0, 0, 1};
  const auto base64 = [](const tests::Bytes& bytes) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      std::uint32_t group = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        group = group << 8U | (i + k < bytes.size() ? bytes[i + k] : 0U);
      }
      for (std::size_t k = 0; k < 4; ++k) {
        text += i + k > bytes.size() ? '=' : kDigits[group >> (18U - 6U * k) & 63U];
      }
    }
    return text;
  };
  tests::Bytes buffer = tests::little_endian(positions);
  const tests::Bytes second = tests::little_endian(coordinates);
  buffer.insert(buffer.end(), second.begin(), second.end());
  const auto file = write(
      "leaf.gltf",
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],)"
      R"("materials":[{"name":"leaf","alphaMode":"MASK","alphaCutoff":0.25,)"
      R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
      R"("textures":[{"source":0}],"images":[{"mimeType":"image/png","uri":"data:image/png;base64,)" +
          base64(half_clear()) +
          R"("}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
          R"("min":[0,0,0],"max":[1,3,2]},{"bufferView":1,"componentType":5126,"count":3,)"
          R"("type":"VEC2"}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},)"
          R"({"buffer":0,"byteOffset":36,"byteLength":24}],"buffers":[{"byteLength":60,)"
          R"("uri":"data:application/octet-stream;base64,)" +
          base64(buffer) + R"("}]})");
  const LoadedModel model = load_model(file, "leaf");
  ASSERT_EQ(model.parts.size(), 1U);
  const sim::TriangleMesh& leaf = model.parts[0];
  EXPECT_EQ(leaf.material, "leaf");
  ASSERT_TRUE(leaf.alpha);
  EXPECT_EQ(leaf.alpha->cutoff, 64);
  Eigen::Vector3f upper = leaf.vertices[0];
  for (const auto& vertex : leaf.vertices) {
    upper = upper.cwiseMax(vertex);
  }
  EXPECT_EQ(upper, Eigen::Vector3f(2.0F, 1.0F, 3.0F)) << "forward, left, up";
}

}  // namespace
}  // namespace rigwire::hil
