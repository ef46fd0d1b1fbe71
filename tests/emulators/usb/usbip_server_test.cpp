#include "emulators/usb/usbip_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "protocols/bytes.h"
#include "protocols/usbip/constants.h"
#include "usb_probe.h"
#include "usbip_client.h"

namespace rigwire::emulators {
namespace {

using protocols::usbip::OperationStatus;
using ::testing::ElementsAre;

class UsbipServerTest : public ::testing::Test {
 protected:
  UsbipServerTest() {
    server.add(first, "first");
    server.add(second, "second");
  }
  UsbipClient client(ConnectionId id) { return {server, streams, id}; }
  /// A client that has imported the first device and configured it.
  UsbipClient importer(ConnectionId id = 1) {
    UsbipClient one = client(id);
    EXPECT_EQ(one.import("1-1").status, OperationStatus::ok);
    one.control({0x00, 9, 1, 0, 0});
    EXPECT_EQ(one.answer()->status, 0);
    return one;
  }

  RecordedStreams streams;
  UsbProbe first{1};
  UsbProbe second{2};
  UsbipServer server{{.transfers_max = 8}, streams};
};

TEST_F(UsbipServerTest, ListsWhatIsPluggedIn) {
  UsbipClient one = client(1);
  const auto listed = one.list();
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed[0].device.path, "/rigwire/first");
  EXPECT_EQ(listed[0].device.bus_id, "1-1");
  EXPECT_EQ(listed[1].device.bus_id, "1-2");
  EXPECT_EQ(listed[1].device.device, 2U);
  EXPECT_EQ(listed[1].device.product, 2);
  EXPECT_EQ(listed[0].interfaces.size(), 2U) << "alternate settings are not counted";
  server.unplug(kStart, 1);
  EXPECT_EQ(one.list().size(), 1U);
  EXPECT_EQ(one.list().size(), 1U) << "a connection may ask again";
}

TEST_F(UsbipServerTest, ASecondImporterIsRefusedUntilTheFirstHasGone) {
  UsbipClient one = importer(1);
  UsbipClient two = client(2);
  EXPECT_EQ(two.import("1-1").status, OperationStatus::failed);
  EXPECT_EQ(two.import("1-3").status, OperationStatus::failed);
  EXPECT_EQ(two.import("").status, OperationStatus::failed);
  EXPECT_EQ(two.import("1-2").status, OperationStatus::ok);
  one.disconnect();
  EXPECT_EQ(client(3).import("1-1").status, OperationStatus::ok);
  EXPECT_EQ(first.times_plugged, 2);
  EXPECT_EQ(first.times_unplugged, 1);
}

TEST_F(UsbipServerTest, RequestsMayBeCutAnywhereAndJoined) {
  UsbipClient one = client(1);
  protocols::usbip::ImportRequest request;
  request.bus_id = {'1', '-', '1'};
  auto bytes = protocols::usbip::encode_request(request);
  protocols::usbip::Submit submit;
  submit.number = 5;
  submit.device = 0x10001;
  submit.length = 3;
  submit.setup = {0x40, 2, 0, 0, 0, 0, 3, 0};
  const auto header = protocols::usbip::encode(submit);
  bytes.insert(bytes.end(), header.begin(), header.end());
  bytes.insert(bytes.end(), {7, 8, 9});
  for (const std::uint8_t byte : bytes) {
    one.send(std::span(&byte, 1));
  }
  EXPECT_THAT(first.written, ElementsAre(7, 8, 9));
  UsbipClient two = client(2);
  one.disconnect();
  first.written.clear();
  two.send(bytes);
  EXPECT_THAT(first.written, ElementsAre(7, 8, 9));
}

TEST_F(UsbipServerTest, ControlTransfersGoBothWays) {
  UsbipClient one = importer();
  one.control({0xC0, 1, 0, 0, 64});
  auto answer = one.answer();
  EXPECT_EQ(answer->status, 0);
  EXPECT_THAT(answer->data, ElementsAre(1, 2, 3, 4, 5));
  one.control({0xC0, 1, 0, 0, 2});
  EXPECT_THAT(one.answer()->data, ElementsAre(1, 2)) << "never more than asked for";
  one.control({0x40, 2, 0, 0, 3}, {4, 5, 6});
  answer = one.answer(false);
  EXPECT_EQ(answer->actual_length, 3U);
  EXPECT_THAT(first.written, ElementsAre(4, 5, 6));
  one.control({0x40, 99, 0, 0, 0});
  EXPECT_EQ(one.answer()->status, -32);
}

TEST_F(UsbipServerTest, LengthsThatContradictEachOtherAreSafe) {
  UsbipClient one = importer();
  one.submit(0x80, 3, {}, {0xC0, 1, 0, 0, 65535});  // asks for less than the setup says
  EXPECT_THAT(one.answer()->data, ElementsAre(1, 2, 3));
  one.submit(0x80, 65535, {}, {0xC0, 1, 0, 0, 4});
  EXPECT_EQ(one.answer()->actual_length, 4U);
  one.submit(0x00, 3, {1, 2, 3}, {0x40, 2, 0, 0, 9});  // less data than the setup says
  EXPECT_EQ(one.answer(false)->status, -32);
  one.submit(0x00, 3, {1, 2, 3}, {0xC0, 1, 0, 0, 5});  // directions differ
  EXPECT_EQ(one.answer(false)->status, -32);
  one.submit(0x80, 0, {}, {0x00, 9, 1, 0, 0});  // without data either direction will do
  EXPECT_EQ(one.answer()->status, 0);
}

TEST_F(UsbipServerTest, ReadsStayOpenUntilThereIsSomething) {
  UsbipClient one = importer();
  const auto interrupt = one.submit(0x81, 8);
  const auto bulk = one.submit(0x82, 512);
  EXPECT_FALSE(one.answer());
  EXPECT_EQ(server.open_transfers(1), 2U);
  first.answer(kStart, {1});
  first.answer(kStart, std::vector<std::uint8_t>(512, 2));
  auto answer = one.answer();
  EXPECT_EQ(answer->number, interrupt);
  EXPECT_THAT(answer->data, ElementsAre(1));
  answer = one.answer();
  EXPECT_EQ(answer->number, bulk);
  EXPECT_EQ(answer->actual_length, 512U);
}

TEST_F(UsbipServerTest, WritesTellWhatWasTaken) {
  UsbipClient one = importer();
  one.submit(0x02, 200, std::vector<std::uint8_t>(200, 9));
  const auto answer = one.answer(false);
  EXPECT_EQ(answer->actual_length, 200U);
  EXPECT_EQ(first.written.size(), 200U);
  one.submit(0x02, 0);
  EXPECT_EQ(one.answer(false)->actual_length, 0U);
}

TEST_F(UsbipServerTest, AShortAnswerIsAnErrorOnlyWhereTheHostSaysSo) {
  UsbipClient one = importer();
  one.flags = protocols::usbip::kShortNotOk;
  one.control({0xC0, 1, 0, 0, 64});
  const auto answer = one.answer();
  EXPECT_EQ(answer->status, -121);
  EXPECT_EQ(answer->actual_length, 5U);
}

TEST_F(UsbipServerTest, AnUnlinkedTransferIsNotAnswered) {
  UsbipClient one = importer();
  const auto transfer = one.submit(0x81, 8);
  const auto unlink = one.unlink(transfer);
  const auto answer = one.answer();
  EXPECT_TRUE(answer->unlink);
  EXPECT_EQ(answer->number, unlink);
  EXPECT_EQ(answer->status, -104);
  EXPECT_FALSE(one.answer());
  EXPECT_TRUE(first.reads.empty());
}

TEST_F(UsbipServerTest, AnUnlinkThatComesTooLateSaysSo) {
  UsbipClient one = importer();
  const auto transfer = one.submit(0x81, 8);
  first.answer(kStart, {1});
  EXPECT_EQ(one.answer()->number, transfer);
  one.unlink(transfer);
  EXPECT_EQ(one.answer()->status, 0);
  one.unlink(4711);  // never was
  EXPECT_EQ(one.answer()->status, 0);
}

TEST_F(UsbipServerTest, AStormOfUnlinksLeavesNothingOpen) {
  UsbipClient one = importer();
  for (int round = 0; round < 1000; ++round) {
    std::vector<std::uint32_t> open;
    for (int i = 0; i < 8; ++i) {
      open.push_back(one.submit(i % 2 == 0 ? 0x81 : 0x82, 64));
    }
    std::ranges::rotate(open, open.begin() + round % 8);
    for (const auto transfer : open) {
      one.unlink(transfer);
      ASSERT_EQ(one.answer()->status, -104);
      one.unlink(transfer);
      ASSERT_EQ(one.answer()->status, 0);
    }
  }
  EXPECT_EQ(server.open_transfers(1), 0U);
  EXPECT_TRUE(first.reads.empty());
}

TEST_F(UsbipServerTest, MoreOpenTransfersThanAllowedAreRefused) {
  UsbipClient one = importer();
  for (int i = 0; i < 8; ++i) {
    one.submit(0x81, 8);
  }
  EXPECT_FALSE(one.answer());
  one.submit(0x81, 8);
  EXPECT_EQ(one.answer()->status, -12);
  EXPECT_EQ(server.open_transfers(1), 8U);
}

TEST_F(UsbipServerTest, IsochronousTransfersAreRefusedAndTheirRecordsSkipped) {
  UsbipClient one = importer();
  one.packets = 3;
  one.submit(0x83, 192);
  EXPECT_EQ(one.answer()->status, -38);
  one.submit(0x03, 192, std::vector<std::uint8_t>(192, 1));
  EXPECT_EQ(one.answer(false)->status, -38);
  one.packets = 0xFFFFFFFF;
  one.control({0xC0, 1, 0, 0, 64});
  EXPECT_EQ(one.answer()->status, 0);
}

TEST_F(UsbipServerTest, AClientThatVanishesInMidTransferLeavesTheDeviceClean) {
  UsbipClient one = importer();
  one.submit(0x81, 8);
  one.submit(0x82, 64);
  const auto header = protocols::usbip::encode(protocols::usbip::Unlink{});
  one.send(std::span(header).first(20));  // and in mid message
  one.disconnect();
  EXPECT_TRUE(first.reads.empty());
  EXPECT_EQ(server.open_transfers(1), 0U);
  EXPECT_FALSE(server.imported(1));
  UsbipClient two = client(2);
  EXPECT_EQ(two.import("1-1").status, OperationStatus::ok);
  two.control({0x80, 8, 0, 0, 1});
  EXPECT_THAT(two.answer()->data, ElementsAre(0)) << "unconfigured again";
}

TEST_F(UsbipServerTest, UnpluggingAnswersWhatIsOpenAndEndsTheConnection) {
  UsbipClient one = importer();
  one.submit(0x81, 8);
  one.submit(0x82, 64);
  server.unplug(kStart, 1);
  EXPECT_EQ(one.answer()->status, -19);
  EXPECT_EQ(one.answer()->status, -19);
  EXPECT_FALSE(one.answer());
  EXPECT_TRUE(one.closed());
  EXPECT_EQ(first.times_unplugged, 1);
  one.submit(0x81, 8);  // already on its way
  EXPECT_FALSE(one.answer());
  EXPECT_EQ(client(2).import("1-1").status, OperationStatus::failed);
  one.disconnect();
  server.plug(kStart, 1);
  EXPECT_EQ(client(3).import("1-1").status, OperationStatus::ok);
  EXPECT_EQ(first.times_unplugged, 1) << "the end of the connection is no second removal";
}

TEST_F(UsbipServerTest, MalformedMessagesEndTheConnection) {
  const auto ends = [this](ConnectionId id, const std::function<void(UsbipClient&)>& misbehave) {
    UsbipClient one = importer(id);
    one.submit(0x81, 8);
    misbehave(one);
    const bool ended = one.closed() && !server.imported(1) && first.reads.empty();
    one.disconnect();
    return ended;
  };
  const auto send_header = [](UsbipClient& one, std::size_t at, std::uint32_t value) {
    protocols::usbip::Submit submit;
    submit.device = one.device;
    auto header = protocols::usbip::encode(submit);
    protocols::store_big(header, at, value);
    one.send(header);
  };
  EXPECT_TRUE(ends(1, [&](UsbipClient& one) { send_header(one, 0, 0x01118003); }));
  EXPECT_TRUE(ends(2, [&](UsbipClient& one) { send_header(one, 24, 0x80000000); }));
  EXPECT_TRUE(ends(3, [&](UsbipClient& one) { send_header(one, 8, 0x00010002); }));
  EXPECT_TRUE(ends(4, [&](UsbipClient& one) {
    --one.number;
    one.submit(0x81, 8);  // the number is still open
  }));
  EXPECT_EQ(server.received().malformed, 4U);
  UsbipClient five = client(5);
  five.send(std::vector<std::uint8_t>{'G', 'E', 'T', ' '});
  EXPECT_TRUE(five.closed());
}

TEST_F(UsbipServerTest, BadSettingsAreRefused) {
  EXPECT_THROW(UsbipServer({.transfers_max = 0}, streams), std::invalid_argument);
  EXPECT_THROW(server.add(first, ""), std::invalid_argument);
  EXPECT_THROW(server.add(first, std::string(247, 'x')), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
