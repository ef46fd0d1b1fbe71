// A camera's registers as its description tells them: where they lie, and what is not read is said.
#include "field/gige_description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "emulators/gige_camera/camera_features.h"
#include "emulators/nonvolatile_memory.h"
#include "protocols/gige_vision/bootstrap.h"
#include "protocols/gige_vision/genicam.h"

namespace rigwire::field {
namespace {

namespace gev = protocols::gige_vision;
namespace reg = emulators::camera_register;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const DescriptionError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

GigeDescription emulated() {
  emulators::GigeCameraSettings settings;
  settings.kind = emulators::GigeCameraKind::stereo;
  return GigeDescription(
      gev::write_description({"Rigwire", "Head", "text"}, emulators::camera_features(settings)));
}

GigeDescription of(const std::string& nodes) {
  return GigeDescription(
      "<?xml version=\"1.0\"?><!-- <Integer Name=\"No\"> -->"
      "<RegisterDescription ModelName=\"M\"><Group Comment=\"g\">" +
      nodes + "</Group></RegisterDescription>");
}

TEST(FieldGigeDescription, FeaturesLieWhereTheCameraHasThem) {
  const GigeDescription description = emulated();
  const GigeFeature focal = description.find("Scan3dFocalLength");
  EXPECT_EQ(focal.kind, GigeFeature::Kind::real);
  EXPECT_EQ(focal.address, reg::kScan3dFocalLength);
  EXPECT_EQ(focal.length, 8U);
  const GigeFeature size = description.find("GevSCPSPacketSize");
  EXPECT_EQ(size.address, gev::bootstrap::kStreamPacketSize);
  EXPECT_EQ(size.lowest_bit, 0U);
  EXPECT_EQ(size.highest_bit, 15U);
  EXPECT_TRUE(size.partial());
  const GigeFeature enable = description.find("ComponentEnable");
  EXPECT_EQ(enable.address, reg::kComponentEnable);
  EXPECT_EQ(enable.stride, 4U);
  EXPECT_EQ(description.find("ComponentSelector").value_of("Disparity"), 2.0);
  EXPECT_EQ(description.find("ChunkGain").chunk, chunk_id(emulators::CameraChunk::gain));
  EXPECT_EQ(description.find("AcquisitionStart").command_value, 1);
  EXPECT_EQ(description.find("TLParamsLocked").constant, 0.0);
}

TEST(FieldGigeDescription, EveryFeatureOfTheEmulatedCameraIsRead) {
  emulators::GigeCameraSettings settings;
  settings.kind = emulators::GigeCameraKind::stereo;
  const GigeDescription description = emulated();
  for (const gev::Feature& feature : emulators::camera_features(settings)) {
    const GigeFeature found = description.find(feature.name);
    if (feature.place) {
      EXPECT_EQ(found.address, feature.place->address) << feature.name;
      EXPECT_EQ(found.length, feature.place->length) << feature.name;
    }
  }
}

TEST(FieldGigeDescription, BitsAreWrittenBesideOthers) {
  const GigeFeature size = emulated().find("GevSCPSPacketSize");
  std::array<std::uint8_t, 4> word{0x40, 0x00, 0x05, 0xDC};
  EXPECT_EQ(size.decode(word.data()), 1500.0);
  size.encode(576, word.data());
  EXPECT_EQ(word, (std::array<std::uint8_t, 4>{0x40, 0x00, 0x02, 0x40}));
}

TEST(FieldGigeDescription, NumbersOfEitherByteOrderAndSign) {
  const GigeDescription description =
      of("<IntReg Name='Little'><Address>0x10</Address><Address>4</Address><Length>4</Length>"
         "<Sign>Signed</Sign><Endianess>LittleEndian</Endianess></IntReg>"
         "<FloatReg Name=\"Single\"><Address>32</Address><Length>4</Length>"
         "<Endianess>BigEndian</Endianess></FloatReg>");
  const GigeFeature little = description.find("Little");
  EXPECT_EQ(little.address, 0x14U);
  const std::array<std::uint8_t, 4> bytes{0xFE, 0xFF, 0xFF, 0xFF};
  EXPECT_EQ(little.decode(bytes.data()), -2.0);
  std::array<std::uint8_t, 4> single{};
  description.find("Single").encode(0.5, single.data());
  EXPECT_EQ(single, (std::array<std::uint8_t, 4>{0x3F, 0, 0, 0}));
}

TEST(FieldGigeDescription, WhatIsComputedIsNamedNotGuessed) {
  const GigeDescription description =
      of("<Integer Name=\"A\"><pValue>Knife</pValue></Integer>"
         "<IntSwissKnife Name=\"Knife\"><Formula>1+1</Formula></IntSwissKnife>"
         "<Integer Name=\"Ring\"><pValue>Gnir</pValue></Integer>"
         "<Integer Name=\"Gnir\"><pValue>Ring</pValue></Integer>"
         "<IntReg Name=\"Far\"><pAddress>A</pAddress><Length>4</Length></IntReg>"
         "<IntReg Name=\"Wide\"><Address>0</Address><Length>16</Length></IntReg>"
         "<Integer Name=\"Bare\"></Integer>"
         "<MaskedIntReg Name=\"Bits\"><Address>0</Address><Length>4</Length><LSB>31</LSB>"
         "<MSB>40</MSB></MaskedIntReg>");
  EXPECT_THAT(message_of([&] { (void)description.find("A"); }), HasSubstr("IntSwissKnife"));
  EXPECT_THAT(message_of([&] { (void)description.find("Ring"); }), HasSubstr("leads to itself"));
  EXPECT_THAT(message_of([&] { (void)description.find("Far"); }), HasSubstr("computed address"));
  EXPECT_THAT(message_of([&] { (void)description.find("Wide"); }), HasSubstr("1..8"));
  EXPECT_THAT(message_of([&] { (void)description.find("Bare"); }), HasSubstr("neither"));
  EXPECT_THAT(message_of([&] { (void)description.find("Bits"); }), HasSubstr("bits of 0..31"));
  EXPECT_THAT(message_of([&] { (void)description.find("None"); }), HasSubstr("no feature None"));
  EXPECT_THAT(message_of([&] { (void)description.find("Knife"); }), HasSubstr("not read"));
}

TEST(FieldGigeDescription, TextsThatAreNoDescriptionAreRefused) {
  EXPECT_THAT(message_of([] { GigeDescription(""); }), HasSubstr("RegisterDescription"));
  EXPECT_THAT(message_of([] { GigeDescription("<html><body Name=\"x\">"); }),
              HasSubstr("RegisterDescription"));
  EXPECT_THAT(message_of([] { GigeDescription("<RegisterDescription><Integer Name=\"A\""); }),
              HasSubstr("has no end"));
}

TEST(FieldGigeDescription, ValuesAreRefusedWithWhatIsAllowed) {
  const GigeDescription description = emulated();
  EXPECT_THAT(message_of([&] { (void)description.find("PixelFormat").value_of("RGB9"); }),
              HasSubstr("found 'RGB9', allowed "));
  EXPECT_THAT(message_of([&] { (void)description.find("ChunkModeActive").value_of("on"); }),
              HasSubstr("allowed 0 or 1"));
  EXPECT_THAT(message_of([&] { (void)description.find("Width").value_of("6x"); }),
              HasSubstr("a whole number"));
}

TEST(FieldGigeUrl, PlacesInTheCameraAreRead) {
  const GigeUrl url = read_gige_url("Local:camera.xml;10000;8A40");
  EXPECT_EQ(url.address, 0x10000U);
  EXPECT_EQ(url.size, 0x8A40U);
  EXPECT_EQ(read_gige_url("local:///a.xml;1;20?SchemaVersion=1.1.0").size, 0x20U);
}

TEST(FieldGigeUrl, OthersAreRefusedWithWhy) {
  EXPECT_THAT(message_of([] { (void)read_gige_url("http://camera/a.xml"); }),
              HasSubstr("allowed Local:"));
  EXPECT_THAT(message_of([] { (void)read_gige_url("Local:a.zip;1;2"); }), HasSubstr("zipped"));
  EXPECT_THAT(message_of([] { (void)read_gige_url("Local:a.xml;1;FFFFFFFF"); }),
              HasSubstr("a size of 1.."));
  EXPECT_THAT(message_of([] { (void)read_gige_url("Local:a.xml;x;2"); }), HasSubstr("an address"));
}

}  // namespace
}  // namespace rigwire::field
