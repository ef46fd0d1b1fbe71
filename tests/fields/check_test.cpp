#include "fields/check.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace rigwire::fields {
namespace {

enum class Colour { red, green };
constexpr std::array<Choice<Colour>, 2> kColours{
    {{Colour::red, "red", "Warm."}, {Colour::green, "green", "Cool."}}};

struct Lens {
  double focus_m = 0.05;
};
void visit(Visitor& v, Lens& p) {
  v.number("focus", p.focus_m, in("mm").above(0).at_most(1000), "Distance of the image.");
}

struct Flash {
  static constexpr Named kNamed{"flash", "Light of its own."};
  double energy = 1.0;
};
void visit(Visitor& v, Flash& p) {
  v.number("energy", p.energy, plain().at_least(0), "Of one flash.");
}

struct Daylight {
  static constexpr Named kNamed{"daylight", "The sun."};
};
void visit(Visitor&, Daylight&) {}

struct Anywhere {
  double height_m = 0.0;
};
void visit(Visitor& v, Anywhere& p) {
  v.number("height", p.height_m, in("m"), "Without bounds.");
}

/// Two members that must go together.
struct Shutter {
  double open = 1.0;
  double closed = 2.0;
};
void visit(Visitor& v, Shutter& p) {
  v.number("open", p.open, plain().at_least(0), "Beginning.");
  v.number("closed", p.closed, plain().at_least(0), "End.");
}
void validate(const Shutter& p) {
  check(p);
  require(p.open < p.closed, "closed", shortest(p.closed), "after open, " + shortest(p.open));
}

struct Camera {
  double stroke_m = 0.5;
  std::array<double, 3> position_m{1, 2, 3};
  std::vector<double> weights{1.0};
  std::uint64_t seed = 1;
  std::uint64_t serial = 1;
  std::uint16_t port = 80;
  Colour colour = Colour::red;
  std::chrono::nanoseconds exposure{1'000'000};
  std::chrono::nanoseconds period{333'333'333};
  Lens lens;
  std::vector<Lens> spare{Lens{}, Lens{}};
  std::map<std::string, Lens> drawer{{"wide", {}}, {"zoom", {}}};
  std::variant<Flash, Daylight> light;
  Shutter shutter;
};
void visit(Visitor& v, Camera& p) {
  v.number("stroke", p.stroke_m, in("mm").between(0, 1000), "Travel.");
  v.vector3("position", p.position_m, in("m").between(-10, 10), "Place.");
  v.number_list("weights", p.weights, plain().at_least(0), "Weights.");
  v.integer("seed", p.seed, IntegerRule{0}, "Any number.");
  v.integer("serial", p.serial, IntegerRule{1, 999}, "On the plate.");
  v.integer("port", p.port, IntegerRule{1, 65535}, "Where it listens.");
  v.choice("colour", p.colour, kColours, "Of the housing.");
  v.duration("exposure", p.exposure, {1'000, 1'000'000'000}, "Of one picture.");
  v.rate("rate", p.period, in("Hz").above(0).at_most(3), "Pictures.");
  v.section("lens", p.lens, "In front.");
  v.list("spare", p.spare, "In the bag.");
  v.named("drawer", p.drawer, "lens", "At home.");
  v.group(
      "light", [&p](Visitor& keys) { keys.variant("type", p.light, "Which light."); }, "Light.");
  v.section("shutter", p.shutter, "Two curtains.");
}

/// What is wrong with it; empty when nothing is.
std::string breach(const Camera& camera) {
  try {
    check(camera);
  } catch (const Refused& refused) {
    return refused.what();
  }
  return "";
}

template <class Change>
std::string breach_after(Change change) {
  Camera camera;
  change(camera);
  return breach(camera);
}

TEST(Check, defaults_pass) {
  EXPECT_EQ(breach(Camera{}), "");
}

TEST(Check, found_and_allowed_are_in_the_written_unit) {
  EXPECT_EQ(breach_after([](Camera& p) { p.stroke_m = 1.05; }),
            "stroke: found 1050 mm, allowed 0 .. 1000 mm");
  EXPECT_EQ(breach_after([](Camera& p) { p.exposure = std::chrono::nanoseconds{999}; }),
            "exposure: found 999 ns, allowed 1 us .. 1 s");
  EXPECT_EQ(breach_after([](Camera& p) { p.port = 0; }), "port: found 0, allowed 1 .. 65535");
}

TEST(Check, bounds_themselves_pass) {
  EXPECT_EQ(breach_after([](Camera& p) {
              p.stroke_m = 1.0;
              p.exposure = std::chrono::nanoseconds{1'000};
              p.port = 65535;
              p.position_m = {-10, 10, 0};
            }),
            "");
}

TEST(Check, paths_lead_through_sections_lists_maps_and_variants) {
  EXPECT_EQ(breach_after([](Camera& p) { p.lens.focus_m = 0; }),
            "lens.focus: found 0 mm, allowed above 0 .. 1000 mm");
  EXPECT_EQ(breach_after([](Camera& p) { p.spare[1].focus_m = 2; }),
            "spare.1.focus: found 2000 mm, allowed above 0 .. 1000 mm");
  EXPECT_EQ(breach_after([](Camera& p) { p.drawer["zoom"].focus_m = 2; }),
            "drawer.zoom.focus: found 2000 mm, allowed above 0 .. 1000 mm");
  EXPECT_EQ(breach_after([](Camera& p) { std::get<Flash>(p.light).energy = -1; }),
            "light.energy: found -1, allowed >= 0");
  EXPECT_EQ(breach_after([](Camera& p) { p.position_m[2] = 11; }),
            "position.2: found 11 m, allowed -10 .. 10 m");
  EXPECT_EQ(breach_after([](Camera& p) { p.weights.push_back(-1); }),
            "weights.1: found -1, allowed >= 0");
}

TEST(Check, the_alternative_that_is_not_chosen_is_not_asked) {
  EXPECT_EQ(breach_after([](Camera& p) { p.light = Daylight{}; }), "");
}

TEST(Check, a_part_is_asked_by_its_own_validate) {
  EXPECT_EQ(breach_after([](Camera& p) {
              p.shutter = {5, 4};
            }),
            "shutter.closed: found 4, allowed after open, 5");
  EXPECT_EQ(breach_after([](Camera& p) {
              p.shutter = {-1, 4};
            }),
            "shutter.open: found -1, allowed >= 0");
}

TEST(Check, the_first_breach_in_the_order_of_keys_is_named) {
  EXPECT_EQ(breach_after([](Camera& p) {
              p.shutter = {5, 4};
              p.port = 0;
              p.lens.focus_m = 0;
            }),
            "port: found 0, allowed 1 .. 65535");
}

TEST(Check, nan_and_infinity_are_refused_with_and_without_bounds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(breach_after([](Camera& p) { p.stroke_m = std::nan(""); }),
            "stroke: found nan mm, allowed 0 .. 1000 mm");
  EXPECT_EQ(breach_after([](Camera& p) { p.weights = {kInfinity}; }),
            "weights.0: found inf, allowed >= 0");
  Anywhere place;
  place.height_m = -kInfinity;
  try {
    check(place);
    FAIL();
  } catch (const Refused& refused) {
    EXPECT_EQ(refused.path(), "height");
    EXPECT_EQ(refused.rest(), "found -inf m, allowed finite numbers");
  }
}

TEST(Check, unsigned_64_is_taken_whole) {
  constexpr auto kLargest = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(breach_after([](Camera& p) { p.seed = kLargest; }), "");
  EXPECT_EQ(breach_after([](Camera& p) { p.serial = kLargest; }),
            "serial: found 18446744073709551615, allowed 1 .. 999");
  EXPECT_EQ(breach_after([](Camera& p) { p.serial = 0; }), "serial: found 0, allowed 1 .. 999");
}

TEST(Check, an_enumeration_that_holds_none_of_its_names_is_refused) {
  EXPECT_EQ(breach_after([](Camera& p) { p.colour = static_cast<Colour>(7); }),
            "colour: holds none of its names, allowed red, green");
}

TEST(Check, the_period_of_a_rates_upper_bound_passes_although_it_is_rounded) {
  // 1/3 s is no whole number of nanoseconds: 333333333 ns are 3.000000003 Hz.
  EXPECT_EQ(breach_after([](Camera& p) { p.period = std::chrono::nanoseconds{333'333'333}; }), "");
  EXPECT_EQ(breach_after([](Camera& p) { p.period = std::chrono::nanoseconds{333'333'332}; }),
            "rate: found a period of 333333332 ns, allowed rates above 0 .. 3 Hz");
  EXPECT_EQ(breach_after([](Camera& p) { p.period = std::chrono::nanoseconds{0}; }),
            "rate: found a period of 0 s, allowed rates above 0 .. 3 Hz");
}

TEST(Check, what_joins_members_is_said_like_a_rule) {
  EXPECT_NO_THROW(require(true, "a", "1", "2"));
  try {
    require(false, "a.b", "1 mm", "above c, 2 mm");
    FAIL();
  } catch (const Refused& refused) {
    EXPECT_EQ(refused.path(), "a.b");
    EXPECT_STREQ(refused.what(), "a.b: found 1 mm, allowed above c, 2 mm");
  }
}

}  // namespace
}  // namespace rigwire::fields
