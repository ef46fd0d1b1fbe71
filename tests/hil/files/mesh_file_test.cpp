#include "hil/files/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sim/scene/colour_texture.h"
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

TEST(MeshFile, PolygonsOfPlyBecomeTrianglesInTextAndInBinary) {
  const std::string rest =
      "element vertex 4\nproperty float x\nproperty double y\nproperty float32 z\n"
      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property list uchar float quality\nend_header\n";
  const auto text =
      written("square.ply", "ply\nformat ascii 1.0\ncomment by hand\n" + rest +
                                "0 0 0 1\n2 0 0 1\n2 1 0 1\n\n0 1 0.5 1\n4 0 1 2 3 1 0.5\n");
  std::string binary = "ply\nformat binary_big_endian 1.0\n" + rest;
  const auto put = [&binary](auto value) {
    std::array<char, sizeof(value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(value));
    binary.append(bytes.rbegin(), bytes.rend());
  };
  for (const auto& [x, y, z] :
       {std::array{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.0, 1.0, 0.0}, {0.0, 1.0, 0.5}}) {
    put(static_cast<float>(x));
    put(y);
    put(static_cast<float>(z));
    binary += '\1';
  }
  binary += '\4';
  for (const std::int32_t corner : {0, 1, 2, 3}) {
    put(corner);
  }
  binary += '\0';
  const auto big = written("big.ply", binary);
  for (const auto& file : {text, big}) {
    const auto mesh = load_mesh(file, "square");
    ASSERT_EQ(mesh.triangles.size(), 2U) << file;
    EXPECT_EQ(mesh.vertices[3], Eigen::Vector3f(0.0F, 1.0F, 0.5F));
    EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
    const LoadedModel model = load_model(file, "square");
    ASSERT_EQ(model.parts.size(), 1U);
    EXPECT_EQ(model.parts.front().name, "square");
    EXPECT_EQ(mesh_files(file), std::vector<std::string>{file.string()});
    std::filesystem::remove(file);
  }
}

TEST(MeshFile, APlyThatIsNoneIsRefusedWithItsPlace) {
  const auto refusal = [](const std::string& content) -> std::string {
    const auto file = written("bad.ply", content);
    try {
      (void)load_mesh(file, "bad");
    } catch (const std::invalid_argument& error) {
      std::filesystem::remove(file);
      return error.what();
    }
    return "taken";
  };
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_index\n";
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(refusal("nonsense\n"), HasSubstr("(line 1)"));
  EXPECT_THAT(refusal(head), HasSubstr("ends early"));
  EXPECT_THAT(refusal(head + "end_header\n" + three), HasSubstr("do not fit into the file"));
  EXPECT_THAT(refusal(head + "end_header\n" + three + "3 0 1 3\n"),
              HasSubstr("a face has vertex 3, allowed 0 to 2"));
  EXPECT_THAT(refusal(head + "end_header\n" + three + "3 0 1 -1\n"), HasSubstr("found -1"));
  EXPECT_THAT(refusal(head + "end_header\n" + three + "4000000 0 1\n"), HasSubstr("does not fit"));
  EXPECT_THAT(refusal(head + "end_header\n0 0 zero\n"),
              HasSubstr("no number, found \"zero\" (line 10)"));
  EXPECT_THAT(
      refusal("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n"),
      HasSubstr("do not fit into the file"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nproperty flout x\nend_header\n"),
              HasSubstr("property"));
}

TEST(MeshFile, OtherFormatsAreRefusedByNameAndByContent) {
  for (const char* name : {"mesh.3mf", "mesh.m3d", "mesh.bin", "mesh"}) {
    const auto file = written(name, "anything");
    EXPECT_THAT(
        [&] { (void)load_mesh(file, "mesh"); },
        ThrowsMessage<std::invalid_argument>(HasSubstr("allowed .gltf, .glb, .obj, .stl, .ply")));
    std::filesystem::remove(file);
  }
  // A file of a format that is not read, under a name of one that is: found by its content it would
  // be given to another reader.
  const auto disguised = written("disguised.stl", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_THROW((void)load_mesh(disguised, "mesh"), std::invalid_argument);
  std::filesystem::remove(disguised);
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

constexpr const char* kSquare =
    "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl sign board\nf 1/1 2/2 3/3 4/4\n";

std::array<float, 3> seen_at(const sim::MeshColour& colour, float u, float v) {
  return colour.texture->mean(u, v, {}, colour.edge_u, colour.edge_v);
}
constexpr auto kWhite =
    static_cast<float>(static_cast<std::uint16_t>(65535 * sim::ColourTexture::kMostAlbedo)) /
    65535.0F;

TEST_F(ModelFile, PictureIsUprightAndLinear) {
  // Red and green above, blue and a middle grey below.
  tests::write_file((folder / "sign.png").string(),
                    tests::png(2, 2, 8, 3, {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188}));
  write("square.mtl", "newmtl sign board\nKd 1 0.5 1\nmap_Kd sign.png\n");
  const LoadedModel model = load_model(write("square.obj", kSquare), "square");
  ASSERT_EQ(model.parts.size(), 1U);
  const sim::TriangleMesh& part = model.parts[0];
  EXPECT_EQ(part.material, "sign board");
  ASSERT_TRUE(part.colour && part.colour->texture);
  EXPECT_FALSE(part.alpha);
  EXPECT_EQ(part.colour->factor, (std::array{1.0F, 0.5F, 1.0F}));
  EXPECT_EQ(seen_at(*part.colour, 0.25F, 0.75F), (std::array{kWhite, 0.0F, 0.0F})) << "top left";
  EXPECT_EQ(seen_at(*part.colour, 0.75F, 0.75F), (std::array{0.0F, kWhite, 0.0F})) << "top right";
  EXPECT_EQ(seen_at(*part.colour, 0.25F, 0.25F), (std::array{0.0F, 0.0F, kWhite})) << "below";
  // ((188/255 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(seen_at(*part.colour, 0.75F, 0.25F)[1], 0.50289, 2e-5);
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    EXPECT_EQ(part.texture_coordinates[i], part.vertices[i].head<2>()) << i;
  }
  EXPECT_TRUE(model.notes.empty());
}

TEST_F(ModelFile, OptionsOfAMapMoveScaleAndClampIt) {
  tests::write_file((folder / "sign.png").string(), tests::png(2, 1, 8, 1, {0, 255}));
  write("square.mtl", "newmtl sign board\nmap_Kd -s 2 3 1 -o 0.25 -clamp on -mm 0 1 sign.png\n");
  const LoadedModel model = load_model(write("square.obj", kSquare), "square");
  const sim::TriangleMesh& part = model.parts.at(0);
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    EXPECT_EQ(part.texture_coordinates[i],
              Eigen::Vector2f(2.0F * part.vertices[i].x() + 0.25F, 3.0F * part.vertices[i].y()));
  }
  EXPECT_EQ(seen_at(*part.colour, 2.3F, 0.5F)[0], kWhite) << "the edge goes on";
  EXPECT_EQ(seen_at(*part.colour, -1.3F, 0.5F)[0], 0.0F);
  ASSERT_EQ(model.notes.size(), 1U);
  EXPECT_THAT(model.notes[0], AllOf(HasSubstr("square.mtl:2"), HasSubstr("'-mm' has no effect")));
}

TEST_F(ModelFile, ColourWithoutPictureCountsWhereTheLibrarySaysIt) {
  write("square.mtl", "newmtl sign board\nKd 0.2 0.4 0.6\n");
  const LoadedModel model = load_model(write("square.obj", kSquare), "square");
  ASSERT_TRUE(model.parts.at(0).colour);
  EXPECT_FALSE(model.parts[0].colour->texture);
  EXPECT_EQ(model.parts[0].colour->factor, (std::array{0.2F, 0.4F, 0.6F}));
  write("square.mtl", "newmtl sign board\nKs 1 1 1\n");
  EXPECT_FALSE(load_model(folder / "square.obj", "square").parts.at(0).colour);
}

TEST_F(ModelFile, LibraryInAnotherFolderHasItsPicturesBesideIt) {
  std::filesystem::create_directories(folder / "paint");
  tests::write_file((folder / "paint/sign.png").string(), tests::png(1, 1, 8, 1, {255}));
  write("paint/square.mtl", "newmtl sign board\nmap_Kd sign.png\n");
  std::string text = kSquare;
  text.replace(text.find("square.mtl"), 10, "paint/square.mtl");
  const auto file = write("square.obj", text);
  EXPECT_TRUE(load_model(file, "square").parts.at(0).colour);
  EXPECT_EQ(mesh_files(file), (std::vector{file.string(), (folder / "paint/square.mtl").string(),
                                           (folder / "paint/sign.png").string()}));
}

TEST_F(ModelFile, TexelsInHolesDoNotColourWhatIsLeft) {
  // White where it is opaque, black where it is clear.
  tests::write_file((folder / "sign.png").string(),
                    tests::png(2, 1, 8, 4, {255, 255, 255, 255, 0, 0, 0, 0}));
  write("square.mtl", "newmtl sign board\nmap_Kd sign.png\n");
  const LoadedModel model = load_model(write("square.obj", kSquare), "square");
  ASSERT_TRUE(model.parts.at(0).alpha);
  const sim::MeshColour& colour = *model.parts[0].colour;
  EXPECT_EQ(seen_at(colour, 0.5F, 0.5F)[1], kWhite) << "halfway to a hole";
  EXPECT_EQ(colour.texture->mean(0.5F, 0.5F, {9, 0, 0, 9}, colour.edge_u, colour.edge_v)[1],
            kWhite);
}

TEST_F(ModelFile, PicturesOfOtherFormatsAreNoted) {
  write("square.mtl", "newmtl sign board\nmap_Kd sign.jpg\n");
  const LoadedModel model = load_model(write("square.obj", kSquare), "square");
  EXPECT_FALSE(model.parts.at(0).colour);
  ASSERT_EQ(model.notes.size(), 1U);
  EXPECT_THAT(model.notes[0], AllOf(HasSubstr("sign.jpg"), HasSubstr("square.mtl:2"),
                                    HasSubstr("no PNG"), HasSubstr("no effect")));
}

TEST_F(ModelFile, WhatTexturesCannotBeIsRefusedWithFileAndLine) {
  struct Case {
    std::string mesh, library;
    std::vector<std::string> said;
  };
  const std::string picture = "newmtl sign board\nmap_Kd sign.png\n";
  const std::string square = kSquare;
  const std::size_t at_faces = square.find("f 1/1");
  const std::string before = square.substr(0, at_faces);
  const std::vector<Case> cases{
      {before + "f 1/1 2/2 3/9\n", picture, {"square.obj:11", "coordinate 9", "1 to 4"}},
      {before + "f 1/1 2/2 3/-5\n", picture, {"square.obj:11", "coordinate -5", "-1 to -4"}},
      {before + "f 1/1 2/2 0/3\n", picture, {"square.obj:11", "vertex 0", "1 to 4"}},
      {before + "f 1/1 2/2 3/x\n", picture, {"square.obj:11", "'x'", "vertex/texture coordinate"}},
      {before + "f 1/1 2/2 3/3\nf 1 3 4\n",
       picture,
       {"sign.png", "'sign board'", "line 12", "coordinates"}},
      {before + "f 1 2 3\n", picture, {"sign.png", "line 11", "coordinates"}},
      {"vt nan 0\n" + square, picture, {"square.obj:1", "'nan'", "finite"}},
      {"vt\n" + square, picture, {"square.obj:1", "nothing"}},
      {square, "Kd 1 1 1\n" + picture, {"square.mtl:1", "newmtl"}},
      {square, "newmtl a\nKd 1 2 1\n", {"square.mtl:2", "found 2", "0 to 1"}},
      {square, "newmtl a\nKd 1 1\n", {"square.mtl:2", "red, green and blue"}},
      {square, "newmtl a\nKd spectral a.rfl\n", {"square.mtl:2", "'spectral'"}},
      {square, "newmtl a\nmap_Kd -clamp\n", {"square.mtl:2", "on, off"}},
      {square, "newmtl a\nmap_Kd -s sign.png\n", {"square.mtl:2", "one to three numbers"}},
      {square, "newmtl a\nmap_Kd -o 1e999 sign.png\n", {"square.mtl:2"}},
      {square, "newmtl a\nmap_Kd -swirl 3 sign.png\n", {"square.mtl:2", "'-swirl'", "-clamp"}},
      {square, "newmtl a\nmap_Kd -s 1\n", {"square.mtl:2", "no file"}},
      {square,
       "newmtl sign board\nmap_Kd none.png\n",
       {"none.png", "square.mtl:2", "no such file"}},
      {square,
       "newmtl sign board\nmap_Kd long.png\n",
       {"long.png", "square.mtl:2", "9000 x 1", "1 to 8192"}},
      {square, "newmtl sign board\nmap_Kd empty.png\n", {"empty.png", "square.mtl:2", "damaged"}},
      {square, "newmtl sign board\nmap_Kd huge.png\n", {"huge.png", "square.mtl:2", "16384"}},
  };
  tests::write_file((folder / "sign.png").string(), tests::png(1, 1, 8, 1, {255}));
  tests::write_file((folder / "long.png").string(),
                    tests::png(9000, 1, 8, 1, std::vector<std::uint16_t>(9000)));
  tests::write_file((folder / "empty.png").string(), tests::png(0, 0, 8, 1, {}));
  tests::write_file((folder / "huge.png").string(),
                    tests::png(20000, 1, 8, 1, std::vector<std::uint16_t>(20000)));
  for (const Case& bad : cases) {
    write("square.mtl", bad.library);
    const auto file = write("square.obj", bad.mesh);
    try {
      (void)load_model(file, "square");
      ADD_FAILURE() << "taken:\n" << bad.mesh << bad.library;
    } catch (const std::invalid_argument& error) {
      for (const std::string& said : bad.said) {
        EXPECT_THAT(error.what(), HasSubstr(said)) << bad.mesh << bad.library;
      }
    }
  }
  std::filesystem::remove(folder / "square.mtl");
  EXPECT_THAT([&] { (void)load_model(write("square.obj", square), "square"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("square.obj:1"), HasSubstr("'square.mtl'"))));
  EXPECT_EQ(load_mesh(folder / "square.obj", "square").triangles.size(), 2U)
      << "links need no library";
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
  ASSERT_TRUE(leaf.colour && leaf.colour->texture);
  EXPECT_NEAR(seen_at(*leaf.colour, 0.25F, 0.5F)[2], sim::linear_of_srgb(30.0 / 255.0), 1e-5);
}

}  // namespace
}  // namespace rigwire::hil
