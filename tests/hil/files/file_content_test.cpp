// What a file brings into a run counts in the hash, wherever it lies: its own bytes, and those of
// the files that it names.
#include "hil/files/file_content.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "private_wires.h"
#include "small_images.h"

namespace rigwire::hil {
namespace {

using fields::FileKind;
namespace fs = std::filesystem;

constexpr const char* kFileContentDbc =
    "BU_: SENSOR\n"
    "BO_ 100 Angles: 8 SENSOR\n"
    " SG_ Angle : 0|16@1- (0.01,0) [-300|300] \"deg\" SENSOR\n";

class FileContent : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const fs::path file = wires_.folder / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }
  rigwire::test::PrivateWires wires_;
};

TEST_F(FileContent, the_dbc_file_of_a_binding_counts_and_its_place_does_not) {
  write("a/node.dbc", kFileContentDbc);
  const std::string binding = write("a/node.yaml", "dbc: node.dbc\nnode: SENSOR\n");
  const std::string before = file_content(binding, FileKind::dbc_node);
  write("b/other.dbc", kFileContentDbc);
  const std::string elsewhere = write("b/node.yaml", "# moved\nnode: SENSOR\ndbc: other.dbc\n");
  EXPECT_EQ(file_content(elsewhere, FileKind::dbc_node), before);
  write("a/node.dbc",
        std::string(kFileContentDbc) + "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 1000;\n");
  EXPECT_NE(file_content(binding, FileKind::dbc_node), before);
}

TEST_F(FileContent, what_a_file_includes_counts) {
  write("node.dbc", kFileContentDbc);
  write("common.yaml", "processing_delay: 1 ms\n");
  const std::string binding = write("node.yaml", "include: common.yaml\ndbc: node.dbc\n");
  const std::string before = file_content(binding, FileKind::dbc_node);
  write("common.yaml", "processing_delay: 1000 us\n");
  EXPECT_EQ(file_content(binding, FileKind::dbc_node), before);
  write("common.yaml", "processing_delay: 2 ms\n");
  EXPECT_NE(file_content(binding, FileKind::dbc_node), before);

  const std::string registers =
      "always_enabled: true\nregisters: [{name: set, table: holding, "
      "address: 0, access: write, signal: command, initial: ";
  write("map.yaml", registers + "1}]\n");
  const std::string map = write("mine.yaml", "include: map.yaml\nname: mine\n");
  const std::string one = file_content(map, FileKind::valve_map);
  write("map.yaml", registers + "2}]\n");
  EXPECT_NE(file_content(map, FileKind::valve_map), one);
}

TEST_F(FileContent, materials_and_textures_of_a_mesh_count) {
  const auto leaf = [](std::uint8_t alpha) {
    return tests::png(2, 1, 8, 4, {10, 20, 30, 255, 10, 20, 30, alpha});
  };
  const std::string mesh = write("tree.obj",
                                 "mtllib tree.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\n"
                                 "vt 1 1\nusemtl leaf\nf 1/1 2/2 3/3\n");
  write("tree.mtl", "newmtl leaf\nmap_Kd leaf.png\n");
  tests::write_file((wires_.folder / "leaf.png").string(), leaf(0));
  const std::string before = file_content(mesh, FileKind::mesh);
  EXPECT_EQ(file_content(mesh, FileKind::mesh), before);
  tests::write_file((wires_.folder / "leaf.png").string(), leaf(200));
  const std::string denser = file_content(mesh, FileKind::mesh);
  EXPECT_NE(denser, before);
  write("tree.mtl", "newmtl leaf\n");
  EXPECT_NE(file_content(mesh, FileKind::mesh), denser);
}

TEST_F(FileContent, what_a_device_has_saved_counts_once_there_is_any) {
  const std::string file = (wires_.folder / "memory").string();
  EXPECT_EQ(file_content(file, FileKind::memory), file_content("", FileKind::memory));
  write("memory", "saved");
  const std::string saved = file_content(file, FileKind::memory);
  EXPECT_NE(saved, file_content("", FileKind::memory));
  write("memory", "other");
  EXPECT_NE(file_content(file, FileKind::memory), saved);
}

TEST_F(FileContent, a_file_that_is_not_of_its_kind_counts_by_its_bytes) {
  const std::string file = write("file", "no mesh and no map");
  const std::string bytes = file_content(file, FileKind::data);
  EXPECT_EQ(file_content(file, FileKind::mesh), bytes);
  EXPECT_EQ(file_content(file, FileKind::valve_map), bytes);
  EXPECT_EQ(file_content(write("other", "no mesh and no map"), FileKind::data), bytes);
  EXPECT_NE(file_content(write("other", "else"), FileKind::data), bytes);
}

}  // namespace
}  // namespace rigwire::hil
