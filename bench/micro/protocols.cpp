// Encoding and decoding of one message of each family.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "protocols/modbus/mbap.h"
#include "protocols/modbus/pdu.h"
#include "protocols/nmea/readers.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"
#include "protocols/ubx/navigation.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::protocols {
namespace {

ubx::NavPvt solution(std::uint32_t i) {
  ubx::NavPvt message;
  message.time_of_week_ms = i;
  message.latitude_e7deg = 494247000;
  message.longitude_e7deg = 77517000;
  return message;
}

void ubx_encode(benchmark::State& state) {
  std::uint32_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(ubx::encode(solution(++i)));
  }
}
BENCHMARK(ubx_encode);

void ubx_decode(benchmark::State& state) {
  const auto frame = ubx::encode(solution(1));
  for (auto _ : state) {
    const auto view = ubx::decode_frame(frame);
    if (!view.ok() || !ubx::decode<ubx::NavPvt>(*view).ok()) {
      state.SkipWithError("not decoded");
      break;
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * frame.size()));
}
BENCHMARK(ubx_decode);

nmea::Epoch epoch() {
  nmea::Epoch value;
  value.time = nmea::TimeOfDay{8, 15, 30, 0};
  value.date = nmea::Date{2026, 6, 1};
  value.fix_dimensions = 3;
  value.latitude_deg = 49.4247;
  value.longitude_deg = 7.7517;
  value.satellites_used = 9;
  return value;
}

void nmea_write_gga(benchmark::State& state) {
  const nmea::Epoch value = epoch();
  for (auto _ : state) {
    nmea::Sentence sentence = nmea::write_gga(value);
    benchmark::DoNotOptimize(sentence.bytes().data());
  }
}
BENCHMARK(nmea_write_gga);

void nmea_read_gga(benchmark::State& state) {
  nmea::Sentence sentence = nmea::write_gga(epoch());
  const auto bytes = sentence.bytes();
  for (auto _ : state) {
    const auto view = nmea::decode_sentence(bytes);
    if (!view.ok() || !nmea::read_gga(*view).ok()) {
      state.SkipWithError("not decoded");
      break;
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes.size()));
}
BENCHMARK(nmea_read_gga);

velodyne::DataPacket data_packet() {
  velodyne::DataPacket packet;
  for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
    packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>(17 * b);
    for (std::size_t j = 0; j < velodyne::kChannelsPerBlock; ++j) {
      packet.blocks[b].channels[j] = {static_cast<std::uint16_t>(1000 * b + j), 30};
    }
  }
  return packet;
}

void velodyne_encode(benchmark::State& state) {
  velodyne::DataPacket packet = data_packet();
  std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
  for (auto _ : state) {
    ++packet.timestamp_us;
    velodyne::encode(packet, bytes);
    benchmark::DoNotOptimize(bytes.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes.size()));
}
BENCHMARK(velodyne_encode);

void velodyne_decode(benchmark::State& state) {
  std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
  velodyne::encode(data_packet(), bytes);
  for (auto _ : state) {
    const auto packet = velodyne::decode_data_packet(bytes);
    benchmark::DoNotOptimize(&packet);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes.size()));
}
BENCHMARK(velodyne_decode);

void openimu_encode(benchmark::State& state) {
  openimu::AngularRate rate;
  for (auto _ : state) {
    rate.pitch_dps = rate.pitch_dps > 100.0 ? -100.0 : rate.pitch_dps + 0.01;
    benchmark::DoNotOptimize(openimu::encode(rate, 0x80));
  }
}
BENCHMARK(openimu_encode);

void openimu_decode(benchmark::State& state) {
  const can::Frame frame = openimu::encode(openimu::AngularRate{}, 0x80);
  for (auto _ : state) {
    const auto rate = openimu::decode<openimu::AngularRate>(frame);
    benchmark::DoNotOptimize(&rate);
  }
}
BENCHMARK(openimu_decode);

void modbus_encode_and_decode(benchmark::State& state) {
  const std::array<std::uint16_t, 5> values{1, 2, 3, 4, 5};
  for (auto _ : state) {
    const modbus::Pdu pdu = modbus::encode_request(
        modbus::ReadWriteRegisters{1000, 10, 0, modbus::make_registers(values)});
    const modbus::AduBytes adu = modbus::encode_adu({}, pdu.view());
    const auto read = modbus::decode_adu(adu.view());
    if (!read.ok()) {
      state.SkipWithError("not decoded");
      break;
    }
    const auto request = modbus::decode_request(read->pdu);
    benchmark::DoNotOptimize(&request);
  }
}
BENCHMARK(modbus_encode_and_decode);

}  // namespace
}  // namespace rigwire::protocols
