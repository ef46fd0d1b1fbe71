// Every message of the vehicle: each field over its whole range, what saturates, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "protocols/j1939/message.h"
#include "protocols/vehicle/brake.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/implement.h"
#include "protocols/vehicle/joystick.h"
#include "protocols/vehicle/machine.h"
#include "protocols/vehicle/position.h"
#include "protocols/vehicle/speed.h"
#include "protocols/vehicle/steering.h"
#include "protocols/vehicle/transmission.h"
#include "protocols/vehicle/tyre.h"

namespace rigwire::protocols::vehicle {
namespace {

template <class Message>
class VehicleMessage : public testing::Test {};

using Messages = testing::Types<
    Ebc1, Ebc2, Hrw, Ccvs1, WheelBasedSpeed, MachineSelectedSpeed, MachineSelectedSpeedCommand,
    Eec1, Eec2, Tsc1, Etc1, Etc2, Tc1, Eac1, Xbr, Vdc2, Esc1, GuidanceMachineInfo, GuidanceCommand,
    Tire1, Tire2, TyreReference<kTpri, 3190>, TyreReference<kTprs, 3192>, Hpg,
    MachineFunctionCommand, MachineFunctionState, Sas, GroundBasedSpeed, Tp1,
    ChannelPressures<kTp2>, ChannelPressures<kTp3>, Eflp1, Et1, Dd1, VehicleFluids, Hours,
    BasicJoystick<1>, BasicJoystick<2>, ExtendedJoystick<1>, ExtendedJoystick<2>, VehiclePosition,
    VehicleDirectionSpeed, VehiclePosition2, Eec3, Vep1, Lfe1, Lfc1, RearHitchStatus,
    FrontHitchStatus, RearPowerTakeOffStatus, FrontPowerTakeOffStatus, HitchPowerTakeOffCommand,
    MaintainPower, LanguageCommand>;
TYPED_TEST_SUITE(VehicleMessage, Messages);

constexpr int kSteps = 2000;

template <class Message>
std::vector<Parameter<Message>> numbers() {
  std::vector<Parameter<Message>> rows;
  std::ranges::copy_if(Message::parameters(), std::back_inserter(rows),
                       [](const auto& row) { return row.number != nullptr; });
  return rows;
}

template <class Message>
Message returned(const Message& message) {
  const auto decoded = decode<Message>(encode(message, 0x00));
  EXPECT_TRUE(decoded.ok());
  return decoded.ok() ? *decoded : Message{};
}
template <class Message>
double returned(const Message& message, double Message::*number) {
  static Message back;  // static, as the optimiser warns about unused bytes of a local one
  back = returned(message);
  return back.*number;
}

TYPED_TEST(VehicleMessage, NumbersReturnWithinHalfACount) {
  for (const auto& row : numbers<TypeParam>()) {
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      const double value = std::lerp(row.signal.lower, row.signal.upper, share);
      TypeParam message;
      message.*row.number = value;
      ASSERT_NEAR(returned(message, row.number), value, std::abs(row.signal.scale) * (0.5 + 1e-6))
          << row.signal.name;
    }
  }
}

TYPED_TEST(VehicleMessage, NumbersSaturateBelowTheIndicators) {
  for (const auto& row : numbers<TypeParam>()) {
    TypeParam message;
    message.*row.number = 1e30;
    EXPECT_NEAR(returned(message, row.number), row.signal.upper, 1e-6 * std::abs(row.signal.scale));
    message.*row.number = -1e30;
    EXPECT_NEAR(returned(message, row.number), row.signal.lower, 1e-6 * std::abs(row.signal.scale));
  }
}

TYPED_TEST(VehicleMessage, NoMeasurementAndErrorAreKept) {
  for (const auto& row : numbers<TypeParam>()) {
    TypeParam message;
    message.*row.number = kError;
    EXPECT_EQ(returned(message, row.number), kError) << row.signal.name;
    message.*row.number = -kError;
    EXPECT_EQ(returned(message, row.number), kError) << row.signal.name;
    message.*row.number = kNotAvailable;
    EXPECT_TRUE(std::isnan(returned(message, row.number))) << row.signal.name;
  }
}

TYPED_TEST(VehicleMessage, CodesAndSwitchesReturnAsTheyWere) {
  for (const auto& row : TypeParam::parameters()) {
    for (unsigned raw = 0; raw < (1U << std::min<unsigned>(row.signal.width, 8)); ++raw) {
      TypeParam message;
      if (row.code != nullptr) {
        message.*row.code = static_cast<std::uint8_t>(raw);
        EXPECT_EQ(returned(message).*row.code, raw) << row.signal.name;
      } else if (row.state != nullptr) {
        message.*row.state = static_cast<Switch>(raw);
        EXPECT_EQ(returned(message).*row.state, static_cast<Switch>(raw));
      }
    }
  }
}

TYPED_TEST(VehicleMessage, AddressesAreThoseOfTheGroup) {
  const auto identifier = j1939::identify(encode(TypeParam{}, 0x27, 0x03));
  ASSERT_TRUE(identifier);
  EXPECT_EQ(identifier->pgn, TypeParam::kGroup.pgn);
  EXPECT_EQ(identifier->priority, TypeParam::kGroup.priority);
  EXPECT_EQ(identifier->source, 0x27);
  EXPECT_EQ(identifier->destination,
            j1939::is_addressed(TypeParam::kGroup.pgn) ? 0x03 : j1939::kGlobalAddress);
}

TYPED_TEST(VehicleMessage, PriorityOfTheSenderDoesNotMatter) {
  can::Frame frame = encode(TypeParam{}, 0);
  frame.id = (frame.id & 0x03FFFFFFU) | (7U << 26U);
  EXPECT_TRUE(decode<TypeParam>(frame).ok());
}

TYPED_TEST(VehicleMessage, OtherShapesAreMalformed) {
  const can::Frame good = encode(TypeParam{}, 0);
  for (unsigned length = 0; length <= 255; ++length) {
    can::Frame frame = good;
    frame.length = static_cast<std::uint8_t>(length);
    EXPECT_EQ(decode<TypeParam>(frame).ok(), length == kMessageBytes);
  }
  can::Frame frame = good;
  frame.extended = false;
  EXPECT_TRUE(decode<TypeParam>(frame).malformed());
  frame = good;
  frame.remote = true;
  EXPECT_TRUE(decode<TypeParam>(frame).malformed());
  frame = good;
  frame.id ^= 0x00010000U;
  EXPECT_TRUE(decode<TypeParam>(frame).malformed());
}

TEST(VehicleGears, CodesOfEveryGear) {
  for (int gear = -kGearLimit; gear <= kGearLimit; ++gear) {
    EXPECT_EQ(gear_of(gear_code(gear)), gear);
  }
  EXPECT_EQ(gear_code(0), 0x7D);
  EXPECT_EQ(gear_code(126), kGearError);
  EXPECT_EQ(gear_code(-126), kGearError);
  EXPECT_FALSE(gear_of(kGearPark));
  EXPECT_FALSE(gear_of(kGearError));
  EXPECT_FALSE(gear_of(kGearNotAvailable));
}

TEST(VehicleTyres, PlacesAreAxleAndPosition) {
  for (std::size_t tyre = 0; tyre < kTyreLocations.size(); ++tyre) {
    EXPECT_EQ(tyre_of(kTyreLocations[tyre]), tyre);
  }
  EXPECT_FALSE(tyre_of(0x02));
  EXPECT_FALSE(tyre_of(0xFF));
}

}  // namespace
}  // namespace rigwire::protocols::vehicle
