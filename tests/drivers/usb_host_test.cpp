// Without any device: what the host side says then. With devices it is tested on a real kernel:
// tests/kernel/cases/libusb_reads_the_adapter.sh.
#include "drivers/usb_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>

namespace rigwire::drivers {
namespace {

using testing::HasSubstr;

TEST(UsbSelector, ByVendorAndProduct) {
  const UsbSelector selector = parse_usb_selector("1d50:606f");
  EXPECT_EQ(selector.vendor, 0x1D50);
  EXPECT_EQ(selector.product, 0x606F);
  UsbListed device{.vendor = 0x1D50, .product = 0x606F, .place = "1-1", .serial_number = "A"};
  EXPECT_TRUE(selector.matches(device));
  device.product = 0x606E;
  EXPECT_FALSE(selector.matches(device));
}

TEST(UsbSelector, BySerialNumber) {
  const UsbSelector selector = parse_usb_selector("1D50:606F:00 1:2");
  EXPECT_EQ(selector.serial_number, "00 1:2");
  UsbListed device{.vendor = 0x1D50, .product = 0x606F, .serial_number = "00 1:2"};
  EXPECT_TRUE(selector.matches(device));
  device.serial_number = "00";
  EXPECT_FALSE(selector.matches(device));
}

TEST(UsbSelector, ByPlace) {
  const UsbSelector selector = parse_usb_selector("3-1.4.2");
  EXPECT_EQ(selector.place, "3-1.4.2");
  EXPECT_TRUE(selector.matches({.place = "3-1.4.2"}));
  EXPECT_FALSE(selector.matches({.place = "3-1.4"}));
}

TEST(UsbSelector, OtherTextsAreRefusedWithTheirForm) {
  for (const char* text : {"", "1d50", "1d50:", "1d50:606", "1d50:606g", "1d50-606f",
                           "1d50:606f:", "1-", "-1", "1-1.", "1-1..2", "x-1", "usb1"}) {
    try {
      static_cast<void>(parse_usb_selector(text));
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("'") + text + "'"));
      EXPECT_THAT(error.what(), HasSubstr("1d50:606f"));
    }
  }
}

TEST(UsbHost, ListsWhatIsThereOrSaysWhyNot) {
  try {
    for (const UsbListed& device : list_usb_devices()) {
      EXPECT_FALSE(device.place.empty());
      EXPECT_GT(device.bus, 0);
    }
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr("; "));  // with its mend
  }
}

TEST(UsbHost, ADeviceThatIsNotThereIsAnError) {
  boost::asio::io_context io;
  try {
    UsbHost host(io);
    static_cast<void>(host.open(parse_usb_selector("fffe:fffd")));
    ADD_FAILURE();
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr("USB"));
    EXPECT_THAT(error.what(), HasSubstr("; "));
  }
}

TEST(UsbHost, ComesAndGoesWithItsContext) {
  boost::asio::io_context io;
  for (int round = 0; round < 20; ++round) {
    try {
      UsbHost host(io);
      host.on_device([](const UsbListed&, bool) {});
      io.restart();
      io.poll();
    } catch (const EndpointError& error) {
      EXPECT_THAT(error.what(), HasSubstr("; "));
    }
  }
  io.restart();
  io.poll();
}

}  // namespace
}  // namespace rigwire::drivers
