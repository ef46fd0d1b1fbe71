#include "fields/chosen.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>

#include "fields/check.h"

namespace rigwire::fields {
namespace {

class Animal {
 public:
  virtual ~Animal() = default;
  virtual void visit(Visitor& v) = 0;
  [[nodiscard]] virtual std::unique_ptr<Animal> copy() const = 0;
};
void visit(Visitor& v, Animal& p) {
  p.visit(v);
}

struct Cat final : Animal {
  int lives = 9;
  void visit(Visitor& v) override { v.integer("lives", lives, {0, 9}, "Left."); }
  [[nodiscard]] std::unique_ptr<Animal> copy() const override {
    return std::make_unique<Cat>(*this);
  }
};
struct Dog final : Animal {
  double tail_m = 0.3;
  void visit(Visitor& v) override { v.number("tail", tail_m, in("cm").above(0), "Length."); }
  [[nodiscard]] std::unique_ptr<Animal> copy() const override {
    return std::make_unique<Dog>(*this);
  }
};

template <class Type>
std::unique_ptr<Animal> fresh() {
  return std::make_unique<Type>();
}
constexpr std::array kRows{TypeRow<Animal>{{"cat", "Purrs."}, fresh<Cat>},
                           TypeRow<Animal>{{"dog", "Barks."}, fresh<Dog>}};

using Pet = Chosen<Animal>;

Cat& cat_of(Pet& pet) {
  return dynamic_cast<Cat&>(*pet);
}

TEST(Chosen, begins_with_the_first_row) {
  const Pet pet{kRows};
  EXPECT_EQ(pet.index(), 0u);
  EXPECT_EQ(pet.type(), "cat");
  EXPECT_EQ((Pet{kRows, 1}.type()), "dog");
}

TEST(Chosen, a_copy_is_deep) {
  Pet first{kRows};
  cat_of(first).lives = 5;
  Pet second = first;
  cat_of(second).lives = 1;
  EXPECT_EQ(as<Cat>(first)->lives, 5);
  EXPECT_EQ(as<Cat>(second)->lives, 1);
  Pet third{kRows, 1};
  third = first;
  cat_of(first).lives = 3;
  EXPECT_EQ(third.type(), "cat");
  EXPECT_EQ(as<Cat>(third)->lives, 5);
}

TEST(Chosen, choosing_the_row_that_is_chosen_keeps_the_content_another_renews_it) {
  Pet pet{kRows};
  cat_of(pet).lives = 5;
  pet.choose(0);
  EXPECT_EQ(as<Cat>(pet)->lives, 5);
  pet.choose(1);
  EXPECT_EQ(pet.type(), "dog");
  EXPECT_EQ(as<Dog>(pet)->tail_m, 0.3);
  pet.choose(0);
  EXPECT_EQ(as<Cat>(pet)->lives, 9);
}

TEST(Chosen, the_content_is_of_the_rows_class_only) {
  const Pet pet{kRows};
  EXPECT_NE(as<Cat>(pet), nullptr);
  EXPECT_EQ(as<Dog>(pet), nullptr);
}

struct Home {
  Pet pet{kRows};
};
void visit(Visitor& v, Home& p) {
  visit_chosen(v, "type", p.pet, "Who lives there.");
}

TEST(Chosen, its_keys_are_checked_beside_the_key_that_chose_it) {
  Home home;
  EXPECT_NO_THROW(check(home));
  cat_of(home.pet).lives = 10;
  try {
    check(home);
    FAIL();
  } catch (const Refused& refused) {
    EXPECT_STREQ(refused.what(), "lives: found 10, allowed 0 .. 9");
  }
}

}  // namespace
}  // namespace rigwire::fields
