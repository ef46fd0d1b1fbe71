#include "drivers/modbus_master.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <future>
#include <stdexcept>
#include <vector>

namespace rigwire::drivers {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

/// A device that takes one connection, reads one request of `request_size` bytes, and answers with
/// given bytes (its transaction number is copied from the request).
class ModbusMasterTest : public ::testing::Test {
 protected:
  ModbusMasterSettings settings() const {
    ModbusMasterSettings s;
    s.port = acceptor_.local_endpoint().port();
    s.response_timeout = 150ms;
    return s;
  }
  std::future<Bytes> answer_once(std::size_t request_size, Bytes answer) {
    return std::async(std::launch::async, [this, request_size, answer]() mutable {
      tcp::socket socket(context_);
      acceptor_.accept(socket);
      Bytes request(request_size);
      asio::read(socket, asio::buffer(request));
      if (answer.size() > 1) {
        answer[0] = request[0];
        answer[1] = request[1];
      }
      asio::write(socket, asio::buffer(answer));
      char end = 0;  // until the master goes
      boost::system::error_code error;
      socket.read_some(asio::buffer(&end, 1), error);
      return request;
    });
  }

  asio::io_context context_;
  tcp::acceptor acceptor_{context_, {asio::ip::address_v4::loopback(), 0}};
};

TEST_F(ModbusMasterTest, ReadsRegisters) {
  auto request = answer_once(12, {0, 0, 0, 0, 0, 7, 1, 4, 4, 0x12, 0x34, 0xFF, 0xFF});
  ModbusMaster master(settings());
  ASSERT_TRUE(master.connect());
  std::array<std::uint16_t, 2> values{};
  const auto outcome = master.read_input_registers(30, values);
  EXPECT_TRUE(outcome) << outcome.error;
  EXPECT_EQ(values, (std::array<std::uint16_t, 2>{0x1234, 0xFFFF}));
  master.close();
  const Bytes sent = request.get();
  EXPECT_THAT(Bytes(sent.begin() + 2, sent.end()),
              ::testing::ElementsAre(0, 0, 0, 6, 1, 4, 0, 30, 0, 2));
}

TEST_F(ModbusMasterTest, AnExceptionIsAnOutcomeAndTheConnectionStays) {
  auto request = answer_once(12, {0, 0, 0, 0, 0, 3, 1, 0x86, 3});
  ModbusMaster master(settings());
  ASSERT_TRUE(master.connect());
  const auto outcome = master.write_register(1, 2000);
  EXPECT_FALSE(outcome);
  EXPECT_EQ(outcome.exception, protocols::modbus::ExceptionCode::illegal_data_value);
  EXPECT_TRUE(master.connected());
  master.close();
  request.get();
}

TEST_F(ModbusMasterTest, SilenceEndsWithTheTimeOutAndClosesTheConnection) {
  auto request = answer_once(12, {});
  ModbusMaster master(settings());
  ASSERT_TRUE(master.connect());
  std::uint16_t value = 0;
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = master.read_holding_registers(0, std::span(&value, 1));
  EXPECT_FALSE(outcome);
  EXPECT_FALSE(outcome.exception);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 150ms);
  EXPECT_FALSE(master.connected());
  EXPECT_THAT(master.read_holding_registers(0, std::span(&value, 1)).error,
              HasSubstr("not connected"));
  request.get();
}

TEST_F(ModbusMasterTest, NobodyListeningIsAnOutcome) {
  const auto s = settings();
  acceptor_.close();
  ModbusMaster master(s);
  const auto outcome = master.connect();
  EXPECT_FALSE(outcome);
  EXPECT_THAT(outcome.error, HasSubstr("refused"));
}

TEST_F(ModbusMasterTest, TransactCarriesFunctionsThatLibmodbusDoesNotKnow) {
  auto request = answer_once(11, {0, 0, 0, 0, 0, 4, 1, 43, 14, 1});
  ModbusMaster master(settings());
  ASSERT_TRUE(master.connect());
  Bytes answer(253);
  std::size_t size = 0;
  const auto outcome = master.transact(Bytes{43, 14, 1, 0}, answer, size);
  EXPECT_TRUE(outcome) << outcome.error;
  answer.resize(size);
  EXPECT_EQ(answer, (Bytes{43, 14, 1}));
  master.close();
  request.get();
}

TEST_F(ModbusMasterTest, TooManyRegistersNeverReachTheWire) {
  auto device = answer_once(12, {0, 0, 0, 0, 0, 6, 1, 6, 0, 1, 0, 2});
  ModbusMaster master(settings());
  ASSERT_TRUE(master.connect());
  std::vector<std::uint16_t> values(126);
  EXPECT_FALSE(master.read_input_registers(0, values));
  EXPECT_TRUE(master.connected());
  EXPECT_TRUE(master.write_register(1, 2));
  master.close();
  device.get();
}

TEST(ModbusMasterSettingsTest, OutOfRangeIsRefused) {
  ModbusMasterSettings settings;
  settings.response_timeout = 0ms;
  EXPECT_THROW(ModbusMaster{settings}, std::invalid_argument);
  settings = {};
  settings.connect_timeout = 2min;
  EXPECT_THROW(ModbusMaster{settings}, std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::drivers
