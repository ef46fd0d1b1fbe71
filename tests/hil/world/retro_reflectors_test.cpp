// Plates, reflectors and signs: keys of machines and scenes reach what rays meet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

class RetroReflectors : public testing::Test {
 protected:
  [[nodiscard]] MachineInScene built(const std::string& machine, const std::string& scene) const {
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR "/configs/machines/" << machine
                        << ".yaml}\nscene:\n  terrain: {type: level, size: 80 m, cell: 1 m}\n"
                        << scene;
    return build_machine_in_scene(load_rig(file.string(), {}).configuration);
  }

  rigwire::test::PrivateWires wires;
};

TEST_F(RetroReflectors, EveryMachineCarriesSome) {
  for (const char* machine : {"unimog_u5023", "gator_855d", "bomag_bw174", "excavator_ref18t",
                              "excavator_ref18t_tracks"}) {
    const MachineInScene rig = built(machine, "");
    int count = 0;
    for (sim::Scene::InstanceId i = 0; i < rig.scene->instance_count(); ++i) {
      const sim::Material& material = rig.scene->material(i);
      if (material.retro_gain > 0.0) {
        EXPECT_EQ(material.label, "marker") << machine;
        ++count;
      }
    }
    EXPECT_GE(count, 1) << machine;
  }
}

TEST_F(RetroReflectors, ASignIsSeenWithItsMaterialAndNotRunInto) {
  const MachineInScene rig =
      built("unimog_u5023",
            "  boxes:\n"
            "    - {name: sign, size: [0.02 m, 0.6 m, 0.6 m], position: [9 m, 0 m, 1 m],\n"
            "       solid: false, material: {reflectance: 0.6, label: sign, retro_gain: 0.3,\n"
            "       variation: 0.2}}\n"
            "    - {name: wall, size: [0.2 m, 2 m, 2 m], position: [20 m, 0 m, 0 m]}\n");
  ASSERT_EQ(rig.ground->obstacles().size(), 1U);
  EXPECT_EQ(rig.ground->obstacles()[0].name, "wall");
  bool found = false;
  for (sim::Scene::InstanceId i = 0; i < rig.scene->instance_count(); ++i) {
    if (rig.scene->label(i) == "sign") {
      found = true;
      EXPECT_EQ(rig.scene->material(i).retro_gain, 0.3);
      EXPECT_EQ(rig.scene->material(i).variation, 0.2);
    }
  }
  EXPECT_TRUE(found);
}

TEST_F(RetroReflectors, ALooseBoxIsSolidAndTakesNoOtherWord) {
  EXPECT_THROW((void)built("unimog_u5023",
                           "  boxes:\n"
                           "    - {name: crate, position: [9 m, 0 m, 0 m], loose: true, solid: "
                           "false}\n"),
               std::exception);
}

}  // namespace
}  // namespace rigwire::hil
