#include "hil/wires/line_ports.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/descriptor.h"
#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;

TEST(LinePorts, AreNamedAfterTheFirst) {
  EXPECT_EQ(port_path("/tmp/rigwire/gnss", 0), "/tmp/rigwire/gnss");
  EXPECT_EQ(port_path("/tmp/rigwire/gnss", 2), "/tmp/rigwire/gnss.2");
  EXPECT_EQ(port_list("/tmp/rigwire/gnss", 1), "/tmp/rigwire/gnss");
  EXPECT_EQ(port_list("/tmp/rigwire/gnss", 3), "/tmp/rigwire/gnss, .1, .2");
}

TEST(LinePorts, EveryPortIsALineOfTheDevices) {
  const rigwire::test::PrivateWires wires;
  boost::asio::io_context context;
  const auto line = open_serial_ports(context, wires.gnss(), 2, 115200);
  line->start([](std::span<const std::uint8_t>) {});
  const drivers::Descriptor first(::open(wires.gnss().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  const drivers::Descriptor second(
      ::open((wires.gnss() + ".1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  const std::vector<std::uint8_t> sentence{'$', 'G', 'P', '\r', '\n'};
  std::string heard[2];
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while ((heard[0].empty() || heard[1].empty()) && std::chrono::steady_clock::now() < end) {
    context.run_for(std::chrono::milliseconds(5));
    context.restart();
    line->write(sentence);
    for (int i = 0; i < 2; ++i) {
      char bytes[64];
      const ssize_t size = ::read((i == 0 ? first : second).get(), bytes, sizeof bytes);
      heard[i].append(bytes, size > 0 ? static_cast<std::size_t>(size) : 0);
    }
  }
  EXPECT_THAT(heard[0], testing::StartsWith("$GP\r\n"));
  EXPECT_THAT(heard[1], testing::StartsWith("$GP\r\n"));
  EXPECT_EQ(line->status().address, wires.gnss());
}

TEST(LinePorts, APathThatIsTakenIsRefusedWhateverPortItIs) {
  const rigwire::test::PrivateWires wires;
  const auto file = (wires.folder / "rig.yaml").string();
  std::ofstream(file) << "include: " RIGWIRE_SOURCE_DIR
                         "/configs/rigs/gator_heading.yaml\n"
                         "devices:\n  gnss_left: {ports: 3}\n"
                         "  gnss_right: {path: /tmp/rigwire/gnss_left.2}\n";
  try {
    (void)load_rig(file, {});
    ADD_FAILURE() << "taken";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("already taken by devices.gnss_left.ports"));
  }
}

}  // namespace
}  // namespace rigwire::hil
