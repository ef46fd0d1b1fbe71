// The roller's machine file says what the defaults are, key by key.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/machine.h"
#include "sim/roller/tandem_roller.h"

namespace rigwire::hil {
namespace {

struct RollerFile {
  std::string name;
  std::string text;
  std::string type;
  sim::RollerParameters roller;
  std::vector<LinkShape> shapes;
};

inline void visit(fields::Visitor& v, RollerFile& p) {
  v.text("name", p.name, "");
  v.text("text", p.text, "");
  v.text("type", p.type, "");
  v.section("roller", p.roller, "");
  v.list("shapes", p.shapes, "");
}

RollerFile blank() {
  RollerFile file;
  sim::RollerParameters& p = file.roller;
  p.level = sim::RollerLevel::kinematic;
  p.mass_kg = p.yaw_inertia_kgm2 = p.pivot_x_m = p.center_of_mass_height_m = 1.0;
  p.solid = {.boxes = {}, .stiffness_npm = 1.0, .damping_ratio = 0.0};
  return file;
}

TEST(RollerConfiguration, MachineFileHoldsTheDefaultsAndShapesOnItsLinks) {
  Problems problems;
  Origins origins;
  const Value document = load_document(
      std::string(RIGWIRE_SOURCE_DIR) + "/configs/machines/bomag_bw174.yaml", problems);
  RollerFile file = blank();
  read(document, file, problems, origins);
  problems.throw_if_any();
  EXPECT_EQ(file.type, "tandem_roller");
  EXPECT_EQ(file.roller, sim::RollerParameters{});
  EXPECT_FALSE(file.shapes.empty());
  for (const LinkShape& shape : file.shapes) {
    EXPECT_NE(std::find(sim::kRollerLinks.begin(), sim::kRollerLinks.end(), shape.link),
              sim::kRollerLinks.end())
        << shape.link;
  }
}

}  // namespace
}  // namespace rigwire::hil
