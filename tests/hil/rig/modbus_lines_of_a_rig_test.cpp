// Modbus lines of a rig and the devices on them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ModbusLinesOfARig : public testing::Test {
 protected:
  /// An excavator with these lines and devices.
  std::string complaints(const std::string& lines, const std::string& devices) {
    const std::string machine =
        std::string(RIGWIRE_SOURCE_DIR) + "/configs/machines/excavator_ref18t.yaml";
    std::ofstream(file_) << "machine: {include: " << machine << "}\nmodbus:\n"
                         << lines << "devices:\n"
                         << devices;
    try {
      (void)load_rig(file_, {});
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  rigwire::test::PrivateWires wires_;
  std::string file_ = (wires_.folder / "rig.yaml").string();
};

constexpr const char* kCab = "  cab: {wire: rtu, path: /tmp/rigwire/modbus}\n";

TEST_F(ModbusLinesOfARig, SeveralUnitsShareALine) {
  EXPECT_EQ(complaints(kCab,
                       "  front: {type: valve-driver, line: cab, unit: 1}\n"
                       "  rear: {type: valve-driver, line: cab, unit: 2}\n"),
            "");
}

TEST_F(ModbusLinesOfARig, UnitTakenTwiceIsRefused) {
  EXPECT_THAT(complaints(kCab,
                         "  front: {type: valve-driver, line: cab, unit: 3}\n"
                         "  rear: {type: valve-driver, line: cab, unit: 3}\n"),
              AllOf(HasSubstr("devices.rear.unit"), HasSubstr("already taken by"),
                    HasSubstr("devices.front.unit")));
}

TEST_F(ModbusLinesOfARig, UnknownLineIsToldWithTheOnesThatAre) {
  EXPECT_THAT(complaints(kCab, "  valves: {type: valve-driver, line: cap}\n"),
              AllOf(HasSubstr("devices.valves.line"), HasSubstr("no such Modbus line"),
                    HasSubstr("did you mean cab?")));
}

TEST_F(ModbusLinesOfARig, KeysOfTheOtherWireAreRefused) {
  EXPECT_THAT(complaints("  cab: {wire: rtu, port: 1503}\n", ""), HasSubstr("port"));
  EXPECT_THAT(complaints("  cab: {wire: tcp, baud: 9600}\n", ""), HasSubstr("baud"));
  EXPECT_THAT(complaints(kCab, "  valves: {type: valve-driver, line: cab, port: 1503}\n"),
              HasSubstr("port"));
}

}  // namespace
}  // namespace rigwire::hil
