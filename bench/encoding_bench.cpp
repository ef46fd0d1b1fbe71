#include "bench/encoding_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "bench/cost.h"
#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "protocols/can/bits.h"
#include "protocols/nmea/readers.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"
#include "protocols/ubx/navigation.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::bench {
namespace {

namespace modbus = protocols::modbus;
namespace nmea = protocols::nmea;
namespace openimu = protocols::openimu;
namespace ubx = protocols::ubx;
namespace velodyne = protocols::velodyne;

constexpr double kBaud = 115'200.0;
constexpr double kBitsPerUartByte = 10.0;  // 8N1
constexpr double kCanBitRate = 250'000.0;
constexpr double kEthernetBitRate = 100e6;
constexpr std::size_t kEthernetOverhead = 8 /*preamble*/ + 14 /*header*/ + 4 /*check*/ + 12 /*gap*/;
constexpr std::size_t kEthernetLeast = 46;  // Payload of the shortest frame.
constexpr std::size_t kUdpHeaders = 20 /*IP*/ + 8 /*UDP*/;
constexpr std::size_t kTcpHeaders = 20 /*IP*/ + 20 /*TCP*/ + 12 /*time stamps*/;

double serial_limit(std::size_t bytes) {
  return kBaud / (kBitsPerUartByte * static_cast<double>(bytes));
}
double ethernet_limit(std::size_t payload_with_headers) {
  return kEthernetBitRate /
         (8.0 *
          static_cast<double>(kEthernetOverhead + std::max(payload_with_headers, kEthernetLeast)));
}

template <class Message, class Fill>
MessageCost ubx_cost(const char* name, const Fill& fill) {
  const auto bytes = ubx::frame_size<Message>();
  MessageCost cost{.message = name, .wire = "UART 115200 8N1", .bytes = bytes};
  cost.nanoseconds = nanoseconds_of([&](int i) {
    const auto frame = ubx::encode(fill(i));
    keep(frame.data());
  });
  for (int i = 0; i < kCostVariants; ++i) {
    const Message sent = fill(i);
    const auto frame = ubx::encode(sent);
    const auto view = ubx::decode_frame(frame);
    const auto read = ubx::decode<Message>(*view);
    cost.worst_error += *read == sent ? 0.0 : 1.0;
  }
  cost.error_unit = "messages that differ";
  cost.wire_limit_per_second = serial_limit(bytes);
  return cost;
}

MessageCost nav_pvt() {
  return ubx_cost<ubx::NavPvt>("UBX NAV-PVT", [](int i) {
    ubx::NavPvt message;
    message.time_of_week_ms = static_cast<std::uint32_t>(1000 * i);
    message.latitude_e7deg = 494247000 + 37 * i;
    message.longitude_e7deg = 77517000 - 11 * i;
    message.velocity_ned_mmps = {i, -i, 3 * i};
    message.fix_type = ubx::kFix3d;
    return message;
  });
}

MessageCost nav_sol() {
  return ubx_cost<ubx::NavSol>("UBX NAV-SOL", [](int i) {
    ubx::NavSol message;
    message.time_of_week_ms = static_cast<std::uint32_t>(1000 * i);
    message.position_cm = {411'000'000 + 3 * i, 56'000'000 - i, 482'000'000 + 7 * i};
    message.velocity_cmps = {i, -i, 3 * i};
    message.fix_type = ubx::kFix3d;
    return message;
  });
}

MessageCost gga() {
  const auto epoch = [](int i) {
    nmea::Epoch value;
    value.time = nmea::TimeOfDay{8, i % 60, (7 * i) % 60, i % 100};
    value.fix_dimensions = 3;
    value.latitude_deg = 49.4247 + 1.37e-6 * i;
    value.longitude_deg = 7.7517 - 2.11e-6 * i;
    value.altitude_m = 192.0 + 0.013 * i;
    value.separation_m = 48.0;
    value.satellites_used = 9;
    value.horizontal_dilution = 0.9;
    return value;
  };
  MessageCost cost{.message = "NMEA GGA", .wire = "UART 115200 8N1"};
  cost.nanoseconds = nanoseconds_of([&](int i) {
    nmea::Sentence sentence = nmea::write_gga(epoch(i));
    keep(sentence.bytes().data());
  });
  for (int i = 0; i < kCostVariants; ++i) {
    nmea::Sentence sentence = nmea::write_gga(epoch(i));
    const auto bytes = sentence.bytes();
    const auto view = nmea::decode_sentence(bytes);
    const auto read = nmea::read_gga(*view);
    cost.bytes = std::max(cost.bytes, bytes.size());
    cost.worst_error =
        std::max({cost.worst_error, std::abs(read->latitude_deg - epoch(i).latitude_deg),
                  std::abs(read->longitude_deg - epoch(i).longitude_deg)});
  }
  cost.error_unit = "deg";
  cost.half_count = 0.5e-5 / 60.0;  // Five decimals of a minute.
  cost.wire_limit_per_second = serial_limit(cost.bytes);
  return cost;
}

MessageCost data_packet() {
  velodyne::DataPacket packet;
  MessageCost cost{.message = "Velodyne data packet",
                   .wire = "UDP, 100BASE-TX",
                   .bytes = velodyne::kDataPacketSize};
  const auto fill = [&](int i) {
    for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
      packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>((100 * i + 17) % 36000);
      packet.blocks[b].channels[static_cast<std::size_t>(i) % velodyne::kChannelsPerBlock] = {
          static_cast<std::uint16_t>(97 * i), static_cast<std::uint8_t>(i % 101)};
    }
  };
  std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
  cost.nanoseconds = nanoseconds_of([&](int i) {
    fill(i);
    velodyne::encode(packet, bytes);
    keep(bytes.data());
  });
  for (int i = 0; i < kCostVariants; ++i) {
    fill(i);
    velodyne::encode(packet, bytes);
    const auto read = velodyne::decode_data_packet(bytes);
    cost.worst_error += *read == packet ? 0.0 : 1.0;
  }
  cost.error_unit = "messages that differ";
  cost.wire_limit_per_second = ethernet_limit(kUdpHeaders + velodyne::kDataPacketSize);
  return cost;
}

MessageCost angular_rate() {
  const auto fill = [](int i) {
    return openimu::AngularRate{.pitch_dps = 0.37 * i - 90.0,
                                .roll_dps = -0.21 * i,
                                .yaw_dps = 0.05 * i,
                                .latency_ms = 1.0};
  };
  MessageCost cost{.message = "J1939 ARI", .wire = "CAN 250 kbit/s", .bytes = 8};
  cost.nanoseconds = nanoseconds_of([&](int i) {
    const protocols::can::Frame frame = openimu::encode(fill(i), 0x80);
    keep(&frame);
  });
  unsigned most_bits = 0;
  for (int i = 0; i < kCostVariants; ++i) {
    const protocols::can::Frame frame = openimu::encode(fill(i), 0x80);
    most_bits = std::max(most_bits, protocols::can::exact_bits(frame));
    const auto read = openimu::decode<openimu::AngularRate>(frame);
    cost.worst_error = std::max({cost.worst_error, std::abs(read->pitch_dps - fill(i).pitch_dps),
                                 std::abs(read->roll_dps - fill(i).roll_dps),
                                 std::abs(read->yaw_dps - fill(i).yaw_dps)});
  }
  cost.error_unit = "deg/s";
  cost.half_count = 0.5 * openimu::kRate.count;
  cost.wire_limit_per_second = kCanBitRate / most_bits;
  return cost;
}

/// Keeps the latest answer.
class LatestAnswer final : public emulators::StreamOutput {
 public:
  void send(emulators::ConnectionId /*connection*/, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    size = std::min(bytes.size(), answer.size());
    std::copy_n(bytes.begin(), size, answer.begin());
  }
  void close(emulators::ConnectionId /*connection*/, SimTime /*due*/) override {}

  std::array<std::uint8_t, modbus::kTcpAduMaximum> answer{};
  std::size_t size = 0;
};

MessageCost register_exchange() {
  namespace reg = emulators::valve_registers;
  MessageCost cost{.message = "Modbus FC23 round trip", .wire = "TCP, 100BASE-TX"};
  LatestAnswer output;
  emulators::ValveDriver driver({});
  emulators::ModbusServer server({}, output);
  server.add_unit(1, driver.unit());
  server.connected(kStart, 1);
  SimTime now = kStart;
  constexpr std::uint16_t kRead = reg::kCoilCurrent;  // Status, fault code, spool positions.
  constexpr std::size_t kWritten = 1 + 4;             // Control word, four sections.
  std::size_t request_bytes = 0;
  const auto exchange = [&](int i) {
    std::array<std::uint16_t, kWritten> written{reg::kControlEnable};
    written[1] = static_cast<std::uint16_t>(i);
    now += std::chrono::milliseconds{1};
    const modbus::Pdu pdu = modbus::encode_request(modbus::ReadWriteRegisters{
        reg::kInputMirror, kRead, reg::kControl, modbus::make_registers(written)});
    const modbus::AduBytes adu =
        modbus::encode_adu({static_cast<std::uint16_t>(i), modbus::kModbusProtocol, 1}, pdu.view());
    request_bytes = adu.size;
    server.receive(now, 1, adu.view());
    keep(output.answer.data());
  };
  cost.nanoseconds = nanoseconds_of(exchange);
  for (int i = 0; i < kCostVariants; ++i) {
    exchange(i);
    const auto adu = modbus::decode_adu(std::span(output.answer).first(output.size));
    const auto response = modbus::decode_response(adu->pdu);
    const auto* registers = std::get_if<modbus::RegistersResponse>(&*response);
    const bool right = registers != nullptr && registers->registers.count == kRead &&
                       adu->header.transaction == static_cast<std::uint16_t>(i);
    cost.worst_error += right ? 0.0 : 1.0;
  }
  cost.error_unit = "answers that are wrong";
  cost.bytes = output.size;
  cost.wire_limit_per_second =
      ethernet_limit(kTcpHeaders + std::max(request_bytes, output.size));  // Full duplex.
  return cost;
}

}  // namespace

std::vector<MessageCost> measure_messages() {
  std::vector<MessageCost> costs{nav_pvt(),     nav_sol(),      gga(),
                                 data_packet(), angular_rate(), register_exchange()};
  for (MessageCost& cost : costs) {
    cost.per_second = 1e9 / cost.nanoseconds;
  }
  return costs;
}

}  // namespace rigwire::bench
