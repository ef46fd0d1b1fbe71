// gpsd 3.22 on a receiver that it has just recognised (drivers/driver_ubx.c, ubx_cfg_prt): about
// twenty frames within a millisecond, twice, without waiting for one acknowledgement.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "driver.h"
#include "receiver_types.h"

namespace rigwire::emulators::conversation {
namespace {

using namespace std::chrono_literals;

struct Request {
  std::uint8_t id = 0;  ///< Identifier in class CFG.
  std::uint8_t kind = 0;
  std::uint8_t message = 0;
};

/// The bytes of a burst, and what of it must be answered in this order.
struct Burst {
  Bytes bytes;
  std::vector<Request> requests;

  void add(std::uint8_t kind, std::uint8_t id, const Bytes& payload = {}) {
    const Bytes frame = make_frame(kind, id, payload);
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  void rate(std::uint8_t kind, std::uint8_t id, std::uint8_t rate) {
    add(0x06, 0x01, {kind, id, rate});
    requests.push_back({0x01, kind, id});
  }
};

/// What gpsd writes for protocol `version` (0 = not known yet).
Burst burst(std::uint32_t baud, int version) {
  Burst all;
  all.add(0x06, 0x00,
          Payload()
              .u8(1)
              .u8(0)
              .u16(0)
              .u32(0x08D0)
              .u32(baud)
              .u16(0x0027)
              .u16(0x0023)
              .u16(0)
              .u16(0)
              .bytes);
  all.requests.push_back({0x00, 0, 0});
  all.add(0x0A, 0x04);
  all.rate(0x01, 0x04, 1);
  all.rate(0x01, 0x20, 1);
  all.rate(0x01, 0x06, version < 15 ? 1 : 0);
  all.rate(0x01, 0x30, version < 15 ? 1 : 0);
  for (const std::uint8_t id : Bytes{0x01, 0x07, 0x11, 0x35, 0x61}) {
    all.rate(0x01, id, version == 0 || version >= 15 ? 1 : 0);
  }
  all.rate(0x01, 0x26, 0xFF);
  for (const std::uint8_t id : Bytes{0x00, 0x01, 0x02, 0x03, 0x04, 0x05, 0x07, 0x08, 0x09}) {
    all.rate(0xF0, id, 0);
  }
  return all;
}

class GpsdBurst : public testing::TestWithParam<std::uint32_t> {
 protected:
  void collect(SimTime until) {
    while (line_.now() < until) {
      reader_.put(line_.read_until(until));
      while (auto frame = reader_.next()) {
        frames_.push_back(*std::move(frame));
      }
    }
  }
  /// Holds the acknowledgements against the requests, and forgets what came.
  void expect_answers(const Burst& burst) {
    std::vector<Frame> answers;
    for (const Frame& frame : frames_) {
      if (frame.kind == 0x05) {
        answers.push_back(frame);
      }
    }
    ASSERT_EQ(answers.size(), burst.requests.size());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const Request& request = burst.requests[i];
      EXPECT_EQ(answers[i].u8(0), 0x06U);
      EXPECT_EQ(answers[i].u8(1), request.id) << "answer " << i;
      // The messages that came with protocol 15 and 18.
      const bool unknown =
          request.id == 0x01 && request.kind == 0x01 &&
          (request.message == 0x35 || request.message == 0x61 || request.message == 0x26);
      EXPECT_EQ(answers[i].id, unknown ? 0x00 : 0x01)
          << "answer " << i << " to message " << int{request.message};
    }
  }
  [[nodiscard]] std::size_t count(std::uint8_t kind, std::uint8_t id) const {
    std::size_t found = 0;
    for (const Frame& frame : frames_) {
      found += frame.is(kind, id) ? 1U : 0U;
    }
    return found;
  }

  SerialLine line_;
  FrameReader reader_;
  std::vector<Frame> frames_;
};

TEST_P(GpsdBurst, NothingIsLostAndTheOldMessagesFlow) {
  UbloxSettings settings = receiver_types().front().settings;
  settings.baud = GetParam();
  UbloxReceiver receiver(settings, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), line_);
  line_.attach(receiver);
  line_.set_baud(GetParam());
  collect(kStart + 2500ms);

  // The probe, in the middle of an epoch's sentences.
  collect(kStart + 3200ms);
  frames_.clear();
  line_.write_at_once(make_frame(0x0A, 0x04, {}));
  line_.write_at_once(make_frame(0x06, 0x00, {}));
  collect(line_.now() + 1s);
  EXPECT_EQ(count(0x0A, 0x04), 1U);
  EXPECT_EQ(count(0x06, 0x00), 1U);
  EXPECT_EQ(count(0x05, 0x01), 1U);

  for (const int version : {0, 14}) {
    SCOPED_TRACE(version);
    frames_.clear();
    const Burst all = burst(GetParam(), version);
    line_.write_at_once(all.bytes);
    collect(line_.now() + 2s);
    expect_answers(all);
    EXPECT_EQ(count(0x0A, 0x04), 1U);
  }

  frames_.clear();
  reader_.forget_other();
  collect(line_.now() + 20s);
  for (const std::uint8_t id : Bytes{0x06, 0x30, 0x04, 0x20}) {
    EXPECT_EQ(count(0x01, id), 20U) << int{id};
  }
  EXPECT_EQ(frames_.size(), 4U * 20U) << "something that was switched off still comes";
  EXPECT_TRUE(reader_.other().empty()) << "bytes between the frames";
  EXPECT_EQ(receiver.counters().messages_lost, 0U);
}

INSTANTIATE_TEST_SUITE_P(Speeds, GpsdBurst, testing::Values(9600U, 38400U, 115200U),
                         [](const auto& test) {
                           return "at_" + std::to_string(test.param) + "_baud";
                         });

}  // namespace
}  // namespace rigwire::emulators::conversation
