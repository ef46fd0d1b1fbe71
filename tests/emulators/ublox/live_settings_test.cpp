// What a receiver is told while it runs is what its client would tell it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "rig.h"
#include "supply_switch.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;
using namespace std::chrono_literals;

class UbloxLiveSettings : public UbloxReceiverTest {
 protected:
  std::string tell(UbloxReceiver& receiver, std::string_view key, const UbloxSettings& wanted) {
    const auto rows = UbloxReceiver::live_settings();
    return std::string(
        std::ranges::find(rows, key, &UbloxReceiver::Live::key)->tell(receiver, now_, wanted));
  }
};

/// Both receivers send the same bytes, but for the acknowledgement, which a client alone receives.
TEST_F(UbloxLiveSettings, TheRateIsThatOfCfgRate) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-POSECEF"};
  UbloxReceiver asked(settings, calendar_, line_);
  run(asked, kStart + 3300ms);
  say(asked, ubx::CfgRate{200, 1, 1});
  run(asked, kStart + 6s);
  Bytes by_client = line_.all;
  const auto acknowledge = ubx::encode(ubx::AckAck{0x06, 0x08});
  const auto at =
      std::search(by_client.begin(), by_client.end(), acknowledge.begin(), acknowledge.end());
  ASSERT_NE(at, by_client.end());
  by_client.erase(at, at + static_cast<std::ptrdiff_t>(acknowledge.size()));

  line_ = {};
  now_ = kStart;
  UbloxReceiver told(settings, calendar_, line_);
  run(told, kStart + 3300ms);
  UbloxSettings wanted = settings;
  wanted.measurement_period = 200ms;
  EXPECT_EQ(tell(told, "rate", wanted), "");
  run(told, kStart + 6s);
  EXPECT_EQ(line_.all, by_client);
}

TEST_F(UbloxLiveSettings, MessagesAreThoseOfTheListAndNoOthers) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"RMC", "GGA"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 2500ms);
  UbloxSettings wanted = settings;
  wanted.nmea_sentences = {"GGA", "ZDA"};
  wanted.ubx_messages = {"NAV-SOL"};
  EXPECT_EQ(tell(receiver, "nmea_sentences", wanted), "");
  EXPECT_EQ(tell(receiver, "ubx_messages", wanted), "");
  line_.clear();
  run(receiver, kStart + 3500ms);
  const std::string said = line_.text();
  EXPECT_NE(said.find("GPGGA"), std::string::npos);
  EXPECT_NE(said.find("GPZDA"), std::string::npos);
  EXPECT_EQ(said.find("GPRMC"), std::string::npos);
  EXPECT_EQ(ids(), (std::vector<ubx::MessageId>{{0x01, 0x06}}));
}

TEST_F(UbloxLiveSettings, BeforeItHasStartedItTakesNothing) {
  UbloxSettings settings = quiet();
  settings.start_up = 1s;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  UbloxSettings wanted = settings;
  wanted.measurement_period = 200ms;
  EXPECT_NE(tell(receiver, "rate", wanted), "");
  run(receiver, kStart + 1500ms);
  EXPECT_EQ(tell(receiver, "rate", wanted), "");
  test::switch_supply(receiver, now_, false);
  EXPECT_NE(tell(receiver, "rate", wanted), "");
}

TEST_F(UbloxLiveSettings, TheSecondUartHasItsOwn) {
  UbloxSettings settings = quiet();
  settings.profile = &ublox_zed_f9p();
  settings.uart2_messages = {"RTCM-1005"};
  UbloxLine second;
  UbloxReceiver receiver(settings, calendar_, line_, second);
  run(receiver, kStart + 1s);
  UbloxSettings wanted = settings;
  wanted.uart2_baud = 57'600;
  wanted.uart2_messages = {"RTCM-1077"};
  EXPECT_EQ(tell(receiver, "uart2_baud", wanted), "");
  EXPECT_EQ(tell(receiver, "uart2_messages", wanted), "");
  EXPECT_EQ(receiver.second_baud(), 57'600U);
  const auto rate = [&](std::string_view name, std::size_t port) {
    return static_cast<int>(
        receiver.configuration().message_rate(message_index(ublox_zed_f9p(), name), port));
  };
  EXPECT_EQ(rate("RTCM-1077", ubx::kPortUart2), 1);
  EXPECT_EQ(rate("RTCM-1005", ubx::kPortUart2), 0);
  EXPECT_EQ(rate("RTCM-1077", ubx::kPortUart1), 0);
  EXPECT_EQ(receiver.baud(), settings.baud) << "the first UART's";
}

}  // namespace
}  // namespace rigwire::emulators
