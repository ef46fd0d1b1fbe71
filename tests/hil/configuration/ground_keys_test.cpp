// Keys of tyres, soils and of where soils lie.
#include <gtest/gtest.h>

#include <string>

#include "hil/configuration/reader.h"
#include "hil/configuration/soil.h"
#include "hil/configuration/tyre.h"

namespace rigwire::hil {
namespace {

template <class Struct>
std::string findings_of(const std::string& yaml, Struct& value) {
  Problems problems;
  const Value document = parse_document(yaml, "a.yaml", RIGWIRE_SOURCE_DIR, problems);
  Origins origins;
  read(document, value, problems, origins);
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += problem.line() + "\n";
  }
  return text;
}

TEST(TyreKeys, UnitsReachTheMembers) {
  sim::TyreParameters tyre;
  EXPECT_EQ(findings_of("unloaded_radius: 330 mm\nreference_pressure: 1.4 bar\n"
                        "carcass_stiffness: 20 kN/m\nslip_stiffness: 60\nrim_radius: 0.18\n",
                        tyre),
            "");
  EXPECT_EQ(tyre.unloaded_radius_m, 0.33);
  EXPECT_EQ(tyre.reference_pressure_pa, 1.4e5);
  EXPECT_EQ(tyre.carcass_stiffness_npm, 2e4);
  EXPECT_EQ(tyre.slip_stiffness_n, 6e4);
}

TEST(TyreKeys, ARimLargerThanTheTyreIsRefused) {
  sim::TyreParameters tyre;
  EXPECT_NE(findings_of("rim_radius: 0.7\n", tyre).find("rim_radius_m"), std::string::npos);
}

TEST(TyreKeys, NegativePressureIsRefusedWithItsKey) {
  sim::TyreParameters tyre;
  EXPECT_NE(findings_of("reference_pressure: -2 bar\n", tyre).find("reference_pressure"),
            std::string::npos);
}

TEST(SoilKeys, RegionsLieOnTheCellsWhoseMiddleTheyCover) {
  SoilConfiguration soils;
  EXPECT_EQ(findings_of("soils:\n"
                        "  - {name: gravel, friction: 0.6}\n"
                        "  - {name: sand, soft: true, cohesion: 2 kPa}\n"
                        "regions:\n"
                        "  - {soil: sand, center: [2 m, 1 m], size: [2 m, 2 m]}\n"
                        "  - {soil: gravel, center: [2.5 m, 0.5 m], size: [0.5, 0.5], yaw: 30}\n",
                        soils),
            "");
  EXPECT_EQ(soils.soils.at(1).cohesion_pa, 2000.0);
  sim::HeightField field;
  field.cell_m = 1.0;
  field.columns = 5;
  field.rows = 3;
  field.heights_m.assign(15, 0.0);
  const sim::SoilMap map = soil_map(soils, field);
  EXPECT_EQ(map.cells, (std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 1, 0}));
  const sim::Ground ground(field, map, {});
  EXPECT_TRUE(ground.soil(ground.at(1.5, 1.5, 1.0).soil).soft);
  EXPECT_EQ(ground.at(0.5, 0.5, 1.0).friction, 0.6);
}

TEST(SoilKeys, NamesMustFit) {
  SoilConfiguration soils;
  EXPECT_NE(findings_of("regions: [{soil: mud}]\n", soils).find("no soil is named 'mud'"),
            std::string::npos);
  soils = {};
  EXPECT_NE(findings_of("soils: [{name: a}, {name: a}]\n", soils).find("two are named 'a'"),
            std::string::npos);
  soils = {};
  EXPECT_NE(findings_of("soils: [{exponent: 3}]\n", soils).find("soils.0.exponent"),
            std::string::npos);
}

}  // namespace
}  // namespace rigwire::hil
