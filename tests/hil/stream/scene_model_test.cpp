#include "hil/stream/scene_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "sim/scene/scene.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::json;
using testing::StartsWith;

constexpr std::size_t kNodes = 100;  // along a side: two tiles

struct Pit {
  Pit() {
    sim::HeightField field;
    field.columns = kNodes;
    field.rows = kNodes;
    field.heights_m.assign(kNodes * kNodes, 1.0);
    scene.add_terrain(field, {});
    const auto box = scene.add_mesh(sim::make_box("box", {1.0, 2.0, 3.0}));
    Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
    X_WM.translation() = Eigen::Vector3d(5.0, 6.0, 7.0);
    crate = scene.add_object(box, X_WM, 2.0, {0.3, "crate"}, "crate 1");
    scene.add_object(box, X_WM, 1.0, {0.3, "crate"}, "crate 2");
    scene.add_body_part(scene.add_body("boom"), box, X_WM, {0.3, "steel"});
    loose = scene.add_loose_body("rock");
    scene.add_body_part(loose, box, Eigen::Isometry3d::Identity(), {0.3, "rock"});
  }
  sim::Scene scene;
  sim::Scene::InstanceId crate = 0;
  sim::Scene::BodyId loose = 0;
};

Json entity(const Json& update, std::string_view part_of_id) {
  for (const Json& one : update["entities"]) {
    if (one["id"].get<std::string>().find(part_of_id) != std::string::npos) {
      return one;
    }
  }
  return nullptr;
}

class SceneModelTest : public testing::Test {
 protected:
  Pit pit_;
  SceneModel model_{sim::contents_of(pit_.scene), 0};
};

TEST_F(SceneModelTest, EverythingIsThereWhereItStands) {
  const Json whole = Json::parse(model_.whole());
  EXPECT_EQ(whole["entities"].size(), 4 + 4U);  // tiles and things
  const Json crate = entity(whole, "crate 1");
  EXPECT_EQ(crate["frame_id"], "world");
  EXPECT_EQ(crate["models"][0]["pose"]["position"], (Json{{"x", 5}, {"y", 6}, {"z", 7}}));
  EXPECT_EQ(crate["models"][0]["scale"]["x"], 2);
  EXPECT_EQ(entity(whole, "boom")["frame_id"], "boom");
  // Alike things are one model.
  EXPECT_EQ(crate["models"][0]["url"], entity(whole, "crate 2")["models"][0]["url"]);
  EXPECT_NE(crate["models"][0]["url"], entity(whole, "rock")["models"][0]["url"]);
}

TEST_F(SceneModelTest, EveryModelIsAnAssetAndNothingElseIs) {
  const Json whole = Json::parse(model_.whole());
  for (const Json& one : whole["entities"]) {
    const auto asset = model_.asset(one["models"][0]["url"].get<std::string>());
    ASSERT_TRUE(asset) << one;
    EXPECT_THAT(*asset, StartsWith("glTF"));
  }
  for (const char* const uri :
       {"", "rigwire:", "rigwire:mesh/99", "rigwire:terrain/0/0/2/0", "rigwire:terrain/1/0/0/0",
        "rigwire:terrain/0/0", "rigwire:terrain/0/0/0/0/0", "rigwire:terrain/-1/0/0/0",
        "rigwire:terrain/99999999999999999999/0/0/0", "../etc/passwd"}) {
    EXPECT_FALSE(model_.asset(uri)) << uri;
  }
}

TEST_F(SceneModelTest, DugGroundRenewsItsTilesAlone) {
  const Json before = Json::parse(model_.whole());
  ViewChange change;
  change.dug = {.nodes = {10, 10, 11, 10}, .heights_m = {0.5, 0.25}};
  const Json update = Json::parse(model_.apply(change));
  ASSERT_EQ(update["entities"].size(), 1U);
  const Json& tile = update["entities"][0];
  const std::string url = tile["models"][0]["url"];
  const std::string old_url = entity(before, tile["id"].get<std::string>())["models"][0]["url"];
  EXPECT_NE(url, old_url);
  const auto bytes = model_.asset(url);
  EXPECT_NE(*bytes, *SceneModel(sim::contents_of(pit_.scene), 0).asset(url));
  // Whoever comes now is told of the new one.
  EXPECT_EQ(entity(Json::parse(model_.whole()), tile["id"].get<std::string>()), tile);
}

TEST_F(SceneModelTest, ANodeOnABorderRenewsBothTiles) {
  ViewChange change;
  change.dug = {.nodes = {SceneModel::kTileCells, 3, SceneModel::kTileCells, 3},
                .heights_m = {0.5}};
  EXPECT_EQ(Json::parse(model_.apply(change))["entities"].size(), 2U);
}

TEST_F(SceneModelTest, LooseBodiesAndDisplacedThingsAreWhereTheyWent) {
  ViewChange change;
  Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  there.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  change.moved.push_back({pit_.loose, there});
  change.displaced.push_back({{pit_.crate, false, 0, 0}, there});
  const Json update = Json::parse(model_.apply(change));
  const Json place{{"x", 1}, {"y", 2}, {"z", 3}};
  EXPECT_EQ(entity(update, "rock")["models"][0]["pose"]["position"], place);
  EXPECT_EQ(entity(update, "crate 1")["models"][0]["pose"]["position"], place);
  EXPECT_EQ(update["entities"].size(), 2U);
}

TEST_F(SceneModelTest, APieceOfAMeshLeavesTheRestBehind) {
  ViewChange change;
  Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  change.displaced.push_back({{pit_.crate, false, 2, 4}, there});
  const Json update = Json::parse(model_.apply(change));
  ASSERT_EQ(update["entities"].size(), 2U);
  std::vector<std::size_t> sizes;
  for (const Json& one : update["entities"]) {
    const std::string url = one["models"][0]["url"];
    const std::string file = *model_.asset(url);
    const auto at = file.find(R"("type":"SCALAR")");
    const auto count = file.rfind(R"("count":)", at);
    sizes.push_back(std::stoul(file.substr(count + 8)));
  }
  EXPECT_THAT(sizes, testing::UnorderedElementsAre(4 * 3, 8 * 3));
  // It moves on: the rest is not cut again.
  EXPECT_EQ(Json::parse(model_.apply(change))["entities"].size(), 1U);
}

}  // namespace
}  // namespace rigwire::hil
