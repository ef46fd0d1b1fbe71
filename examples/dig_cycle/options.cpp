#include "dig_cycle/options.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace rigwire::dig_cycle {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view value,
                         std::string_view allowed) {
  throw UsageError(std::string(option) + ": found '" + std::string(value) + "', allowed " +
                   std::string(allowed));
}

double number(std::string_view option, std::string_view text, double lower, double upper,
              std::string_view allowed) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= lower) ||
      !(value <= upper)) {
    refuse(option, text, allowed);
  }
  return value;
}

std::uint64_t whole(std::string_view option, std::string_view text, std::uint64_t upper,
                    std::string_view allowed) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hexadecimal ? text.substr(2) : text;
  std::uint64_t value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size() || value > upper) {
    refuse(option, text, allowed);
  }
  return value;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t comma = text.find(',', at);
    parts.push_back(text.substr(at, comma - at));
    if (comma == std::string_view::npos) {
      return parts;
    }
    at = comma + 1;
  }
}

std::uint16_t port(std::string_view option, std::string_view text) {
  const auto value = whole(option, text, 65535, "a port, 1..65535");
  if (value == 0) {
    refuse(option, text, "a port, 1..65535");
  }
  return static_cast<std::uint16_t>(value);
}

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

std::chrono::nanoseconds seconds(std::string_view option, std::string_view text) {
  std::string_view digits = text;
  if (digits.ends_with("s")) {
    digits.remove_suffix(1);
  }
  const double value = number(option, digits, 0.0, 1e8, "seconds, 0 or more, such as 20 or 20s");
  return std::chrono::nanoseconds(std::llround(value * 1e9));
}

void set_modbus(Options& options, std::string_view option, std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) {
    refuse(option, text, "ADDRESS:PORT, such as 127.0.0.1:1502");
  }
  options.modbus_host = text.substr(0, colon);
  options.modbus_port = port(option, text.substr(colon + 1));
}

void set_mount(Options& options, std::string_view option, std::string_view text) {
  constexpr std::string_view kAllowed = "X,Y,Z in m and optionally YAW,PITCH in degrees";
  const auto parts = split(text);
  if (parts.size() != 3 && parts.size() != 5) {
    refuse(option, text, kAllowed);
  }
  LidarMount& mount = options.lidar_mount;
  mount.x_m = number(option, parts[0], -20.0, 20.0, kAllowed);
  mount.y_m = number(option, parts[1], -20.0, 20.0, kAllowed);
  mount.z_m = number(option, parts[2], -20.0, 20.0, kAllowed);
  if (parts.size() == 5) {
    mount.yaw_rad = number(option, parts[3], -360.0, 360.0, kAllowed) * kDegree;
    mount.pitch_rad = number(option, parts[4], -90.0, 90.0, kAllowed) * kDegree;
  }
}

using Setter = std::function<void(Options&, std::string_view, std::string_view)>;

const std::map<std::string_view, Setter>& setters() {
  static const std::map<std::string_view, Setter> kSetters{
      {"--gnss", [](Options& o, auto, auto v) { o.gnss = v; }},
      {"--gnss-baud",
       [](Options& o, auto n, auto v) {
         o.gnss_baud = static_cast<std::uint32_t>(
             number(n, v, 1200, 4'000'000, "a speed in bit/s, 1200..4000000"));
       }},
      {"--lidar-address", [](Options& o, auto, auto v) { o.lidar_address = v; }},
      {"--lidar-port", [](Options& o, auto n, auto v) { o.lidar_port = port(n, v); }},
      {"--lidar-mount", set_mount},
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
      {"--duration", [](Options& o, auto n, auto v) { o.duration = seconds(n, v); }},
      {"--dig-azimuth",
       [](Options& o, auto n, auto v) {
         o.cycle.dig_azimuth_rad = number(n, v, -180, 180, "degrees, -180..180") * kDegree;
       }},
      {"--dump-azimuth",
       [](Options& o, auto n, auto v) {
         o.cycle.dump_azimuth_rad = number(n, v, -180, 180, "degrees, -180..180") * kDegree;
       }},
      {"--dig-depth", [](Options& o, auto n,
                         auto v) { o.cycle.dig_depth_m = number(n, v, 0, 1, "metres, 0..1"); }},
  };
  return kSetters;
}

}  // namespace

Options parse_options(std::span<const std::string_view> arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string_view option = arguments[i];
    if (option == "--help" || option == "-h") {
      options.help = true;
      continue;
    }
    if (option == "--quiet") {
      options.quiet = true;
      continue;
    }
    if (option == "--wait") {
      options.wait = true;
      continue;
    }
    const std::size_t equals = option.find('=');
    std::string_view value;
    const bool joined = option.starts_with("--") && equals != std::string_view::npos;
    if (joined) {
      value = option.substr(equals + 1);
      option = option.substr(0, equals);
    }
    const auto setter = setters().find(option);
    if (setter == setters().end()) {
      throw UsageError("unknown option '" + std::string(option) + "'; --help lists them");
    }
    if (!joined) {
      if (i + 1 == arguments.size()) {
        throw UsageError(std::string(option) + ": a value is missing");
      }
      value = arguments[++i];
    }
    if (value.empty()) {
      throw UsageError(std::string(option) + ": the value is empty");
    }
    setter->second(options, option, value);
  }
  return options;
}

std::string_view usage() {
  return R"(dig_cycle: works an excavator through its wires: digs, swings, dumps, returns.

usage: dig_cycle [options]

wires
  --gnss PATH             serial line of the GNSS receiver, NMEA   (/tmp/rigwire/gnss)
  --gnss-baud N           its speed                                (9600)
  --lidar-address ADDRESS where the lidar's packets arrive         (127.0.0.1)
  --lidar-port N          Velodyne data packets                    (2368)
  --can NAME              vcan0, an slcan adapter's path, or auto  (auto)
  --modbus ADDRESS:PORT   valve driver, Modbus TCP                 (127.0.0.1:1502)
fitting
  --lidar-mount X,Y,Z[,YAW,PITCH]  m and degrees, in the upper structure's frame
  --imu-addresses A,B,C,D      J1939 addresses: chassis, boom, stick, bucket (0x80..0x83)
  --imu-identities A,B,C,D     learn the addresses from claims with these identity numbers
work
  --cycles N              stop after N cycles, 0 = for ever        (0)
  --duration S            stop after S seconds
  --dig-azimuth DEG       swing angle of the face                  (0)
  --dump-azimuth DEG      swing angle of the truck                 (90)
  --dig-depth M           below the ground that the lidar sees     (0.35)
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
