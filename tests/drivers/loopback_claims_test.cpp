// Places on loopback: nobody else is given what somebody has.
#include "drivers/loopback_claims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

using testing::StartsWith;

bool can_be_bound(std::uint32_t address, std::uint16_t port) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in end{};
  end.sin_family = AF_INET;
  end.sin_port = htons(port);
  end.sin_addr.s_addr = htonl(address);
  return ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&end), sizeof end) == 0;
}

TEST(LoopbackClaims, TwoNeverHaveTheSameNetwork) {
  std::vector<LoopbackClaims> claims(40);
  std::set<std::string> addresses;
  for (const LoopbackClaims& claim : claims) {
    EXPECT_THAT(claim.address(1), StartsWith("127."));
    addresses.insert(claim.address(1));
  }
  EXPECT_EQ(addresses.size(), claims.size());
}

TEST(LoopbackClaims, AnEndGivesTheNetworkBack) {
  std::optional<LoopbackClaims> first(std::in_place);
  const std::string had = first->address(7);
  first.reset();
  EXPECT_EQ(LoopbackClaims().address(7), had);
}

TEST(LoopbackClaims, APortCanBeBoundAtEveryAddressAndIsGivenOnce) {
  LoopbackClaims one;
  LoopbackClaims other;
  std::set<std::uint16_t> ports;
  for (int i = 0; i < 50; ++i) {
    for (LoopbackClaims* claims : {&one, &other}) {
      const std::uint16_t port = claims->datagram_port();
      EXPECT_TRUE(can_be_bound(INADDR_ANY, port));
      EXPECT_TRUE(can_be_bound(INADDR_LOOPBACK, port));
      EXPECT_TRUE(ports.insert(port).second);
    }
  }
}

}  // namespace
}  // namespace rigwire::drivers
