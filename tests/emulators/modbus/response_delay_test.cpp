#include "emulators/modbus/response_delay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "emulators/modbus/modbus_server.h"
#include "modbus_client.h"
#include "small_unit.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

std::vector<double> draws_s(const ResponseDelaySettings& settings, std::size_t count) {
  ResponseDelay delay(settings, 11);
  std::vector<double> result(count);
  std::ranges::generate(result, [&] { return to_seconds(delay.draw()); });
  return result;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  const double middle = mean(values);
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - middle) * (value - middle);
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(ResponseDelay, UniformHasTheMomentsOfItsRange) {
  const auto draws = draws_s({DelayDistribution::uniform, 0s, 0s, 2ms, 14ms}, 20'000);
  EXPECT_NEAR(mean(draws), 8e-3, 1e-4);
  EXPECT_NEAR(deviation(draws), 12e-3 / std::sqrt(12.0), 5e-5);
  EXPECT_GE(*std::ranges::min_element(draws), 2e-3);
  EXPECT_LE(*std::ranges::max_element(draws), 14e-3);
}

TEST(ResponseDelay, NormalIsHeldWithinItsLimits) {
  const auto free = draws_s({DelayDistribution::normal, 50ms, 5ms, 0s, 1s}, 20'000);
  EXPECT_NEAR(mean(free), 50e-3, 2e-4);
  EXPECT_NEAR(deviation(free), 5e-3, 2e-4);
  const auto held = draws_s({DelayDistribution::normal, 50ms, 50ms, 40ms, 60ms}, 2000);
  EXPECT_DOUBLE_EQ(*std::ranges::min_element(held), 40e-3);
  EXPECT_DOUBLE_EQ(*std::ranges::max_element(held), 60e-3);
}

TEST(ResponseDelay, OutOfRangeIsRefused) {
  using D = DelayDistribution;
  EXPECT_THROW(ResponseDelay({D::constant, -1ns, 0s, 0s, 1s}, 1), std::invalid_argument);
  EXPECT_THROW(ResponseDelay({D::constant, 11s, 0s, 0s, 1s}, 1), std::invalid_argument);
  EXPECT_THROW(ResponseDelay({D::uniform, 0s, 0s, 2s, 1s}, 1), std::invalid_argument);
  EXPECT_THROW(ResponseDelay({D::normal, 0s, 11s, 0s, 1s}, 1), std::invalid_argument);
}

TEST(ResponseDelay, AnswersKeepTheirOrderOnEachConnectionAndTheirTimesOverAll) {
  struct Ordered final : StreamOutput {
    void send(ConnectionId connection, SimTime due, std::span<const std::uint8_t> bytes) override {
      EXPECT_GE(due, latest) << "due times decrease";
      latest = due;
      while (!bytes.empty()) {
        const auto adu = protocols::modbus::decode_adu(bytes);
        ASSERT_TRUE(adu.ok());
        EXPECT_EQ(adu->header.transaction, next[connection]++) << "out of order";
        bytes = bytes.subspan(adu.consumed());
      }
    }
    void close(ConnectionId, SimTime) override {}
    SimTime latest{};
    std::array<std::uint16_t, 5> next{};
  };
  Ordered output;
  ModbusServerSettings settings;
  settings.response_delay = {DelayDistribution::uniform, 0s, 0s, 0s, 20ms};
  ModbusServer server(settings, output);
  SmallUnit unit;
  server.add_unit(1, unit);
  for (ConnectionId id = 0; id < 5; ++id) {
    server.connected(kStart, id);
  }
  constexpr std::uint16_t kRequests = 2000;
  SimTime now = kStart;
  for (std::uint16_t i = 0; i < kRequests; ++i) {
    for (ConnectionId id = 0; id < 5; ++id) {
      now += 317us;
      while (server.next_event() <= now) {
        server.advance(server.next_event());
      }
      server.receive(now, id, adu_of(protocols::modbus::ReadRegisters{}, i));
    }
  }
  server.advance(now + 1s);
  EXPECT_EQ(server.next_event(), kNever);
  for (const std::uint16_t answered : output.next) {
    EXPECT_EQ(answered, kRequests);
  }
}

TEST(ModbusServerIdle, WhoSaysNothingForTheTimeOutIsClosed) {
  RecordedStream output;
  ModbusServerSettings settings;
  settings.idle_timeout = 10s;
  ModbusServer server(settings, output);
  SmallUnit unit;
  server.add_unit(1, unit);
  server.connected(kStart, 1);
  server.connected(kStart + 1s, 2);
  server.receive(kStart + 5s, 1, adu_of(protocols::modbus::ReadRegisters{}));
  EXPECT_EQ(server.next_event(), kStart + 11s);
  server.advance(kStart + 11s);
  ASSERT_EQ(output.closed.size(), 1U);
  EXPECT_EQ(output.closed[0].connection, 2U);
  EXPECT_EQ(server.next_event(), kStart + 15s);
}

}  // namespace
}  // namespace rigwire::emulators
