#include "bench/private_rig.h"

#include <fmt/format.h>

#include <filesystem>

#include "hil/command_line/config_files.h"

namespace rigwire::bench {
namespace {

using boost::asio::ip::tcp;
using boost::asio::ip::udp;

template <class Endpoint>
Endpoint any_port() {
  return {boost::asio::ip::address_v4::loopback(), 0};
}

hil::RigConfiguration load(const std::filesystem::path& folder, std::uint16_t data_port,
                           std::uint16_t position_port, std::uint16_t modbus_port,
                           const std::vector<std::string>& sets) {
  std::vector<std::string> all{
      fmt::format("devices.gnss.path={}", (folder / "gnss").string()),
      "buses.can.wire=slcan",
      fmt::format("buses.can.path={}", (folder / "can").string()),
      fmt::format("devices.lidar.port={}", data_port),
      fmt::format("devices.lidar.position_port={}", position_port),
      fmt::format("devices.valves.port={}", modbus_port),
  };
  all.insert(all.end(), sets.begin(), sets.end());
  return hil::load_rig(hil::find_rig(kBenchRig), all).configuration;
}

}  // namespace

PrivateRig::PrivateRig(const std::vector<std::string>& sets)
    : data_sink_(io_, any_port<udp::endpoint>()),
      position_sink_(io_, any_port<udp::endpoint>()),
      modbus_port_(tcp::acceptor(io_, any_port<tcp::endpoint>()).local_endpoint().port()) {
  configuration_ = load(folder_.path(), data_sink_.local_endpoint().port(),
                        position_sink_.local_endpoint().port(), modbus_port_, sets);
}

}  // namespace rigwire::bench
