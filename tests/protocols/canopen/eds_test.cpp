#include "protocols/canopen/eds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace rigwire::protocols::canopen {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::array kTable{
    live_entry(0x1000, 0, "device type", DataType::unsigned32),
    constant_entry(0x1018, 0, "highest sub-index", DataType::unsigned8, 1),
    live_entry(0x1018, 1, "vendor ID", DataType::unsigned32),
    setting_entry(0x1017, 0, "heartbeat", DataType::unsigned16, 0, 0, 0xFFFF),
    setting_entry(0x2040, 0, "quadrants", DataType::unsigned8, 0, 0, 2),
    live_entry(0x6010, 0, "slope", DataType::integer16, "counts", EntryFlag::kMappable)};

std::string sheet() {
  return make_eds({"some.eds", "A node", "Somebody", "Thing", 0x159, 0xABC, 0x10000}, kTable,
                  [](const ObjectEntry& entry) { return std::to_string(entry.initial); });
}

TEST(ElectronicDataSheet, SaysWhoTheDeviceIs) {
  EXPECT_THAT(sheet(), HasSubstr("[FileInfo]\r\nFileName=some.eds\r\n"));
  EXPECT_THAT(sheet(), HasSubstr("VendorNumber=0x00000159\r\n"));
  EXPECT_THAT(sheet(), HasSubstr("RevisionNumber=0x00010000\r\n"));
  EXPECT_THAT(sheet(), HasSubstr("LSS_Supported=1\r\n"));
}

TEST(ElectronicDataSheet, ListsEachObjectOnceInItsPart) {
  EXPECT_THAT(sheet(),
              HasSubstr("[MandatoryObjects]\r\nSupportedObjects=2\r\n1=0x1000\r\n2=0x1018"));
  EXPECT_THAT(sheet(),
              HasSubstr("[OptionalObjects]\r\nSupportedObjects=2\r\n1=0x1017\r\n2=0x6010"));
  EXPECT_THAT(sheet(), HasSubstr("[ManufacturerObjects]\r\nSupportedObjects=1\r\n1=0x2040"));
}

TEST(ElectronicDataSheet, ObjectsWithPartsHaveSubsections) {
  EXPECT_THAT(sheet(), HasSubstr("[1018]\r\nParameterName=Identity object\r\nObjectType=0x9\r\n"
                                 "SubNumber=2\r\n\r\n[1018sub0]\r\n"));
  EXPECT_THAT(sheet(), HasSubstr("[1018sub1]\r\nParameterName=vendor ID\r\nObjectType=0x7\r\n"
                                 "DataType=0x0007\r\nAccessType=ro\r\n"));
}

TEST(ElectronicDataSheet, LimitsAreWrittenWhereTheyAreNarrowerThanTheType) {
  EXPECT_THAT(sheet(), HasSubstr("[2040]\r\nParameterName=quadrants\r\nObjectType=0x7\r\n"
                                 "DataType=0x0005\r\nAccessType=rw\r\nDefaultValue=0\r\n"
                                 "PDOMapping=0\r\nLowLimit=0x00\r\nHighLimit=0x02\r\n"));
  EXPECT_THAT(sheet(), Not(HasSubstr("0xFFFF")));
  EXPECT_THAT(sheet(), HasSubstr("DataType=0x0003\r\nAccessType=ro\r\nDefaultValue=0\r\n"
                                 "PDOMapping=1\r\n"));
}

}  // namespace
}  // namespace rigwire::protocols::canopen
