#include "fields/visitor.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "fields/check.h"

namespace rigwire::fields {
namespace {

TEST(Integers, a_rule_is_narrowed_to_what_the_member_holds) {
  EXPECT_EQ(narrowed<std::uint8_t>({}).lower, 0);
  EXPECT_EQ(narrowed<std::uint8_t>({}).upper, 255);
  EXPECT_EQ(narrowed<std::int16_t>({-5, 100'000}).lower, -5);
  EXPECT_EQ(narrowed<std::int16_t>({-5, 100'000}).upper, 32767);
  EXPECT_EQ(narrowed<std::uint64_t>({}).lower, 0);
  EXPECT_EQ(narrowed<std::uint64_t>({}).upper, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(narrowed<std::int64_t>({}).lower, std::numeric_limits<std::int64_t>::min());
}

/// Doubles every number and notes the keys.
class Doubling final : public Visitor {
 public:
  std::vector<std::string> seen;

  void required(std::string_view) override {}
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view choice, std::string_view needs,
                   const Part& keys) override {
    seen.push_back(std::string(choice) + (holds ? " is " : " is not ") + std::string(needs));
    keys.show(*this);
  }
  void check(bool, std::string_view, const std::string&, const std::string&,
             const std::string&) override {}
  void number(std::string_view key, double& value, const NumberRule&, std::string_view) override {
    note(key);
    value *= 2.0;
  }
  void numbers(std::string_view key, std::span<double> values, const NumberRule&,
               std::string_view) override {
    note(std::string(key) + ":" + std::to_string(values.size()));
    for (double& value : values) {
      value *= 2.0;
    }
  }
  void number_list(std::string_view, std::vector<double>&, const NumberRule&,
                   std::string_view) override {}
  void whole(std::string_view key, std::int64_t& value, const IntegerRule&, bool,
             std::string_view) override {
    note(key);
    value *= 2;
  }
  void boolean(std::string_view, bool&, std::string_view) override {}
  void text(std::string_view, std::string&, std::string_view) override {}
  void texts(std::string_view, std::vector<std::string>&, std::string_view) override {}
  void file(std::string_view, std::string&, FileKind, std::string_view) override {}
  void duration(std::string_view, std::chrono::nanoseconds&, const DurationRule&,
                std::string_view) override {}
  void rate(std::string_view, std::chrono::nanoseconds&, const NumberRule&,
            std::string_view) override {}
  void spelled(std::string_view, const Spelling&, std::string_view) override {}
  void pick(std::string_view key, std::size_t& index, std::span<const Named>,
            std::string_view) override {
    note(key);
    index = index == kNoChoice ? kNoChoice : 1;
  }
  void part(std::string_view key, const Part& part, std::string_view) override {
    const std::string above = above_;
    above_ += std::string(key) + ".";
    part.show(*this);
    above_ = above;
  }
  void elements(std::string_view, Elements&, std::string_view) override {}
  void members(std::string_view, Members&, std::string_view, std::string_view) override {}
  void alternatives(std::string_view, Alternatives&, std::string_view) override {}

 private:
  void note(std::string_view key) { seen.push_back(above_ + std::string(key)); }
  std::string above_;
};

struct Point {
  double x;
  double y;
  double z;
};

TEST(Vectors, of_every_shape_are_read_and_written_back) {
  Doubling v;
  std::vector<double> pair{1, 2};
  v.vector2("pair", pair, in("m"), "");
  EXPECT_EQ(pair, (std::vector<double>{2, 4}));
  std::array<double, 3> indexed{1, 2, 3};
  v.vector3("indexed", indexed, in("m"), "");
  EXPECT_EQ(indexed, (std::array<double, 3>{2, 4, 6}));
  Point named{1, 2, 3};
  v.vector3("named", named, in("m"), "");
  EXPECT_EQ(named.x, 2);
  EXPECT_EQ(named.y, 4);
  EXPECT_EQ(named.z, 6);
  EXPECT_EQ(v.seen, (std::vector<std::string>{"pair:2", "indexed:3", "named:3"}));
}

TEST(Groups, keys_of_the_structure_stand_under_a_key_of_their_own) {
  double near = 1;
  double far = 2;
  const auto keys = [&](Visitor& w) {
    w.number("near", near, in("m").at_least(0), "");
    w.group(
        "deeper", [&](Visitor& x) { x.number("far", far, in("m"), ""); }, "");
  };
  Doubling v;
  v.group("range", keys, "");
  EXPECT_EQ(near, 2);
  EXPECT_EQ(far, 4);
  EXPECT_EQ(v.seen, (std::vector<std::string>{"range.near", "range.deeper.far"}));
}

TEST(Groups, are_checked_with_their_key_in_the_path) {
  struct Window {
    double near = -1;
  };
  Window window;
  const auto keys = [&](Visitor& w) {
    w.group(
        "range", [&](Visitor& x) { x.number("near", window.near, in("m").at_least(0), ""); }, "");
  };
  detail::Group<decltype(keys)> group{keys};
  try {
    check_part(Part::of(group));
    FAIL();
  } catch (const Refused& refused) {
    EXPECT_EQ(refused.path(), "range.near");
  }
}

TEST(Groups, that_are_conditional_stand_beside_the_choice) {
  double speed = 1;
  Doubling v;
  v.only_if(false, "drive", "motor", [&](Visitor& w) { w.number("speed", speed, in("m/s"), ""); });
  EXPECT_EQ(speed, 2);
  EXPECT_EQ(v.seen, (std::vector<std::string>{"drive is not motor", "speed"}));
}

TEST(Choices, a_member_that_holds_no_name_is_left_as_it_is) {
  enum class Side { left, right };
  constexpr std::array<Choice<Side>, 2> kSides{
      {{Side::left, "left", ""}, {Side::right, "right", ""}}};
  Doubling v;
  Side side = Side::left;
  v.choice("side", side, kSides, "");
  EXPECT_EQ(side, Side::right);
  side = static_cast<Side>(5);
  v.choice("side", side, kSides, "");
  EXPECT_EQ(side, static_cast<Side>(5));
}

TEST(Integers, of_all_widths_are_read_and_written_back) {
  Doubling v;
  std::uint8_t small = 100;
  std::int64_t large = -5'000'000'000;
  v.integer("small", small, {}, "");
  v.integer("large", large, {}, "");
  EXPECT_EQ(small, 200);
  EXPECT_EQ(large, -10'000'000'000);
}

}  // namespace
}  // namespace rigwire::fields
