#include "dig_cycle/options.h"

namespace rigwire::dig_cycle {
namespace {

using field::number;
using field::port;
using field::refuse;
using field::split;
using field::whole;

std::array<std::uint32_t, kLinks> four(std::string_view option, std::string_view text,
                                       std::uint32_t upper, std::string_view allowed) {
  const auto parts = split(text);
  if (parts.size() != kLinks) {
    refuse(option, text, allowed);
  }
  std::array<std::uint32_t, kLinks> values{};
  for (std::size_t i = 0; i < kLinks; ++i) {
    values[i] = static_cast<std::uint32_t>(whole(option, parts[i], upper, allowed));
    for (std::size_t earlier = 0; earlier < i; ++earlier) {
      if (values[earlier] == values[i]) {
        refuse(option, text, "four different values");
      }
    }
  }
  return values;
}

void set_modbus(Options& options, std::string_view option, std::string_view text) {
  constexpr std::string_view kSerial = "rtu:";
  const bool serial = text.starts_with(kSerial);
  const std::size_t begin = serial ? kSerial.size() : 0;
  const std::size_t colon = text.find(':', begin);
  const std::string_view place = text.substr(begin, colon - begin);
  if (place.empty() || (!serial && colon == std::string_view::npos)) {
    refuse(option, text, "ADDRESS:PORT, such as 127.0.0.1:1502, or rtu:PATH[:BAUD]");
  }
  if (!serial) {
    options.modbus_host = place;
    options.modbus_port = port(option, text.substr(colon + 1));
    return;
  }
  options.modbus_path = place;
  if (colon != std::string_view::npos) {
    options.modbus_baud = field::baud(option, text.substr(colon + 1));
  }
}

const field::Setters<Options>& setters() {
  static const field::Setters<Options> kSetters{
      {"--gnss", [](Options& o, auto, auto v) { o.gnss = v; }},
      {"--gnss-baud", [](Options& o, auto n, auto v) { o.gnss_baud = field::baud(n, v); }},
      {"--lidar-address", [](Options& o, auto, auto v) { o.lidar_address = v; }},
      {"--lidar-port", [](Options& o, auto n, auto v) { o.lidar_port = port(n, v); }},
      {"--lidar-mount",
       [](Options& o, auto n, auto v) { o.lidar_mount = field::lidar_mount(n, v, o.lidar_mount); }},
      {"--can", [](Options& o, auto, auto v) { o.can = v; }},
      {"--imu-addresses",
       [](Options& o, auto n, auto v) {
         const auto values = four(n, v, 0xFD, "four J1939 addresses, 0..0xFD");
         for (std::size_t i = 0; i < kLinks; ++i) {
           o.imu.addresses[i] = static_cast<std::uint8_t>(values[i]);
         }
       }},
      {"--imu-identities",
       [](Options& o, auto n, auto v) {
         o.imu.identities = four(n, v, 0x1FFFFF, "four identity numbers, 0..0x1FFFFF");
       }},
      {"--modbus", set_modbus},
      {"--log", [](Options& o, auto, auto v) { o.log = v; }},
      {"--cycles",
       [](Options& o, auto n, auto v) {
         o.cycle.cycles = whole(n, v, 1'000'000'000, "a number, 0 = for ever");
       }},
      {"--duration", [](Options& o, auto n, auto v) { o.duration = field::seconds(n, v); }},
      {"--dig-azimuth",
       [](Options& o, auto n, auto v) {
         o.cycle.dig_azimuth_rad = number(n, v, -180, 180, "degrees, -180..180") * kDegree;
       }},
      {"--dump-azimuth",
       [](Options& o, auto n, auto v) {
         o.cycle.dump_azimuth_rad = number(n, v, -180, 180, "degrees, -180..180") * kDegree;
       }},
      {"--dig-sector",
       [](Options& o, auto n, auto v) {
         o.cycle.dig_sector_rad = number(n, v, 0, 90, "degrees, 0..90") * kDegree;
       }},
      {"--dig-depth", [](Options& o, auto n,
                         auto v) { o.cycle.dig_depth_m = number(n, v, 0, 1, "metres, 0..1"); }},
      {"--truck-load",
       [](Options& o, auto n, auto v) {
         o.cycle.truck_load_kg = 1e3 * number(n, v, 0, 1000, "tonnes, 0..1000, 0 = for ever");
       }},
  };
  return kSetters;
}

}  // namespace

Options parse_options(std::span<const std::string_view> arguments) {
  static const field::Flags<Options> kFlags{{"--help", &Options::help},
                                            {"-h", &Options::help},
                                            {"--quiet", &Options::quiet},
                                            {"--wait", &Options::wait}};
  return field::parse(arguments, setters(), kFlags);
}

std::string_view usage() {
  return R"(dig_cycle: works an excavator through its wires: digs, swings, dumps, returns.

usage: dig_cycle [options]

wires
  --gnss PATH             serial line of the GNSS receiver, NMEA   (/tmp/rigwire/gnss)
  --gnss-baud N           its speed                                (115200)
  --lidar-address ADDRESS where the lidar's packets arrive         (127.0.0.1)
  --lidar-port N          Velodyne data packets                    (2368)
  --can NAME              vcan0, an slcan adapter's path, or auto  (auto)
  --modbus ADDRESS:PORT   valve driver, Modbus TCP                 (127.0.0.1:1502)
  --modbus rtu:PATH[:BAUD]     the same on a serial line, 8E1      (115200)
fitting
  --lidar-mount X,Y,Z[,YAW,PITCH]  m and degrees, in the upper structure's frame
  --imu-addresses A,B,C,D      J1939 addresses: chassis, boom, stick, bucket (0x80..0x83)
  --imu-identities A,B,C,D     learn the addresses from claims with these identity numbers
work
  --cycles N              stop after N cycles, 0 = for ever        (0)
  --duration S            stop after S seconds
  --dig-azimuth DEG       swing angle of the face's middle         (0)
  --dig-sector DEG        dug to either side of it                 (36)
  --dump-azimuth DEG      swing angle of the truck                 (90)
  --dig-depth M           of one pull, down to 1.2 m in all        (0.35)
  --truck-load T          stop when the truck has so many tonnes, 0 = never  (30)
  --wait                  hold neutral while a sensor is silent, go on when it is back
output
  --log FILE              what it believes, one JSON object per line
  --quiet                 no progress on the terminal

exit status: 0 done or interrupted, 1 the machine does not follow, 2 usage, 3 a wire does not open,
4 a sensor went silent (the valves are neutral and disabled)
example: dig_cycle --cycles 2 --log /tmp/believed.jsonl
)";
}

}  // namespace rigwire::dig_cycle
