#include "emulators/usb/usb_standard_requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "usb_probe.h"

namespace rigwire::emulators {
namespace {

using protocols::usb::Outcome;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class UsbStandardRequestsTest : public ::testing::Test {
 protected:
  bool stalls(const protocols::usb::Setup& setup) {
    return host.control(setup).outcome == Outcome::stalled;
  }
  std::vector<std::uint8_t> get(const protocols::usb::Setup& setup) {
    const DirectHost::End end = host.control(setup);
    EXPECT_EQ(end.outcome, Outcome::done);
    return end.data;
  }
  void order(const protocols::usb::Setup& setup) {
    EXPECT_EQ(host.control(setup).outcome, Outcome::done);
  }

  UsbProbe device;
  DirectHost host{device};
};

TEST_F(UsbStandardRequestsTest, DescriptorsAreCutToWhatIsAskedFor) {
  for (const std::uint16_t type : {std::uint16_t{0x0100}, std::uint16_t{0x0200}}) {
    const auto whole = get({0x80, 6, type, 0, 65535});
    EXPECT_EQ(whole.size(), type == 0x0100 ? 18U : 9U + 3U * 9U + 3U * 7U);
    for (const int length : {0, 1, 2, 7, 8, 9, 17, 18, 19, 64, 255, 256, 4096}) {
      const auto part = get({0x80, 6, type, 0, static_cast<std::uint16_t>(length)});
      ASSERT_EQ(part.size(), std::min(static_cast<std::size_t>(length), whole.size()));
      EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
    }
  }
  EXPECT_THAT(get({0x80, 6, 0x0300, 0, 255}), ElementsAre(4, 3, 9, 4));
  EXPECT_THAT(get({0x80, 6, 0x0301, 0x0409, 255}),
              ElementsAre(10, 3, 'T', 0, 'e', 0, 's', 0, 't', 0));
}

TEST_F(UsbStandardRequestsTest, DescriptorsThatAreNotThereStall) {
  EXPECT_TRUE(stalls({0x80, 6, 0x0302, 0x0409, 255}));  // a string
  EXPECT_TRUE(stalls({0x80, 6, 0x0600, 0, 10}));        // device qualifier: no other speed
  EXPECT_TRUE(stalls({0x80, 6, 0x0700, 0, 9}));         // other speed configuration
  EXPECT_TRUE(stalls({0x80, 6, 0x0201, 0, 9}));         // a second configuration
  EXPECT_TRUE(stalls({0x80, 6, 0x0101, 0, 18}));
  EXPECT_TRUE(stalls({0x80, 6, 0x0000, 0, 18}));
  EXPECT_TRUE(stalls({0x80, 6, 0xFF00, 0, 18}));
  EXPECT_TRUE(stalls({0x00, 6, 0x0100, 0, 0}));  // wrong direction
  EXPECT_TRUE(stalls({0x81, 6, 0x2200, 2, 64})) << "an interface that is not there";
  EXPECT_THAT(device.setups, IsEmpty());
}

TEST_F(UsbStandardRequestsTest, DescriptorsOfAClassAreTheDevicesOwn) {
  EXPECT_TRUE(stalls({0x81, 6, 0x2200, 1, 64}));
  EXPECT_EQ(device.setups.size(), 1U);
}

TEST_F(UsbStandardRequestsTest, TheConfigurationIsSelectedAndTold) {
  EXPECT_THAT(get({0x80, 8, 0, 0, 1}), ElementsAre(0));
  EXPECT_TRUE(stalls({0x00, 9, 2, 0, 0}));
  order({0x00, 9, 1, 0, 0});
  EXPECT_THAT(get({0x80, 8, 0, 0, 1}), ElementsAre(1));
  EXPECT_THAT(get({0x80, 8, 0, 0, 0}), IsEmpty());
  order({0x00, 9, 0, 0, 0});
  EXPECT_THAT(get({0x80, 8, 0, 0, 64}), ElementsAre(0));
  EXPECT_THAT(device.configurations, ElementsAre(1, 0));
}

TEST_F(UsbStandardRequestsTest, EndpointsExistInTheirConfigurationAndAlternateSettingOnly) {
  EXPECT_TRUE(stalls({0x82, 0, 0, 0x81, 2}));
  host.read(0x81, 8);
  EXPECT_EQ(host.ends.at(0).outcome, Outcome::stalled);
  host.configure();
  EXPECT_THAT(get({0x82, 0, 0, 0x81, 2}), ElementsAre(0, 0));
  host.read(0x81, 8);
  EXPECT_EQ(device.reads.size(), 1U);

  EXPECT_THAT(get({0x81, 10, 0, 0, 1}), ElementsAre(0));
  EXPECT_TRUE(stalls({0x01, 11, 2, 0, 0}));  // no such alternate
  EXPECT_TRUE(stalls({0x01, 11, 0, 2, 0}));  // no such interface
  order({0x01, 11, 1, 0, 0});
  EXPECT_THAT(get({0x81, 10, 0, 0, 1}), ElementsAre(1));
  EXPECT_THAT(device.selections, ElementsAre(std::pair<std::uint8_t, std::uint8_t>{0, 1}));
  EXPECT_TRUE(stalls({0x82, 0, 0, 0x81, 2}));
  host.read(0x81, 8);
  EXPECT_EQ(host.ends.at(1).outcome, Outcome::stalled);
  host.read(0x02, 8);  // an OUT endpoint
  EXPECT_EQ(host.ends.at(2).outcome, Outcome::stalled);
}

TEST_F(UsbStandardRequestsTest, AHaltedEndpointStallsUntilCleared) {
  host.configure();
  EXPECT_TRUE(stalls({0x02, 3, 0, 0x83, 0}));  // no such endpoint
  EXPECT_TRUE(stalls({0x02, 3, 1, 0x82, 0}));  // no such feature
  order({0x02, 3, 0, 0x82, 0});
  EXPECT_THAT(get({0x82, 0, 0, 0x82, 2}), ElementsAre(1, 0));
  EXPECT_THAT(get({0x82, 0, 0, 0x02, 2}), ElementsAre(0, 0)) << "the same number, other direction";
  host.read(0x82, 64);
  EXPECT_EQ(host.ends.at(0).outcome, Outcome::stalled);
  order({0x02, 1, 0, 0x82, 0});
  host.read(0x82, 64);
  EXPECT_EQ(device.reads.size(), 1U);

  order({0x02, 3, 0, 0x82, 0});
  host.configure();
  EXPECT_THAT(get({0x82, 0, 0, 0x82, 2}), ElementsAre(0, 0)) << "a configuration clears halts";
}

TEST_F(UsbStandardRequestsTest, StatusOfTheDeviceSaysItsSupply) {
  EXPECT_THAT(get({0x80, 0, 0, 0, 2}), ElementsAre(1, 0));
  EXPECT_THAT(get({0x80, 0, 0, 0, 1}), ElementsAre(1));
  EXPECT_THAT(get({0x82, 0, 0, 0, 2}), ElementsAre(0, 0)) << "endpoint 0 is always there";
  EXPECT_TRUE(stalls({0x81, 0, 0, 0, 2})) << "no interface without a configuration";
  host.configure();
  EXPECT_THAT(get({0x81, 0, 0, 1, 2}), ElementsAre(0, 0));
}

TEST_F(UsbStandardRequestsTest, WhatIsNotKnownStalls) {
  host.configure();
  for (int request = 0; request < 256; ++request) {
    const auto number = static_cast<std::uint8_t>(request);
    if (number != 9 && number != 5) {  // orders without index
      EXPECT_TRUE(stalls({0x00, number, 0x7777, 0x55, 0})) << request;
    }
    EXPECT_TRUE(stalls({0x83, number, 0, 0, 8})) << request << " of another recipient";
    EXPECT_TRUE(stalls({0x1F, number, 0, 0, 0})) << request << " of a reserved recipient";
  }
  EXPECT_TRUE(stalls({0x00, 3, 1, 0, 0}));      // remote wake-up
  EXPECT_TRUE(stalls({0x00, 3, 2, 0x100, 0}));  // test mode
  EXPECT_TRUE(stalls({0x82, 12, 0, 0x81, 2}));  // synch frame
  EXPECT_TRUE(stalls({0x00, 7, 0x0100, 0, 18}));
  EXPECT_THAT(device.setups, IsEmpty());
}

TEST_F(UsbStandardRequestsTest, AnAddressIsTaken) {
  order({0x00, 5, 127, 0, 0});
  EXPECT_TRUE(stalls({0x00, 5, 128, 0, 0}));
}

TEST_F(UsbStandardRequestsTest, AnAttachIsAPowerOn) {
  host.configure();
  host.port.detach(kStart);
  host.port.attach(kStart, host);
  EXPECT_THAT(get({0x80, 8, 0, 0, 1}), ElementsAre(0));
  EXPECT_EQ(device.times_plugged, 2);
  EXPECT_EQ(device.times_unplugged, 1);
}

}  // namespace
}  // namespace rigwire::emulators
