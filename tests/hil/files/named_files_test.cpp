// Whatever key names a file: what stands there is refused with the key's place, and nothing waits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/csv_table.h"
#include "hil/configuration/outside_file.h"
#include "hil/files/dbc_node_file.h"
#include "hil/files/geoid_file.h"
#include "hil/files/image_file.h"
#include "hil/files/lidar_calibration_file.h"
#include "hil/files/mesh_file.h"
#include "hil/files/replay_reader.h"
#include "hil/files/settings_file.h"
#include "hil/files/valve_map_file.h"
#include "hil/record/recording.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"
#include "hil/world/sky.h"
#include "hostile_files.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::string_view kFile = "FILE";

struct NamedKey {
  std::string key;
  std::string line;  ///< Line of a rig, with FILE for the file.
  FileLimit limit;
};

std::vector<NamedKey> named_keys() {
  return {
      {"origin.include", "origin: {include: FILE}", kConfigurationFile},
      {"origin.geoid_file", "origin: {geoid: egm96, geoid_file: FILE}", kGeoidFile},
      {"satellites.file", "satellites: {file: FILE}", kSatellitesFile},
      {"scene.terrain.file", "scene: {terrain: {type: height_map, file: FILE}}", kHeightMapFile},
      {"scene.objects.0.mesh", "scene: {objects: [{name: a, mesh: FILE}]}", kMeshFile},
      {"machine.motion.file", "machine: {type: wheeled, motion: {file: FILE}}", kMotionFile},
      {"devices.a.source.file",
       "devices: {a: {type: replay, wire: pty, path: /tmp/rigwire/a, source: {file: FILE}}}",
       kReplayFile},
      {"devices.a.calibration", "devices: {a: {type: velodyne-hdl-64e, calibration: FILE}}",
       kCalibrationFile},
      {"devices.a.map", "devices: {a: {type: valve-driver, map: FILE}}", kValveMapFile},
      {"devices.a.file", "devices: {a: {type: dbc-node, bus: can, file: FILE}}", kBindingFile},
      {"devices.a.settings_file",
       "devices: {a: {type: openimu335ri, bus: can, settings_file: FILE}}", kSettingsFile},
  };
}

class NamedFiles : public testing::Test {
 protected:
  static std::string with(const std::string& line, const std::string& file) {
    std::string text = line;
    text.replace(text.find(kFile), kFile.size(), file);
    return text;
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(wires_.folder / name, std::ios::binary) << text;
    return (wires_.folder / name).string();
  }
  /// What is wrong with a rig of that line; empty: nothing.
  std::string complaints(const std::string& line) const {
    const std::string rig = write("rig.yaml", line + "\n");
    try {
      (void)load_rig(rig, {});
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  /// The begin of what is said of a key whose file stands in that line.
  [[nodiscard]] std::string place(const NamedKey& key) const {
    return (wires_.folder / "rig.yaml").string() +
           ":1:" + std::to_string(key.line.find(kFile) + 1) + ": " + key.key + ": ";
  }
  template <class Read>
  static std::string refusal(Read&& read) {
    try {
      read();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "read";
  }

  test::PrivateWires wires_;
};

TEST_F(NamedFiles, what_is_no_regular_file_is_refused_with_the_place_of_its_key) {
  for (const test::HostileFile& file : test::make_hostile_files(wires_.folder)) {
    for (const NamedKey& key : named_keys()) {
      EXPECT_THAT(complaints(with(key.line, file.path)),
                  HasSubstr(place(key) + file.path + file.refusal));
    }
  }
}

TEST_F(NamedFiles, a_file_beyond_its_limit_is_refused_with_the_place_of_its_key) {
  for (const std::uint64_t bytes : {kGibibyte, 200 * kGibibyte}) {
    const std::string file = test::make_sparse(wires_.folder / "sparse", bytes);
    for (const NamedKey& key : named_keys()) {
      if (bytes > key.limit.bytes) {
        EXPECT_THAT(complaints(with(key.line, file)),
                    HasSubstr(place(key) + file + ": too large, found " + std::to_string(bytes) +
                              " bytes, allowed at most " + size_text(key.limit.bytes)));
      }
    }
  }
}

TEST_F(NamedFiles, a_file_without_a_name_counts_as_one) {
  const int descriptor = ::memfd_create("origin", MFD_CLOEXEC);
  ASSERT_GE(descriptor, 0);
  const std::string text = "latitude: 10 deg\n";
  ASSERT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  const std::string file = "/proc/self/fd/" + std::to_string(descriptor);
  const std::string rig = write("rig.yaml", "machine: {type: wheeled}\norigin: {include: " + file +
                                                "}\nsatellites: {file: " + file + "}\n");
  const RigConfiguration configuration = load_rig(rig, {}).configuration;
  EXPECT_EQ(configuration.origin.latitude_deg, 10.0);
  EXPECT_EQ(configuration.satellites.file, file);
  ::close(descriptor);
}

TEST_F(NamedFiles, settings_that_nobody_saved_yet_are_no_fault) {
  EXPECT_EQ(
      complaints("machine: {type: excavator}\nbuses: {can: {wire: slcan}}\ndevices: {a: {type: "
                 "openimu335ri, bus: can, "
                 "settings_file: " +
                 (wires_.folder / "none").string() + "}}"),
      "");
}

TEST_F(NamedFiles, a_replayed_log_is_read_whole_and_has_less_than_a_capture) {
  const std::string file = test::make_sparse(wires_.folder / "sparse", kGibibyte);
  EXPECT_THAT(
      complaints("devices: {a: {type: replay, wire: pty, path: /tmp/rigwire/a, source: {file: " +
                 file + "}}}"),
      HasSubstr(file + ": too large, found 1073741824 bytes, allowed at most 512 MiB"));
}

TEST_F(NamedFiles, a_file_that_may_be_so_large_is_not_read_for_nothing) {
  const std::string file = test::make_sparse(wires_.folder / "sparse", kGibibyte);
  const auto refused = [&](const std::string& line) {
    return refusal([&] { check_start(load_rig(write("rig.yaml", line + "\n"), {})); });
  };
  EXPECT_THAT(refused("machine: {type: wheeled, motion: {file: " + file + "}}"),
              testing::AllOf(HasSubstr("rig.yaml:1:"), HasSubstr("machine.motion.file: " + file),
                             HasSubstr("line 1: too long")));
  EXPECT_THAT(
      refused("machine: {type: wheeled}\nscene: {terrain: {type: height_map, file: " + file + "}}"),
      testing::AllOf(HasSubstr("rig.yaml:2:"), HasSubstr("scene.terrain.file: "),
                     HasSubstr("cannot be read as TIFF")));
  EXPECT_THAT(refused("machine: {type: wheeled}\norigin: {geoid: egm96, geoid_file: " + file + "}"),
              testing::AllOf(HasSubstr("rig.yaml:2:"), HasSubstr("origin.geoid_file: geoid file")));
}

TEST_F(NamedFiles, readers_refuse_by_themselves_what_a_configuration_did_not_look_at) {
  const auto dbc_of_binding = [this](const std::string& file) {
    (void)load_dbc_node(write("node.yaml", "dbc: " + file + "\n"));
  };
  const auto replayed = [](const std::string& file) {
    ReplaySourceSettings settings;
    settings.file = file;
    (void)open_replay_reader(settings);
  };
  for (const test::HostileFile& file : test::make_hostile_files(wires_.folder)) {
    const auto expect = [&](auto&& read) {
      EXPECT_THAT(refusal(read), HasSubstr(file.refusal.substr(2))) << file.path;
    };
    expect([&] { (void)load_rig(file.path, {}); });
    expect([&] { (void)load_campaign(file.path); });
    expect([&] { (void)read_csv(file.path); });
    expect([&] { dbc_of_binding(file.path); });
    expect([&] { replayed(file.path); });
    expect([&] { (void)load_geoid(file.path, sim::GeoidInterpolation::bilinear); });
    expect([&] { (void)load_lidar_calibration(file.path); });
    expect([&] { (void)load_satellites(file.path, Calendar(RigConfiguration{}.start)); });
    expect([&] { (void)load_valve_map(file.path); });
    expect([&] { (void)read_png(file.path, "picture: "); });
    expect([&] { (void)load_mesh(file.path, "mesh"); });
    expect([&] { (void)SettingsFile(file.path); });
  }
}

TEST_F(NamedFiles, what_a_mesh_names_is_opened_likewise) {
  const std::string pipe = test::make_fifo(wires_.folder / "pipe");
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
  const auto refused = [](const std::string& file) {
    return refusal([&] { (void)load_model(file, "mesh"); });
  };
  const std::string library = write("library.obj", "mtllib pipe\n" + triangle + "f 1/1 2/1 3/1\n");
  EXPECT_THAT(refused(library), HasSubstr("not a regular file, found a FIFO"));
  EXPECT_THAT(refusal([&] { (void)load_mesh(library, "mesh"); }),
              HasSubstr("not a regular file, found a FIFO"));

  test::make_fifo(wires_.folder / "pipe.png");
  write("picture.mtl", "newmtl a\nmap_Kd pipe.png\n");
  EXPECT_THAT(refused(write("picture.obj",
                            "mtllib picture.mtl\n" + triangle + "usemtl a\nf 1/1 2/1 3/1\n")),
              HasSubstr("not a regular file, found a FIFO"));

  EXPECT_THAT(refused(write("buffer.gltf",
                            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],
"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"uri":"pipe","byteLength":36}]})")),
              HasSubstr("not a regular file, found a FIFO"));
}

TEST_F(NamedFiles, a_recording_with_a_pipe_in_it_is_refused) {
  const fs::path folder = wires_.folder / "recording";
  fs::create_directory(folder);
  test::make_fifo(folder / "recording.json");
  EXPECT_THAT(refusal([&] { (void)read_recording(folder); }),
              HasSubstr("recording.json: not a regular file, found a FIFO"));
}

}  // namespace
}  // namespace rigwire::hil
