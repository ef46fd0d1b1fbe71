#include "emulators/usb/hid_joystick.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "protocols/bytes.h"
#include "usb_probe.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::usb::Outcome;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

constexpr SimTime at(Duration since_start) {
  return kStart + since_start;
}

/// One field of an input report, as a host lays it out.
struct Field {
  unsigned usage_page = 0;
  unsigned usage = 0;
  int minimum = 0;
  int maximum = 0;
  unsigned bit = 0;
  unsigned bits = 0;
};

/// A host's reading of a report descriptor (HID 1.11, 6.2.2), short items only.
std::vector<Field> read_report_descriptor(std::span<const std::uint8_t> bytes) {
  std::vector<Field> fields;
  Field global;
  unsigned count = 0;
  unsigned bit = 0;
  int depth = 0;
  std::vector<unsigned> usages;
  unsigned usage_minimum = 0;
  for (std::size_t i = 0; i < bytes.size();) {
    const unsigned head = bytes[i++];
    const unsigned size = (head & 3U) == 3 ? 4 : head & 3U;
    std::uint32_t raw = 0;
    for (unsigned k = 0; k < size; ++k) {
      raw |= static_cast<std::uint32_t>(bytes[i + k]) << (8 * k);
    }
    i += size;
    const unsigned unused = 32 - 8 * size;
    const int value = size == 0 ? 0 : static_cast<int>(raw << unused) >> unused;
    switch (head & 0xFCU) {
      case 0x04:
        global.usage_page = raw;
        break;
      case 0x14:
        global.minimum = value;
        break;
      case 0x24:
        global.maximum = value;
        break;
      case 0x74:
        global.bits = raw;
        break;
      case 0x94:
        count = raw;
        break;
      case 0x08:
        usages.push_back(raw);
        break;
      case 0x18:
        usage_minimum = raw;
        break;
      case 0x28:
        for (unsigned u = usage_minimum; u <= raw; ++u) usages.push_back(u);
        break;
      case 0xA0:
        ++depth;
        usages.clear();
        break;
      case 0xC0:
        --depth;
        break;
      case 0x80:
        EXPECT_EQ(usages.size(), count);
        for (unsigned k = 0; k < count; ++k) {
          Field field = global;
          field.usage = usages.at(k);
          field.bit = bit;
          bit += field.bits;
          fields.push_back(field);
        }
        usages.clear();
        break;
      default:
        ADD_FAILURE() << "item " << head;
    }
  }
  EXPECT_EQ(depth, 0);
  return fields;
}

JoystickSample sample(Duration time, double left_x, unsigned buttons = 0) {
  JoystickSample sample;
  sample.time = at(time);
  sample.axes[0] = left_x;
  sample.buttons = buttons;
  return sample;
}

class HidJoystickTest : public ::testing::Test {
 protected:
  HidJoystickTest() { host.configure(); }
  bool stalls(const protocols::usb::Setup& setup) {
    return host.control(setup).outcome == Outcome::stalled;
  }

  HidJoystick joystick{HidJoystickSettings{}};
  DirectHost host{joystick};
};

TEST_F(HidJoystickTest, AHostFindsEveryAxisAndButtonInTheReport) {
  const auto fields = read_report_descriptor(joystick.report_descriptor());
  ASSERT_EQ(fields.size(), 7U + 16U);
  const unsigned usages[] = {0x30, 0x31, 0x33, 0x34, 0x32, 0x35, 0x36};
  for (unsigned i = 0; i < 7; ++i) {
    EXPECT_EQ(fields[i].usage_page, 1U);
    EXPECT_EQ(fields[i].usage, usages[i]);
    EXPECT_EQ(fields[i].bit, 16 * i);
    EXPECT_EQ(fields[i].bits, 16U);
    EXPECT_EQ(fields[i].minimum, i == 6 ? 0 : -32767);
    EXPECT_EQ(fields[i].maximum, 32767);
  }
  for (unsigned i = 0; i < 16; ++i) {
    EXPECT_EQ(fields[7 + i].usage_page, 9U);
    EXPECT_EQ(fields[7 + i].usage, i + 1);
    EXPECT_EQ(fields[7 + i].bits, 1U);
    EXPECT_EQ(fields[7 + i].maximum, 1);
  }
  EXPECT_EQ(fields.back().bit + 1, 8 * HidJoystick::kReportSize);
}

TEST_F(HidJoystickTest, TheClassDescriptorsAgreeInEveryLength) {
  const Bytes hid = host.control({0x81, 6, 0x2100, 0, 255}).data;
  ASSERT_EQ(hid.size(), 9U);
  const Bytes report = host.control({0x81, 6, 0x2200, 0, 4096}).data;
  EXPECT_EQ(hid[7] | hid[8] << 8, static_cast<int>(report.size()));
  const Bytes configuration = host.control({0x80, 6, 0x0200, 0, 255}).data;
  EXPECT_TRUE(std::equal(hid.begin(), hid.end(), configuration.begin() + 18));
  EXPECT_EQ(host.control({0x81, 6, 0x2200, 0, 5}).data, Bytes(report.begin(), report.begin() + 5));
  EXPECT_TRUE(stalls({0x81, 6, 0x2300, 0, 64}));
  EXPECT_TRUE(stalls({0x81, 6, 0x2201, 0, 64}));
}

TEST_F(HidJoystickTest, LeversAndButtonsAreWhereTheReportHasThem) {
  JoystickSample all;
  all.axes = {1.0, -1.0, 0.5, -0.5, 2.0, std::nan(""), -1.0};
  all.buttons = 0x8001;
  joystick.update(all);
  const Bytes report = host.control({0xA1, 1, 0x0100, 0, 64}).data;
  EXPECT_THAT(report, ElementsAre(0xFF, 0x7F, 0x01, 0x80, 0x00, 0x40, 0x00, 0xC0,  //
                                  0xFF, 0x7F, 0, 0, 0, 0, 0x01, 0x80));
}

TEST_F(HidJoystickTest, TheFirstReportGoesOutAtOnceThenOnlyNews) {
  host.read(0x81, 16, at(1ms));
  ASSERT_EQ(host.ends.size(), 1U);
  host.read(0x81, 16, at(2ms));
  joystick.update(sample(50ms, 0.0));
  joystick.advance(at(10s));
  EXPECT_EQ(host.ends.size(), 1U) << "nothing has moved";
  joystick.update(sample(11s, 0.25));
  ASSERT_EQ(host.ends.size(), 2U);
  EXPECT_EQ(host.last_end, at(11s));
}

TEST_F(HidJoystickTest, ReportsKeepTheIntervalAndCarryTheLatest) {
  for (int i = 0; i < 8; ++i) {
    host.read(0x81, 16, at(0ms));
  }
  ASSERT_EQ(host.ends.size(), 1U);
  joystick.update(sample(3ms, 0.1));
  joystick.update(sample(6ms, 0.2));
  EXPECT_EQ(host.ends.size(), 1U);
  EXPECT_EQ(joystick.next_event(), at(10ms));
  joystick.advance(at(10ms));
  ASSERT_EQ(host.ends.size(), 2U);
  EXPECT_EQ(protocols::load_little<std::int16_t>(host.ends[1].data, 0), std::lround(0.2 * 32767));
  joystick.update(sample(12ms, 0.3));
  joystick.update(sample(14ms, 0.2));
  joystick.advance(at(30ms));
  EXPECT_EQ(host.ends.size(), 2U) << "moved back before anybody could see it";
}

TEST_F(HidJoystickTest, AnIdleTimeRepeatsTheReport) {
  EXPECT_THAT(host.control({0xA1, 2, 0, 0, 1}).data, ElementsAre(0));
  EXPECT_EQ(host.control({0x21, 10, 0x0500, 0, 0}).outcome, Outcome::done);
  EXPECT_THAT(host.control({0xA1, 2, 0, 0, 1}).data, ElementsAre(5));
  for (int i = 0; i < 4; ++i) {
    host.read(0x81, 16, at(0ms));
  }
  EXPECT_EQ(joystick.next_event(), at(20ms));
  joystick.advance(at(20ms));
  EXPECT_EQ(joystick.next_event(), at(40ms));
  joystick.advance(at(40ms));
  EXPECT_EQ(host.ends.size(), 3U);
}

TEST_F(HidJoystickTest, WhatAJoystickHasNotStalls) {
  EXPECT_TRUE(stalls({0xA1, 3, 0, 0, 1}));        // GET_PROTOCOL
  EXPECT_TRUE(stalls({0x21, 11, 1, 0, 0}));       // SET_PROTOCOL
  EXPECT_TRUE(stalls({0x21, 9, 0x0200, 0, 0}));   // SET_REPORT
  EXPECT_TRUE(stalls({0xA1, 1, 0x0200, 0, 16}));  // an output report
  EXPECT_TRUE(stalls({0xA1, 1, 0x0101, 0, 16}));  // a report id
  EXPECT_TRUE(stalls({0x21, 10, 0x0501, 0, 0}));  // idle of a report id
  EXPECT_TRUE(stalls({0xA1, 1, 0x0100, 1, 16}));  // another interface
  EXPECT_TRUE(stalls({0xC0, 1, 0x0100, 0, 16}));  // of a vendor
}

TEST_F(HidJoystickTest, ACancelledReadIsNotAnswered) {
  host.read(0x81, 16, at(0ms));
  const auto read = host.read(0x81, 16, at(0ms));
  EXPECT_TRUE(joystick.cancel(at(1ms), read));
  EXPECT_FALSE(joystick.cancel(at(1ms), read));
  joystick.update(sample(100ms, 1.0));
  EXPECT_EQ(host.ends.size(), 1U);
  EXPECT_EQ(joystick.next_event(), kNever);
}

TEST_F(HidJoystickTest, AReplugReportsAgain) {
  host.read(0x81, 16, at(0ms));
  host.read(0x81, 16, at(0ms));
  host.port.detach(at(1s));
  joystick.update(sample(2s, 1.0));
  host.port.attach(at(3s), host);
  host.configure();
  host.read(0x81, 4, at(3s));
  ASSERT_EQ(host.ends.size(), 2U);
  EXPECT_THAT(host.ends[1].data, ElementsAre(0xFF, 0x7F, 0, 0)) << "cut to what was asked for";
}

TEST(HidJoystickSettings, AnIntervalThatNoEndpointCanSayIsRefused) {
  for (const Duration interval : {Duration{0}, Duration{256ms}, Duration{1500us}}) {
    HidJoystickSettings settings;
    settings.interval = interval;
    EXPECT_THROW(HidJoystick{settings}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace rigwire::emulators
