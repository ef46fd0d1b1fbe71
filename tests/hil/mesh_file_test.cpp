#include "hil/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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

}  // namespace
}  // namespace rigwire::hil
