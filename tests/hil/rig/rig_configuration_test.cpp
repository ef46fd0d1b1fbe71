// The rigs, machines and scenes of configs/, and how the parts of a rig go together.
#include "hil/rig/rig_configuration.h"
#include "hil/devices/ublox.h"
#include "hil/devices/valve_driver.h"
#include "hil/devices/velodyne.h"
#include "hil/world/machine_types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/design.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/conformance/profile_file.h"
#include "hil/files/dbc_node_file.h"
#include "hil/files/file_content.h"
#include "hil/files/valve_map_file.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kConfigs = std::string(RIGWIRE_SOURCE_DIR) + "/configs";
const std::string kRigConfigurationPit = kConfigs + "/rigs/excavator_pit.yaml";

std::string complaints(const std::vector<std::string>& sets,
                       const std::string& rig = kRigConfigurationPit) {
  try {
    (void)load_rig(rig, sets);
    return "";
  } catch (const ConfigurationError& error) {
    return error.what();
  }
}

template <class Struct>
std::string complaints_of(const fs::path& file) {
  Problems problems;
  const Value document = load_document(file.string(), problems);
  Origins origins;
  Struct value;
  read(document, value, problems, origins);
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += problem.line() + "\n";
  }
  return text;
}

TEST(Configs, every_file_is_loaded_without_a_finding) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kConfigs)) {
    if (entry.path().extension() != ".yaml") {
      continue;
    }
    ++files;
    const std::string kind = entry.path().parent_path().filename().string();
    if (kind == "rigs") {
      EXPECT_EQ(complaints({}, entry.path().string()), "");
    } else if (kind == "machines") {
      EXPECT_EQ(complaints_of<MachineConfiguration>(entry.path()), "");
    } else if (kind == "scenes") {
      EXPECT_EQ(complaints_of<SceneConfiguration>(entry.path()), "");
    } else if (kind == "valves") {
      EXPECT_NO_THROW((void)load_valve_map(entry.path()));
    } else if (kind == "can") {
      EXPECT_NO_THROW((void)load_dbc_node(entry.path()));
    } else if (kind == "engines") {
      continue;  // a cluster's, not ours
    } else if (kind == "campaigns") {
      const LoadedCampaign loaded = load_campaign(entry.path());
      EXPECT_NO_THROW((void)plan_runs(loaded.campaign));
    } else if (kind == "profiles") {
      const std::string name = entry.path().stem().string();
      if (name.starts_with("ublox_")) {
        EXPECT_NO_THROW((void)read_ubx_profile(entry.path()));
      } else if (name.starts_with("cia406_")) {
        EXPECT_NO_THROW((void)read_canopen_profile(entry.path()));
      } else if (name.starts_with("velodyne_")) {
        EXPECT_NO_THROW((void)read_velodyne_profile(entry.path()));
      } else if (name.starts_with("gige_")) {
        EXPECT_NO_THROW((void)read_gige_vision_profile(entry.path()));
      } else if (name.starts_with("iso_valves")) {
        EXPECT_NO_THROW((void)read_iso_valve_profile(entry.path()));
      } else if (name.starts_with("engine_")) {
        EXPECT_NO_THROW((void)read_j1939_profile(entry.path()));
      } else {
        EXPECT_NO_THROW((void)read_modbus_profile(entry.path()));
      }
    } else {
      ADD_FAILURE() << entry.path() << " is of no kind that a test loads";
    }
  }
  EXPECT_GE(files, 3);
}

TEST(ExcavatorPit, has_the_devices_that_the_field_program_expects) {
  const RigConfiguration rig = load_rig(kRigConfigurationPit, {}).configuration;
  std::vector<std::string> names;
  for (const auto& [name, device] : rig.devices) {
    names.push_back(name);
  }
  EXPECT_THAT(names, testing::ElementsAre("engine", "gnss", "imu_boom", "imu_bucket", "imu_chassis",
                                          "imu_stick", "lidar", "swing_encoder", "valves"));
  const auto& gnss = *fields::as<UbloxConfiguration>(rig.devices.at("gnss"));
  EXPECT_EQ(gnss.path, "/tmp/rigwire/gnss");
  EXPECT_EQ(gnss.receiver.baud, 115200u);
  const auto& lidar = *fields::as<VelodyneConfiguration>(rig.devices.at("lidar"));
  EXPECT_EQ(lidar.lidar.saved.data_port, 2368);
  EXPECT_EQ(lidar.lidar.saved.telemetry_port, 8308);
  const auto& valves = *fields::as<ValveDriverConfiguration>(rig.devices.at("valves"));
  EXPECT_EQ(valves.port, 1502);
  const std::vector<std::string> sections{"swing", "boom", "stick", "bucket"};
  EXPECT_EQ(valves.driver.amplifier.sections, sections);
}

// But for the valves, which are set for the times that machines of its class take
// (tests/sim/excavator/work_speed_test.cpp): the defaults are those of published comparisons.
TEST(ExcavatorPit, machine_file_repeats_the_defaults_of_the_reference_machine) {
  const RigConfiguration rig = load_rig(kRigConfigurationPit, {}).configuration;
  const ExcavatorMachine& machine = *fields::as<ExcavatorMachine>(rig.machine.model);
  sim::ExcavatorParameters reference;
  reference.supply.swing_relief_pressure_pa = 19e6;
  reference.swing_spool.time_constant_s = 0.08;
  reference.stick_spool.back_share = 0.62;
  reference.bucket_spool.back_share = 0.6;
  EXPECT_EQ(hash_text(outline(machine.excavator), file_content),
            hash_text(outline(reference), file_content));
}

TEST(ExcavatorPit, rate_of_the_receiver_can_be_set_on_the_command_line) {
  const RigConfiguration rig =
      load_rig(kRigConfigurationPit, {"devices.gnss.rate=5"}).configuration;
  EXPECT_EQ(fields::as<UbloxConfiguration>(rig.devices.at("gnss"))->receiver.measurement_period,
            std::chrono::milliseconds(200));
}

TEST(ExcavatorPit, printed_rig_loads_to_the_same_hash) {
  const LoadedRig rig = load_rig(kRigConfigurationPit, {"devices.gnss.rate=4", "seed=7"});
  const fs::path copy = fs::temp_directory_path() / ("rigwire_rig_" + std::to_string(::getpid()));
  std::ofstream(copy) << print_rig(rig);
  const LoadedRig again = load_rig(copy.string(), {});
  fs::remove(copy);
  EXPECT_EQ(config_hash(again.configuration), config_hash(rig.configuration));
  EXPECT_NE(config_hash(again.configuration),
            config_hash(load_rig(kRigConfigurationPit, {}).configuration));
}

TEST(ExcavatorPit, every_documented_key_can_be_set_to_its_printed_value) {
  const OutlineNode tree = outline(load_rig(kRigConfigurationPit, {}).configuration);
  const std::string hash = hash_text(tree, file_content);
  std::vector<std::string> sets;
  const auto walk = [&](auto&& self, const OutlineNode& node, const std::string& path) -> void {
    for (const OutlineNode& child : node.children) {
      const std::string below = path.empty() ? child.key : path + "." + child.key;
      const bool leaf =
          child.kind == OutlineNode::Kind::scalar || child.kind == OutlineNode::Kind::flow_list;
      if (leaf) {
        EXPECT_FALSE(child.text.empty() && !child.key.empty()) << below << " is not documented";
        sets.push_back(below + "=" + child.value);
      }
      self(self, child, below);
    }
  };
  walk(walk, tree, "");
  EXPECT_GT(sets.size(), 200u);
  EXPECT_EQ(config_hash(load_rig(kRigConfigurationPit, sets).configuration), hash);
}

TEST(BadRig, mistyped_device_and_key_on_the_command_line_are_told) {
  EXPECT_EQ(complaints({"devices.gnsss.rate=5"}),
            "--set devices.gnsss.rate=5: devices.gnsss: no such device, found \"gnsss\", allowed "
            "gnss, lidar, imu_chassis, imu_boom, imu_stick, imu_bucket, swing_encoder, engine, "
            "valves, did you mean gnss?");
  EXPECT_EQ(complaints({"devices.gnss.ratte=5"}),
            "--set devices.gnss.ratte=5: devices.gnss.ratte: unknown key, did you mean rate?");
}

TEST(BadRig, negative_rate_and_not_a_number_are_out) {
  EXPECT_EQ(complaints({"devices.gnss.rate=-5 Hz"}),
            "--set devices.gnss.rate=-5 Hz: devices.gnss.rate: out of range, found \"-5 Hz\", "
            "allowed 0.016 .. 20 Hz");
  EXPECT_THAT(complaints({"machine.excavator.boom_length=.nan"}), HasSubstr("not a finite number"));
  EXPECT_THAT(complaints({"machine.excavator.boom.mass=-1 kg"}),
              HasSubstr("allowed 0.01 .. 1000000 kg"));
  EXPECT_THAT(complaints({"machine.excavator.boom_length=5 kg"}),
              HasSubstr("wrong unit, found \"5 kg\", allowed m, km, cm, mm, um"));
}

TEST(BadRig, missing_mesh_names_the_path_tried_and_the_near_name) {
  const std::string mesh = kConfigs + "/scenes/meshes/haul_trck.obj";
  EXPECT_THAT(complaints({"scene.objects.0.mesh=" + mesh}),
              testing::AllOf(
                  HasSubstr("scene.objects.0.mesh: no such file \""), HasSubstr(", tried " + mesh),
                  HasSubstr("did you mean " + kConfigs + "/scenes/meshes/haul_truck.obj?")));
}

TEST(BadRig, mount_on_a_link_that_is_not_there) {
  EXPECT_THAT(complaints({"devices.lidar.mount.link=boon"}),
              HasSubstr("devices.lidar.mount.link: no such link of the machine, found \"boon\", "
                        "allowed undercarriage, upper, boom, stick, bucket, did you mean boom?"));
}

TEST(BadRig, line_too_slow_for_what_is_sent_is_refused_with_numbers) {
  EXPECT_THAT(complaints({"devices.gnss.baud=9600", "devices.gnss.rate=10"}),
              testing::ContainsRegex("devices.gnss: .*[0-9]+.*[0-9]+"));
  EXPECT_THAT(complaints({"buses.can.bitrate=100000"}),
              HasSubstr("buses.can.bitrate: the devices of this bus send up to 1360 frames/s"));
}

TEST(BadRig, address_serial_port_or_path_taken_twice) {
  EXPECT_THAT(complaints({"devices.imu_boom.source_address=0x80"}),
              HasSubstr("source_address: already taken by devices."));
  EXPECT_THAT(complaints({"devices.imu_boom.serial=1"}), HasSubstr("serial: already taken by"));
  EXPECT_THAT(complaints({"devices.lidar.position_port=2368"}),
              HasSubstr("devices.lidar.position_port: already taken by devices.lidar.port"));
  EXPECT_THAT(complaints({"devices.gnss.path=/tmp/rigwire/can"}),
              HasSubstr("devices.gnss.path: already taken by buses.can.path"));
}

TEST(BadRig, remote_address_needs_the_opt_in) {
  EXPECT_THAT(complaints({"devices.valves.address=0.0.0.0"}), HasSubstr("allow_remote: true"));
  EXPECT_EQ(complaints({"devices.valves.address=0.0.0.0", "devices.valves.allow_remote=true"}), "");
  EXPECT_THAT(complaints({"devices.lidar.address=localhost"}), HasSubstr("not an IPv4 address"));
}

TEST(BadRig, bus_that_is_not_there) {
  EXPECT_THAT(complaints({"devices.imu_boom.bus=cna"}),
              HasSubstr("no such bus, found \"cna\", allowed can, did you mean can?"));
}

TEST(BadRig, slice_and_lead_must_fit_the_step) {
  EXPECT_THAT(complaints({"slice=1.5 ms"}), HasSubstr("slice: must be a whole number of steps"));
  EXPECT_THAT(complaints({"lead=1 ms"}), HasSubstr("lead: must not be less than a slice"));
}

TEST(BadRig, all_findings_come_in_one_pass) {
  const std::string text =
      complaints({"devices.gnss.ratte=5", "devices.lidar.mount.link=boon",
                  "machine.excavator.boom.mass=.nan", "devices.valves.port=0"});
  EXPECT_THAT(text, HasSubstr("devices.gnss.ratte: unknown key"));
  EXPECT_THAT(text, HasSubstr("no such link of the machine"));
  EXPECT_THAT(text, HasSubstr("machine.excavator.boom.mass: not a finite number"));
  EXPECT_THAT(text, HasSubstr("devices.valves.port: out of range"));
}

TEST(BadRig, missing_rig_is_one_finding) {
  EXPECT_EQ(complaints({}, kConfigs + "/rigs/excavator_pti.yaml"),
            kConfigs + "/rigs/excavator_pti.yaml: no such file, did you mean " +
                kRigConfigurationPit + "?");
}

TEST(BadRig, size_of_the_scene_on_the_command_line_is_not_blamed_on_the_scenes_file) {
  EXPECT_THAT(complaints({"scene.terrain.size=10 m", "scene.terrain.cell=5 m"}),
              AllOf(HasSubstr("--set scene.terrain."), Not(HasSubstr("open_pit.yaml"))));
}

TEST(BadRig, payload_that_the_bucket_decides_is_refused) {
  EXPECT_THAT(complaints({"machine.excavator.payload_max=1200 kg"}),
              AllOf(HasSubstr("machine.excavator.payload_max"), HasSubstr("struck_capacity")));
}

TEST(BadRig, engines_controller_without_an_engine_is_refused) {
  EXPECT_THAT(complaints({"machine.excavator.pumps=constant"}),
              HasSubstr("devices.engine.type: the machine has no engine that drives pumps"));
}

TEST(BadRig, mesh_that_cannot_be_read_is_refused_with_key_and_file) {
  const fs::path garbage =
      fs::temp_directory_path() / ("garbage_" + std::to_string(::getpid()) + ".obj");
  std::ofstream(garbage) << "this is no mesh\n";
  EXPECT_THAT(complaints({"scene.objects.0.mesh=" + garbage.string()}),
              AllOf(HasSubstr("scene.objects.0.mesh: "), HasSubstr(garbage.string())));
  EXPECT_THAT(
      complaints({"machine.shapes=[{link: boom, type: mesh, file: " + garbage.string() + "}]"}),
      AllOf(HasSubstr("machine.shapes.0.file: "), HasSubstr(garbage.string())));
  fs::remove(garbage);
}

TEST(BadRig, scale_that_makes_a_mesh_larger_than_any_scene_is_refused_with_what_it_makes) {
  EXPECT_THAT(complaints({"scene.objects.0.scale=1e5"}),
              AllOf(HasSubstr("scene.objects.0.scale: the mesh reaches "), HasSubstr("allowed ")));
  EXPECT_THAT(complaints({"scene.objects.0.scale=1e30"}), HasSubstr("out of range"));
}

}  // namespace
}  // namespace rigwire::hil
