#include "hil/executive/shelves.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "allocation_counter.h"

namespace rigwire::hil {
namespace {

using Texts = std::vector<std::string>;
using Numbers = std::vector<int>;

TEST(Shelves, KeepStationsAndTypesApart) {
  Shelves shelves;
  shelves.of<int>(2).push_back(7);
  shelves.of<std::string>(2).push_back("seven");
  shelves.of<int>(0).push_back(8);
  ASSERT_NE(shelves.find<int>(2), nullptr);
  EXPECT_EQ(*shelves.find<int>(2), Numbers{7});
  EXPECT_EQ(*shelves.find<std::string>(2), Texts{"seven"});
  EXPECT_EQ(*shelves.find<int>(0), Numbers{8});
  EXPECT_EQ(shelves.find<std::string>(0), nullptr);
  EXPECT_EQ(shelves.find<unsigned>(2), nullptr) << "another type, although of the same size";
  EXPECT_EQ(shelves.find<int>(1), nullptr);
  EXPECT_EQ(shelves.find<int>(100), nullptr);
  EXPECT_EQ(shelves.size(), 3U);
}

TEST(Shelves, AShelfStaysWhereItIsWhileOthersAreMade) {
  Shelves shelves;
  Numbers& first = shelves.of<int>(0);
  for (StationIndex station = 1; station < 100; ++station) {
    shelves.of<int>(station).push_back(1);
    shelves.of<double>(0).push_back(0.5);
  }
  first.push_back(42);
  EXPECT_EQ(&shelves.of<int>(0), &first);
  const Shelves moved = std::move(shelves);
  EXPECT_EQ(moved.find<int>(0), &first);
  EXPECT_EQ(first, Numbers{42});
}

TEST(Shelves, ClearedOnesAreEmptyAndKeepTheirMemory) {
  Shelves shelves;
  EXPECT_TRUE(shelves.empty());
  shelves.of<int>(3).resize(1000);
  EXPECT_FALSE(shelves.empty());
  shelves.clear();
  EXPECT_TRUE(shelves.empty());
  ASSERT_NE(shelves.find<int>(3), nullptr);
  EXPECT_TRUE(shelves.find<int>(3)->empty());
  EXPECT_GE(shelves.find<int>(3)->capacity(), 1000U);
}

TEST(Shelves, MovedThingsComeBehindThoseThatLieThere) {
  Shelves from;
  Shelves to;
  to.of<int>(1) = {1, 2};
  from.of<int>(1) = {3, 4};
  from.of<std::string>(5) = {"five"};
  from.of<double>(0);
  from.move_to(to);
  EXPECT_TRUE(from.empty());
  EXPECT_EQ(*to.find<int>(1), (Numbers{1, 2, 3, 4}));
  EXPECT_EQ(*to.find<std::string>(5), Texts{"five"});
  EXPECT_EQ(to.find<double>(0), nullptr) << "nothing was moved there";
}

TEST(Shelves, MoveWhatCannotBeCopied) {
  Shelves from;
  Shelves to;
  from.of<std::unique_ptr<int>>(0).push_back(std::make_unique<int>(9));
  from.move_to(to);
  ASSERT_EQ(to.size(), 1U);
  EXPECT_EQ(*to.find<std::unique_ptr<int>>(0)->front(), 9);
}

TEST(Shelves, DoNotAllocateOnceTheyHaveBeenAsFullAsTheyGet) {
  Shelves down;
  Shelves up;
  Shelves posted;
  const auto slice = [&] {
    down.clear();
    for (StationIndex station = 0; station < 8; ++station) {
      Numbers& numbers = down.of<int>(station);
      for (int i = 0; i < 100; ++i) {
        numbers.push_back(i);
      }
      down.of<double>(station).push_back(1.0);
      up.of<double>(station).push_back(2.0);
    }
    up.move_to(posted);
    const std::size_t moved = posted.size();
    posted.clear();
    return moved;
  };
  (void)slice();
  const auto before = rigwire::test::allocations();
  std::size_t moved = 0;
  for (int i = 0; i < 1000; ++i) {
    moved += slice();
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_EQ(moved, 8000U);
}

}  // namespace
}  // namespace rigwire::hil
