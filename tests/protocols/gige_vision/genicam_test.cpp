// The description as a client reads it: well formed, every name that is used is there, and
// registers where the map has them.
#include "protocols/gige_vision/genicam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <stack>
#include <string>

namespace rigwire::protocols::gige_vision {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<Feature> some_features() {
  Feature width{"Width",
                "ImageFormatControl",
                Visibility::beginner,
                "Columns & more.",
                IntegerFeature{16, 640, 4, "WidthMax", "px", {}},
                Place{0xA010, 4, Access::read_write, {}, {}, 0, {}},
                false,
                true};
  Feature maximum{"WidthMax",
                  {},
                  Visibility::invisible,
                  "Columns.",
                  IntegerFeature{.maximum = 640},
                  Place{0xA008, 4, Access::read_only, {}, {}, 0, {}},
                  true,
                  false};
  Feature time{"ExposureTime",
               "AcquisitionControl",
               Visibility::beginner,
               "Exposure.",
               FloatFeature{10.5, 1e6, {}, "us"},
               Place{0xA018, 8, Access::read_write, {}, {}, 0, {}},
               false,
               false};
  Feature selector{"ChunkSelector",
                   "ChunkDataControl",
                   Visibility::expert,
                   "Which.",
                   EnumerationFeature{{{0, "Timestamp"}, {1, "Gain"}}},
                   Place{0xA100, 4, Access::read_write, {}, {}, 0, {}},
                   false,
                   false};
  Feature enable{"ChunkEnable",
                 "ChunkDataControl",
                 Visibility::expert,
                 "Whether.",
                 BooleanFeature{},
                 Place{0xA110, 4, Access::read_write, {}, "ChunkSelector", 4, {}},
                 false,
                 false};
  Feature gain{"ChunkGain",
               "ChunkDataControl",
               Visibility::expert,
               "Gain.",
               FloatFeature{0, 48, {}, "dB"},
               Place{0, 8, Access::read_only, {}, {}, 0, 0x5257'0004},
               false,
               false};
  Feature fire{
      "GevSCPSFireTestPacket",
      "TransportLayerControl",
      Visibility::guru,
      "Fire.",
      CommandFeature{},
      Place{bootstrap::kStreamPacketSize, 4, Access::read_write, BitRange{31, 31}, {}, 0, {}},
      false,
      false};
  Feature name{"DeviceUserID",
               "DeviceControl",
               Visibility::beginner,
               "Name.",
               StringFeature{},
               Place{bootstrap::kUserDefinedName, 16, Access::read_write, {}, {}, 0, {}},
               false,
               false};
  Feature locked{"TLParamsLocked",
                 {},
                 Visibility::invisible,
                 "Locked.",
                 IntegerFeature{.maximum = 1},
                 std::nullopt,
                 false,
                 false};
  return {width, maximum, time, selector, enable, gain, fire, name, locked};
}

std::string description() {
  return write_description({"Rigwire", "Area <1>", "A \"simulated\" camera"}, some_features());
}

/// The part of the text from `<tag Name="name"` to its end.
std::string node(const std::string& text, const std::string& tag, const std::string& name) {
  const std::size_t begin = text.find("<" + tag + " Name=\"" + name + "\"");
  if (begin == std::string::npos) {
    return "no " + tag + " " + name;
  }
  return text.substr(begin, text.find("</" + tag + ">", begin) - begin);
}

TEST(Genicam, EveryElementIsClosed) {
  const std::string text = description();
  std::stack<std::string> open;
  std::size_t at = text.find("?>") + 2;
  while ((at = text.find('<', at)) != std::string::npos) {
    const std::size_t end = text.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = text.substr(at + 1, end - at - 1);
    if (tag.front() == '/') {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(tag.substr(1), open.top());
      open.pop();
    } else {
      open.push(tag.substr(0, tag.find(' ')));
    }
    at = end;
  }
  EXPECT_TRUE(open.empty());
}

TEST(Genicam, IsOfWholeWords) {
  EXPECT_EQ(description().size() % 4, 0U);
}

TEST(Genicam, NamesAndTextsAreEscaped) {
  const std::string text = description();
  EXPECT_THAT(text, HasSubstr("ModelName=\"Area__1_\""));
  EXPECT_THAT(text, HasSubstr("A &quot;simulated&quot; camera"));
  EXPECT_THAT(text, HasSubstr("Columns &amp; more."));
}

TEST(Genicam, EveryNameThatIsUsedIsThereOnce) {
  const std::string text = description();
  std::multiset<std::string> names;
  for (std::size_t at = 0; (at = text.find("Name=\"", at)) != std::string::npos; ++at) {
    const std::size_t begin = at + 6;
    // Those of the whole description are no nodes.
    if (text[at - 1] == ' ') {
      names.insert(text.substr(begin, text.find('"', begin) - begin));
    }
  }
  for (const std::string tag : {"pFeature", "pValue", "pMax", "pSelected", "pIsLocked", "pPort"}) {
    for (std::size_t at = 0; (at = text.find("<" + tag + ">", at)) != std::string::npos; ++at) {
      const std::size_t begin = at + tag.size() + 2;
      const std::string target = text.substr(begin, text.find('<', begin) - begin);
      EXPECT_EQ(names.count(target), 1U) << tag << ' ' << target;
    }
  }
}

TEST(Genicam, AnIntegerHasItsLimitsAndItsRegister) {
  const std::string text = description();
  const std::string width = node(text, "Integer", "Width");
  EXPECT_THAT(width, HasSubstr("<pIsLocked>TLParamsLocked</pIsLocked>"));
  EXPECT_THAT(width, HasSubstr("<pValue>WidthReg</pValue>\n<Min>16</Min>\n<pMax>WidthMax</pMax>\n"
                               "<Inc>4</Inc>\n<Unit>px</Unit>"));
  const std::string place = node(text, "IntReg", "WidthReg");
  EXPECT_THAT(place, HasSubstr("<Address>0xA010</Address>\n<Length>4</Length>\n"
                               "<AccessMode>RW</AccessMode>\n<pPort>Device</pPort>\n"
                               "<Cachable>NoCache</Cachable>"));
  EXPECT_THAT(place, HasSubstr("<Endianess>BigEndian</Endianess>"));
  EXPECT_THAT(node(text, "IntReg", "WidthMaxReg"), HasSubstr("<Cachable>WriteThrough</Cachable>"));
}

TEST(Genicam, AFloatIsOfEightBytes) {
  const std::string text = description();
  EXPECT_THAT(node(text, "Float", "ExposureTime"), HasSubstr("<Min>10.5</Min>"));
  EXPECT_THAT(node(text, "FloatReg", "ExposureTimeReg"), HasSubstr("<Length>8</Length>"));
}

TEST(Genicam, BitsAreCountedFromTheMostSignificantOne) {
  EXPECT_THAT(node(description(), "MaskedIntReg", "GevSCPSFireTestPacketReg"),
              HasSubstr("<LSB>0</LSB>\n<MSB>0</MSB>"));
}

TEST(Genicam, ASelectorChoosesTheRegister) {
  const std::string text = description();
  EXPECT_THAT(node(text, "Enumeration", "ChunkSelector"),
              HasSubstr("<pSelected>ChunkEnable</pSelected>"));
  EXPECT_THAT(node(text, "IntReg", "ChunkEnableReg"),
              HasSubstr("<pIndex Offset=\"4\">ChunkSelectorReg</pIndex>"));
}

TEST(Genicam, AChunkIsAPortOfItsOwn) {
  const std::string text = description();
  EXPECT_THAT(node(text, "FloatReg", "ChunkGainReg"),
              HasSubstr("<pPort>Chunk52570004Port</pPort>"));
  EXPECT_THAT(node(text, "Port", "Chunk52570004Port"), HasSubstr("<ChunkID>52570004</ChunkID>"));
}

TEST(Genicam, ListsHaveNoFeatureWithoutCategory) {
  EXPECT_THAT(description(), Not(HasSubstr("<pFeature>TLParamsLocked</pFeature>")));
  EXPECT_THAT(node(description(), "Integer", "TLParamsLocked"), HasSubstr("<Value>0</Value>"));
}

TEST(Genicam, OneTableMakesTheMap) {
  const auto registers = feature_registers(some_features());
  std::vector<std::uint32_t> addresses;
  for (const FeatureRegister& each : registers) {
    addresses.push_back(each.row.address);
  }
  // The two registers of ChunkEnable, none for a chunk or for bits of a bootstrap register.
  EXPECT_EQ(addresses,
            (std::vector<std::uint32_t>{0xA008, 0xA010, 0xA018, 0xA100, 0xA110, 0xA114}));
  EXPECT_EQ(registers.back().selected, 1U);
  EXPECT_EQ(registers.back().feature, 4U);
}

TEST(Genicam, TheUrlIsHexadecimal) {
  EXPECT_EQ(local_url("camera.xml", 0x1'0000, 50388), "Local:camera.xml;10000;C4D4");
}

TEST(Bootstrap, RegistersDoNotOverlap) {
  std::uint32_t end = 0;
  for (const RegisterRow& row : kBootstrapRegisters) {
    EXPECT_GE(row.address, end) << row.name;
    EXPECT_EQ(row.address % 4, 0U) << row.name;
    EXPECT_EQ(row.length % 4, 0U) << row.name;
    end = row.address + row.length;
  }
}

}  // namespace
}  // namespace rigwire::protocols::gige_vision
