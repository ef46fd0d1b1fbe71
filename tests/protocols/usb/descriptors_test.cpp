#include "protocols/usb/descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "protocols/usb/descriptor_reader.h"

namespace rigwire::protocols::usb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

DeviceDescription keyboard() {
  DeviceDescription d;
  d.usb_version = 0x0110;
  d.control_packet_bytes = 8;
  d.vendor = 0x1234;
  d.product = 0x5678;
  d.manufacturer = "A";
  d.serial_number = "0";
  d.speed = Speed::low;
  InterfaceDescription keys;
  keys.device_class = 3;
  keys.subclass = 1;
  keys.protocol = 1;
  keys.extra = {9, 0x21, 0x10, 1, 0, 1, 0x22, 63, 0};
  keys.endpoints.push_back({0x81, TransferType::interrupt, 8, 10});
  d.interfaces.push_back(keys);
  return d;
}

std::string refusal(const DeviceDescription& description) {
  try {
    validate(description);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(UsbDescriptorBytes, TheDeviceIsEighteenBytes) {
  const DescriptorBytes bytes(keyboard());
  EXPECT_THAT(bytes.device(), ElementsAre(18, 1, 0x10, 0x01, 0, 0, 0, 8, 0x34, 0x12, 0x78, 0x56,
                                          0x00, 0x01, 1, 0, 2, 1));
}

TEST(UsbDescriptorBytes, TheConfigurationCarriesInterfacesClassDescriptorsAndEndpoints) {
  const DescriptorBytes bytes(keyboard());
  EXPECT_THAT(bytes.configuration(),
              ElementsAre(9, 2, 34, 0, 1, 1, 0, 0x80, 50,       // configuration, 100 mA
                          9, 4, 0, 0, 1, 3, 1, 1, 0,            // interface
                          9, 0x21, 0x10, 1, 0, 1, 0x22, 63, 0,  // of the class
                          7, 5, 0x81, 3, 8, 0, 10));            // endpoint
}

TEST(UsbDescriptorBytes, StringsAreCountedFromOneWithoutTheEmptyOnes) {
  const DescriptorBytes bytes(keyboard());
  EXPECT_THAT(bytes.text(0), ElementsAre(4, 3, 0x09, 0x04));
  EXPECT_THAT(bytes.text(1), ElementsAre(4, 3, 'A', 0));
  EXPECT_THAT(bytes.text(2), ElementsAre(4, 3, '0', 0));
  EXPECT_TRUE(bytes.text(3).empty());
  EXPECT_TRUE(bytes.text(255).empty());
}

TEST(UsbDescriptorBytes, TextsBeyondAsciiAreUtf16) {
  EXPECT_THAT(encode_text("\xC3\xBC\xF0\x9D\x84\x9E"),
              ElementsAre(8, 3, 0xFC, 0x00, 0x34, 0xD8, 0x1E, 0xDD));
  for (const char* bad : {"\xC3", "\x80", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xFF"}) {
    EXPECT_THROW((void)encode_text(bad), std::invalid_argument) << bad;
  }
  EXPECT_EQ(encode_text(std::string(126, 'x')).size(), 254U);
  EXPECT_THROW((void)encode_text(std::string(127, 'x')), std::invalid_argument);
}

TEST(UsbDescriptorBytes, AlternateSettingsCountAsOneInterface) {
  DeviceDescription d = keyboard();
  d.interfaces.push_back(d.interfaces[0]);
  d.interfaces[1].alternate = 1;
  EXPECT_EQ(DescriptorBytes(d).configuration()[4], 1);
}

TEST(UsbDescriptorBytes, AHostReadsBackWhatWasDescribed) {
  const DeviceDescription d = keyboard();
  const DescriptorBytes bytes(d);
  const auto device = decode_device(bytes.device());
  ASSERT_TRUE(device.ok());
  EXPECT_EQ(device->vendor, d.vendor);
  EXPECT_EQ(device->serial_text, 2);
  const auto configuration = decode_configuration(bytes.configuration());
  ASSERT_TRUE(configuration.ok());
  EXPECT_EQ(configuration.consumed(), bytes.configuration().size());
  ASSERT_EQ(configuration->interfaces.size(), 1U);
  EXPECT_EQ(configuration->interfaces[0].interface.extra, d.interfaces[0].extra);
  ASSERT_EQ(configuration->interfaces[0].interface.endpoints.size(), 1U);
  EXPECT_EQ(configuration->interfaces[0].interface.endpoints[0].address, 0x81);
  EXPECT_EQ(configuration->interfaces[0].interface.endpoints[0].type, TransferType::interrupt);
  EXPECT_EQ(*decode_text(bytes.text(1)), "A");
}

TEST(UsbDescriptorBytes, WhatNoDeviceMaySayIsRefused) {
  EXPECT_EQ(refusal(keyboard()), "");
  DeviceDescription d = keyboard();
  d.control_packet_bytes = 64;
  EXPECT_THAT(refusal(d), HasSubstr("control_packet_bytes: found 64"));
  d = keyboard();
  d.configuration_value = 0;
  EXPECT_THAT(refusal(d), HasSubstr("configuration_value: found 0"));
  d = keyboard();
  d.interfaces.clear();
  EXPECT_THAT(refusal(d), HasSubstr("interfaces: found 0"));
  d = keyboard();
  d.interfaces[0].number = 1;
  EXPECT_THAT(refusal(d), HasSubstr("without gaps"));
  d = keyboard();
  d.interfaces[0].extra = {3, 0x21};
  EXPECT_THAT(refusal(d), HasSubstr("extra descriptor length: found 3"));
  d = keyboard();
  d.interfaces[0].endpoints[0].address = 0x80;
  EXPECT_THAT(refusal(d), HasSubstr("endpoint address: found 128"));
  d = keyboard();
  d.interfaces[0].endpoints.push_back(d.interfaces[0].endpoints[0]);
  EXPECT_THAT(refusal(d), HasSubstr("each once"));
  d = keyboard();
  d.interfaces[0].endpoints[0].packet_bytes = 9;
  EXPECT_THAT(refusal(d), HasSubstr("interrupt packet_bytes: found 9"));
  d = keyboard();
  d.interfaces[0].endpoints[0].interval = 0;
  EXPECT_THAT(refusal(d), HasSubstr("interval: found 0"));
  d = keyboard();
  d.interfaces[0].endpoints[0].type = TransferType::isochronous;
  EXPECT_THAT(refusal(d), HasSubstr("only bulk and interrupt"));
}

TEST(UsbDescriptorReader, EveryCutIsIncomplete) {
  const DescriptorBytes bytes(keyboard());
  for (std::size_t size = 0; size < bytes.configuration().size(); ++size) {
    EXPECT_TRUE(decode_configuration(bytes.configuration().first(size)).incomplete()) << size;
  }
  for (std::size_t size = 0; size < bytes.device().size(); ++size) {
    EXPECT_TRUE(decode_device(bytes.device().first(size)).incomplete()) << size;
  }
  for (std::size_t size = 0; size < bytes.text(1).size(); ++size) {
    EXPECT_TRUE(decode_text(bytes.text(1).first(size)).incomplete()) << size;
  }
}

TEST(UsbDescriptorReader, ContradictionsAreMalformed) {
  const DescriptorBytes bytes(keyboard());
  const auto broken = [&](std::size_t at, std::uint8_t value) {
    std::vector<std::uint8_t> copy(bytes.configuration().begin(), bytes.configuration().end());
    copy[at] = value;
    return decode_configuration(copy).malformed();
  };
  EXPECT_TRUE(broken(0, 8));
  EXPECT_TRUE(broken(1, 1));
  EXPECT_TRUE(broken(2, 8));   // total shorter than the descriptor
  EXPECT_TRUE(broken(2, 33));  // the endpoint does not fit
  EXPECT_TRUE(broken(4, 2));   // interfaces announced
  EXPECT_TRUE(broken(9, 0));   // a descriptor of no length
  EXPECT_TRUE(broken(9, 8));   // a short interface
  EXPECT_TRUE(broken(13, 0));  // endpoints announced
  EXPECT_TRUE(broken(13, 2));
  EXPECT_TRUE(broken(27, 6));  // a short endpoint
  EXPECT_TRUE(broken(27, 200));
}

TEST(UsbUtf16, UnpairedSurrogatesAreReplaced) {
  EXPECT_EQ(utf8_from_utf16(std::u16string{0xD834}), "\xEF\xBF\xBD");
  EXPECT_EQ(utf8_from_utf16(std::u16string{0xDD1E, 'a'}),
            "\xEF\xBF\xBD"
            "a");
  EXPECT_EQ(utf8_from_utf16(std::u16string{0xD834, 0xDD1E}), "\xF0\x9D\x84\x9E");
}

}  // namespace
}  // namespace rigwire::protocols::usb
