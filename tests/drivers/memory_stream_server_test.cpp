#include "memory_stream_server.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(MemoryStreamServer, CarriesBytesBothWays) {
  MemoryStreamServer server;
  Bytes received;
  std::vector<StreamServer::ConnectionId> ended;
  server.start({{},
                [&](auto, auto bytes) { received.assign(bytes.begin(), bytes.end()); },
                [&](auto id) { ended.push_back(id); }});
  const auto id = server.client_connect();
  EXPECT_EQ(id, 1U);
  EXPECT_TRUE(server.status().client_present);
  EXPECT_TRUE(server.client_send(id, Bytes{1, 2}));
  EXPECT_EQ(received, (Bytes{1, 2}));
  EXPECT_TRUE(server.send(id, Bytes{3}));
  EXPECT_TRUE(server.send(id, Bytes{4}));
  EXPECT_EQ(server.client_take(id), (Bytes{3, 4}));
  EXPECT_TRUE(server.client_take(id).empty());
  server.client_close(id);
  EXPECT_EQ(ended, (std::vector<StreamServer::ConnectionId>{1}));
  EXPECT_FALSE(server.send(id, Bytes{5}));
  EXPECT_FALSE(server.client_send(id, Bytes{5}));
  EXPECT_EQ(server.client_connect(), 2U) << "numbers are never reused";
}

TEST(MemoryStreamServer, AHalfClosedClientIsToldAndStillServed) {
  MemoryStreamServer server;
  std::vector<StreamServer::ConnectionId> half_closed;
  server.start({.connected = {}, .received = {}, .disconnected = {}, .half_closed = [&](auto id) {
                  half_closed.push_back(id);
                }});
  const auto id = server.client_connect();
  server.client_half_close(id);
  EXPECT_EQ(half_closed, (std::vector<StreamServer::ConnectionId>{id}));
  const std::vector<std::uint8_t> answer{1, 2};
  EXPECT_TRUE(server.send(id, answer));
  server.close(id);
  EXPECT_EQ(server.client_take(id), answer);
  EXPECT_FALSE(server.open(id));

  MemoryStreamServer plain;
  plain.start({});
  const auto other = plain.client_connect();
  plain.client_half_close(other);
  EXPECT_FALSE(plain.open(other));
}

TEST(MemoryStreamServer, AFullBacklogEndsTheConnection) {
  MemoryStreamServer server({32, 4});
  const auto id = server.client_connect();
  EXPECT_TRUE(server.send(id, Bytes(4)));
  EXPECT_FALSE(server.send(id, Bytes(1)));
  EXPECT_FALSE(server.open(id));
}

TEST(MemoryStreamServer, TheQuietestClientMakesRoom) {
  MemoryStreamServer server({2, 100});
  const auto first = server.client_connect();
  const auto second = server.client_connect();
  server.client_send(first, Bytes{1});
  const auto third = server.client_connect();
  EXPECT_TRUE(server.open(first));
  EXPECT_FALSE(server.open(second));
  EXPECT_TRUE(server.open(third));
}

TEST(MemoryStreamServer, LimitsOfZeroAreRefused) {
  EXPECT_THROW(MemoryStreamServer({0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::drivers
