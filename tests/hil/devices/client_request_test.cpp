#include "hil/devices/client_request.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_service.h"
#include "emulators/ublox/receiver.h"
#include "emulators/valve_driver/valve_driver.h"
#include "hil/devices/device.h"
#include "protocols/nmea/sentence.h"
#include "protocols/ubx/frame.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;

TEST(ClientRequest, a_can_frame_is_told_as_candump_does_with_its_parameter_group) {
  const auto text = [](const Frame& frame) {
    return client_request(emulators::CanRequest{kStart, frame})->text;
  };
  EXPECT_EQ(text({0x18EA80FE, true, false, 3, {0xDA, 0xFE, 0x00}}),
            "18EA80FE#DAFE00 (request of PGN 65242)");
  EXPECT_EQ(text({0x0C000003, true, false, 2, {1, 2}}), "0C000003#0102 (PGN 0)");
  EXPECT_EQ(text({0x60A, false, false, 2, {0x40, 0x00}}), "60A#4000");
  EXPECT_FALSE(client_request(std::optional<emulators::CanRequest>()).has_value());
}

TEST(ClientRequest, a_modbus_request_is_told_by_what_it_does_and_where) {
  emulators::ValveDriver driver{emulators::ValveDriverSettings{}};
  emulators::ModbusService service(emulators::ModbusWire::tcp, {}, 1);
  service.add_unit(1, driver.unit());
  EXPECT_FALSE(modbus_request(driver.last_request()).has_value());
  const auto after = [&](const std::vector<std::uint8_t>& pdu) {
    emulators::ModbusAnswer answer;
    service.serve(kStart + 1s, 1, pdu, answer);
    return *modbus_request(driver.last_request());
  };
  EXPECT_EQ(after({3, 0, 30, 0, 4}),
            (ClientRequest{kStart + 1s, "read holding registers 30 .. 33"}));
  EXPECT_EQ(after({6, 0, 1, 0, 5}).text, "write register 1");
  EXPECT_EQ(after({16, 0, 8, 0, 1, 2, 0, 0}).text, "write registers 8");
  EXPECT_EQ(after({3, 0, 30}).text, "read holding registers") << "cut off";
  EXPECT_EQ(after({43, 14, 1, 0}).text, "read device identification");
  EXPECT_EQ(after({99}).text, "function 99");
}

TEST(ClientRequest, a_receivers_request_is_told_by_class_and_number_or_as_its_sentence_begins) {
  emulators::UbloxSettings settings;
  settings.profile = &emulators::ublox_neo_7p();
  emulators::NullByteOutput line;
  emulators::UbloxReceiver receiver(settings, some_calendar(), line);
  receiver.advance(kStart + 5s);
  EXPECT_FALSE(ublox_request(receiver.last_request()).has_value());
  std::array<std::uint8_t, 64> frame{};
  const std::size_t size = protocols::ubx::encode_frame({0x06, 0x08}, {}, frame);
  receiver.receive(kStart + 5s, std::span(frame).first(size));
  EXPECT_EQ(*ublox_request(receiver.last_request()), (ClientRequest{kStart + 5s, "UBX CFG 0x08"}));
  const std::string sentence = "$PUBX,00*33\r\n";
  receiver.receive(kStart + 6s, std::vector<std::uint8_t>(sentence.begin(), sentence.end()));
  EXPECT_EQ(ublox_request(receiver.last_request())->text, "$PUBX,00");
}

TEST(ClientRequest, a_control_transfer_is_told_as_its_setup_packet) {
  const emulators::UsbRequest request{kStart + 1s, {0x21, 0x0A, 0x0400, 0, 0}};
  EXPECT_EQ(client_request(request)->text, "control 21 0a 0400 0000 0");
}

}  // namespace
}  // namespace rigwire::hil
