// The suite gige-vision on our camera, in its own time: right, with each of its faults, and with
// one thing wrong in what it says or takes.
#include "conform/gige_vision/gige_vision_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "conform/endpoint.h"
#include "emulated_camera.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using emulators::GigeCameraSettings;
using testing::Contains;
using testing::IsEmpty;
using testing::StartsWith;
using Bytes = EmulatedCamera::Bytes;
using Datagrams = std::vector<Bytes>;
using Changes = EmulatedCamera::Changes;

GigeCameraSettings settings() {
  GigeCameraSettings settings;
  settings.width = 128;
  settings.height = 96;
  return settings;
}

GigeVisionDevice device_of(const GigeCameraSettings& settings, const Changes& changes = {}) {
  GigeVisionDevice device;
  device.open = [=] { return std::make_unique<EmulatedCamera>(settings, changes); };
  device.camera = EmulatedCamera::kCamera;
  device.own_address = "127.0.0.1";
  return device;
}

GigeVisionClaims claims() {
  GigeVisionDevice device = device_of(settings());
  GigeVisionClaims claims = survey_gige_vision(device);
  claims.rate_hz = 1.0 / to_seconds(settings().frame_period);
  return claims;
}

SuiteResult judge(const GigeCameraSettings& settings, const Changes& changes = {},
                  const std::vector<std::string>& wanted = {}) {
  GigeVisionDevice device = device_of(settings, changes);
  device.claims = claims();
  return run_gige_vision_suite(device, {wanted, true, true});
}

TEST(GigeVisionSuite, OurCameraIsRight) {
  const GigeVisionClaims asked = claims();
  EXPECT_TRUE(asked.start && asked.stop && asked.payload_size);
  const SuiteResult result = judge(settings());
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_GE(result.count(Verdict::pass), 120U);
}

TEST(GigeVisionSuite, CasesHaveIdentitiesOfTheirOwn) {
  expect_identities(gige_vision_cases(), 120);
}

TEST(GigeVisionSuite, NothingIsWrittenWithoutTheOption) {
  int written = 0;
  GigeVisionDevice device =
      device_of(settings(), {.answering =
                                 [&](const Bytes& bytes) {
                                   // WRITEREG and WRITEMEM that succeed.
                                   written += (bytes.at(0) & 0x80U) == 0 && bytes.at(2) == 0 &&
                                              (bytes.at(3) == 0x83 || bytes.at(3) == 0x87);
                                   return Datagrams{bytes};
                                 },
                             .streaming = {},
                             .hearing = {}});
  device.claims = claims();
  const SuiteResult result = run_gige_vision_suite(device, {});
  EXPECT_GT(result.count(Verdict::skipped), 40U);
  EXPECT_EQ(written, 0);
}

TEST(GigeVisionSuite, SilenceIsUnreachable) {
  GigeVisionDevice device = device_of(
      settings(),
      {.answering = [](const Bytes&) { return Datagrams(); }, .streaming = {}, .hearing = {}});
  EXPECT_THROW(static_cast<void>(run_gige_vision_suite(device, {})), Unreachable);
}

// --- what is broken is noticed ---

EmulatedCamera::Change changing(const std::function<bool(const Bytes&)>& when,
                                const std::function<void(Bytes&)>& change) {
  return [=](const Bytes& bytes) {
    Bytes other = bytes;
    if (when(bytes)) {
      change(other);
    }
    return Datagrams{other};
  };
}
std::function<bool(const Bytes&)> code(std::uint8_t low) {
  return
      [low](const Bytes& bytes) { return bytes.size() >= 8 && bytes[2] == 0 && bytes[3] == low; };
}
/// Changes the answers to a command that succeed.
Changes answers(std::uint8_t low, const std::function<void(Bytes&)>& change) {
  return {.answering = changing(
              [low](const Bytes& bytes) { return code(low)(bytes) && bytes[0] == 0; }, change),
          .streaming = {},
          .hearing = {}};
}
/// Changes refusals.
Changes refusals(const std::function<void(Bytes&)>& change) {
  return {.answering = changing([](const Bytes& bytes) { return bytes.at(0) != 0; }, change),
          .streaming = {},
          .hearing = {}};
}
/// Changes packets of the stream that have this format; 0: all.
Changes packets(unsigned format, const std::function<void(Bytes&)>& change) {
  return {
      .answering = {},
      .streaming = changing(
          [format](const Bytes& bytes) { return format == 0 || bytes.at(4) == format; }, change),
      .hearing = {}};
}
/// Commands that hold for it do not arrive, or arrive changed.
Changes hearing(const std::function<bool(const Bytes&)>& when,
                const std::function<void(Bytes&)>& change) {
  return {.answering = {}, .streaming = {}, .hearing = changing(when, change)};
}
/// A read of that register.
std::function<bool(const Bytes&)> access_of(std::uint8_t command, unsigned address) {
  return [=](const Bytes& bytes) {
    return code(command)(bytes) && bytes.size() >= 12 && bytes[10] == address >> 8U &&
           bytes[11] == (address & 0xFFU);
  };
}
/// The answer to a read of that register has another value.
Changes valued(unsigned address, std::uint32_t value) {
  auto asked = std::make_shared<bool>(false);
  Changes changes;
  changes.hearing = [=](const Bytes& bytes) {
    *asked = access_of(0x80, address)(bytes) && bytes.size() == 12;
    return Datagrams{bytes};
  };
  changes.answering = [=](const Bytes& bytes) {
    Bytes other = bytes;
    if (std::exchange(*asked, false) && bytes.size() == 12) {
      for (unsigned i = 0; i < 4; ++i) {
        other[8 + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
      }
    }
    return Datagrams{other};
  };
  return changes;
}
/// Writes of that register set the heartbeat's timeout to 3000 ms instead.
Changes unwritten(unsigned address) {
  return hearing(
      [=](const Bytes& bytes) { return access_of(0x82, address)(bytes) && bytes.size() == 16; },
      [](Bytes& bytes) {
        const Bytes instead{0x00, 0x00, 0x09, 0x38, 0x00, 0x00, 0x0B, 0xB8};
        std::ranges::copy(instead, bytes.begin() + 8);
      });
}

struct Mutant {
  const char* name;
  const char* found_by;  ///< The begin of an identity of those that find it.
  Changes changes;
};
void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.name;
}

class GigeVisionMutant : public testing::TestWithParam<Mutant> {};

TEST_P(GigeVisionMutant, IsNoticed) {
  const Mutant& mutant = GetParam();
  EXPECT_THAT(wrong_ids(judge(settings(), mutant.changes, {mutant.found_by})),
              Contains(StartsWith(mutant.found_by)));
}

const std::function<void(Bytes&)> kNoise = [](Bytes& bytes) { bytes.back() ^= 0x55U; };

INSTANTIATE_TEST_SUITE_P(
    , GigeVisionMutant,
    testing::Values(
        Mutant{"discovery_too_short", "gige-vision/discovery/1",
               answers(0x03,
                       [](Bytes& b) {
                         b.resize(b.size() - 4);
                         b[5] = 0xF4;
                       })},
        Mutant{"length_wrong", "gige-vision/discovery/1",
               answers(0x03, [](Bytes& b) { b[5] ^= 4U; })},
        Mutant{"answers_unasked", "gige-vision/discovery/2",
               hearing(code(0x02), [](Bytes& b) { b[1] = 1; })},
        Mutant{"discovery_of_another", "gige-vision/discovery/3", answers(0x03, kNoise)},
        Mutant{"version_3", "gige-vision/discovery/4", answers(0x03, [](Bytes& b) { b[9] = 3; })},
        Mutant{"little_endian", "gige-vision/discovery/5",
               answers(0x03, [](Bytes& b) { b[12] = 0; })},
        Mutant{"no_character_set", "gige-vision/discovery/6",
               answers(0x03, [](Bytes& b) { b[15] = 0; })},
        Mutant{"mac_of_a_group", "gige-vision/discovery/7",
               answers(0x03, [](Bytes& b) { b[18] |= 1U; })},
        Mutant{"another_address", "gige-vision/discovery/8",
               answers(0x03, [](Bytes& b) { b[8 + 0x27] ^= 1U; })},
        Mutant{"mask_with_a_hole", "gige-vision/discovery/9",
               answers(0x03, [](Bytes& b) { b[8 + 0x37] = 1; })},
        Mutant{"text_behind_a_zero", "gige-vision/discovery/10",
               answers(0x03, [](Bytes& b) { b[8 + 0x67] = 'x'; })},
        Mutant{"nameless", "gige-vision/discovery/11", answers(0x85, [](Bytes& b) { b[12] = 0; })},
        Mutant{"registers_and_memory_differ", "gige-vision/reading/1", answers(0x85, kNoise)},
        Mutant{"values_changed_about", "gige-vision/reading/2",
               answers(0x81,
                       [](Bytes& b) {
                         if (b.size() == 16) {
                           std::swap_ranges(b.begin() + 8, b.begin() + 12, b.begin() + 12);
                         }
                       })},
        Mutant{"somebody_in_control", "gige-vision/reading/4", valued(0x0A00, 2)},
        Mutant{"refuses_without_a_reason", "gige-vision/reading/5", refusals([](Bytes& b) {
                 b[0] = 0x8F;
                 b[1] = 0xFF;
               })},
        Mutant{"accepts_everything", "gige-vision/reading/6",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"accepts_every_memory", "gige-vision/memory/7",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"memory_of_another_address", "gige-vision/memory/1",
               answers(0x85, [](Bytes& b) { b[11] ^= 4U; })},
        Mutant{"memory_that_changes", "gige-vision/memory/3",
               answers(0x85,
                       [n = std::make_shared<int>(0)](Bytes& b) {
                         b.back() = static_cast<std::uint8_t>(b.back() + ++*n);
                       })},
        Mutant{"url_without_a_size", "gige-vision/description/1",
               answers(0x85, [](Bytes& b) { std::ranges::replace(b, ';', ' '); })},
        Mutant{"url_of_text", "gige-vision/description/2",
               answers(0x85, [](Bytes& b) { std::ranges::replace(b, 'm', 'x'); })},
        Mutant{"description_cut_off", "gige-vision/description/6",
               answers(0x85, [](Bytes& b) { std::ranges::replace(b, '>', ' '); })},
        Mutant{"description_that_changes", "gige-vision/description/8",
               answers(0x85,
                       [n = std::make_shared<int>(0)](Bytes& b) {
                         b.back() = b.size() > 500 && ++*n > 40 ? 0x7E : b.back();
                       })},
        Mutant{"no_interface", "gige-vision/registers/10", valued(0x0600, 0)},
        Mutant{"no_stream_channel", "gige-vision/registers/12", valued(0x0904, 0)},
        Mutant{"heartbeat_of_100", "gige-vision/registers/14", valued(0x0938, 100)},
        Mutant{"unknown_commands_succeed", "gige-vision/acknowledge/1",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"anybody_writes", "gige-vision/acknowledge/2",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"request_of_another", "gige-vision/memory/1",
               answers(0x85, [](Bytes& b) { b[7] ^= 1U; })},
        Mutant{"code_of_another", "gige-vision/memory/1",
               answers(0x85, [](Bytes& b) { b[3] = 0x81; })},
        Mutant{"request_zero_taken", "gige-vision/acknowledge/7",
               hearing([](const Bytes& b) { return b.at(6) == 0 && b.at(7) == 0; },
                       [](Bytes& b) { b[7] = 1; })},
        Mutant{"answers_once",
               "gige-vision/acknowledge/8",
               {.answering =
                    [before = std::make_shared<int>(-1)](const Bytes& b) {
                      const int request = b.at(6) << 8 | b.at(7);
                      return std::exchange(*before, request) == request ? Datagrams()
                                                                        : Datagrams{b};
                    },
                .streaming = {},
                .hearing = {}}},
        Mutant{"answers_reads_unasked", "gige-vision/acknowledge/11",
               hearing(code(0x80), [](Bytes& b) { b[1] = 1; })},
        Mutant{
            "takes_any_key", "gige-vision/acknowledge/12",
            hearing([](const Bytes& b) { return b.at(0) == 0x43; }, [](Bytes& b) { b[0] = 0x42; })},
        Mutant{"control_not_taken", "gige-vision/control/1", valued(0x0A00, 0)},
        Mutant{"control_not_given_back", "gige-vision/control/2",
               hearing([](const Bytes& b) { return access_of(0x82, 0x0A00)(b) && b.back() == 0; },
                       [](Bytes& b) { b.back() = 2; })},
        Mutant{"control_of_anybody", "gige-vision/control/3",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"others_write", "gige-vision/control/5",
               refusals([](Bytes& b) { b[0] = b[1] = 0; })},
        Mutant{"no_exclusive_control", "gige-vision/control/6",
               hearing([](const Bytes& b) { return access_of(0x82, 0x0A00)(b) && b.back() == 1; },
                       [](Bytes& b) { b.back() = 2; })},
        Mutant{"heartbeat_not_kept", "gige-vision/control/8", unwritten(0x0938)},
        Mutant{"control_for_ever", "gige-vision/control/10", valued(0x0A00, 2)},
        Mutant{"control_lost_at_once", "gige-vision/control/11", valued(0x0A00, 0)},
        Mutant{"one_written_too_many", "gige-vision/control/13",
               answers(0x83, [](Bytes& b) { b.back() ^= 1U; })},
        Mutant{"time_stands", "gige-vision/time/1", valued(0x094C, 5)},
        Mutant{"time_is_not_latched", "gige-vision/time/2",
               answers(0x81,
                       [n = std::make_shared<int>(0)](Bytes& b) {
                         b.back() = static_cast<std::uint8_t>(b.back() + ++*n);
                       })},
        Mutant{"ticks_of_another", "gige-vision/timing-ticks/1", valued(0x0940, 500'000'000)},
        Mutant{"packet_size_not_kept", "gige-vision/stream/1", unwritten(0x0D04)},
        Mutant{"delay_not_kept", "gige-vision/stream/2", unwritten(0x0D08)},
        Mutant{"no_test_packet", "gige-vision/stream/3", unwritten(0x0D04)},
        Mutant{"test_packet_too_long", "gige-vision/stream/4",
               packets(0, [](Bytes& b) { b.push_back(0); })},
        Mutant{"no_pictures",
               "gige-vision/blocks/1",
               {.answering = {},
                .streaming = [](const Bytes&) { return Datagrams(); },
                .hearing = {}}},
        Mutant{"half_headers",
               "gige-vision/blocks/2",
               {.answering = {},
                .streaming =
                    [](const Bytes& b) {
                      return Datagrams{{1, 2, 3}, b};
                    },
                .hearing = {}}},
        Mutant{"packets_of_an_error", "gige-vision/blocks/3",
               packets(3,
                       [](Bytes& b) {
                         b[0] = 0x80;
                         b[1] = 0x0C;
                       })},
        Mutant{"leader_of_payload", "gige-vision/blocks/4", packets(1, [](Bytes& b) { b[4] = 3; })},
        Mutant{"packet_missing",
               "gige-vision/blocks/5",
               {.answering = {},
                .streaming =
                    [](const Bytes& b) {
                      return b.at(4) == 3 && b.at(7) == 2 ? Datagrams() : Datagrams{b};
                    },
                .hearing = {}}},
        Mutant{"packets_twice",
               "gige-vision/blocks/6",
               {.answering = {},
                .streaming =
                    [](const Bytes& b) {
                      return Datagrams{b, b};
                    },
                .hearing = {}}},
        Mutant{"blocks_downwards", "gige-vision/blocks/7",
               packets(0, [](Bytes& b) { b[3] = static_cast<std::uint8_t>(200 - b[3]); })},
        Mutant{"blocks_from_2", "gige-vision/blocks/8",
               packets(0, [](Bytes& b) { b[3] = static_cast<std::uint8_t>(b[3] + 1); })},
        Mutant{"packets_short", "gige-vision/blocks/10",
               packets(3, [](Bytes& b) { b.pop_back(); })},
        Mutant{"payload_type_unknown", "gige-vision/blocks/12",
               packets(1, [](Bytes& b) { b[11] = 0x3F; })},
        Mutant{"time_goes_back", "gige-vision/blocks/13",
               packets(1,
                       [](Bytes& b) {
                         for (std::size_t i = 12; i < 20; ++i) {
                           b[i] = static_cast<std::uint8_t>(~b[i]);
                         }
                       })},
        Mutant{"the_same_picture", "gige-vision/blocks/14",
               packets(3, [](Bytes& b) { std::fill(b.begin() + 8, b.end(), 7); })},
        Mutant{"a_line_more", "gige-vision/blocks/15", packets(1, [](Bytes& b) { ++b[31]; })},
        Mutant{"image_too_short",
               "gige-vision/blocks/16",
               {.answering = {},
                .streaming =
                    [](const Bytes& b) {
                      Bytes other = b;
                      if (b.at(4) == 3 && b.size() < 4000) {
                        other.resize(b.size() / 2);
                      }
                      return Datagrams{other};
                    },
                .hearing = {}}},
        Mutant{"trailer_of_another_height", "gige-vision/blocks/17",
               packets(2, [](Bytes& b) { ++b[15]; })},
        Mutant{"deaf_to_resends", "gige-vision/blocks/18",
               hearing(code(0x40), [](Bytes& b) { b[0] = 0; })},
        Mutant{"resends_others", "gige-vision/blocks/18",
               hearing(code(0x40),
                       [](Bytes& b) {
                         b[15] = 0;
                         b[19] = 0;
                       })},
        Mutant{"resends_what_never_was", "gige-vision/blocks/20",
               hearing(code(0x40),
                       [](Bytes& b) {
                         b[13] = b[14] = b[17] = b[18] = 0;
                         b[15] = b[19] = 1;
                       })},
        Mutant{"never_ends", "gige-vision/blocks/21",
               // Turns the stop of the acquisition into a start.
               hearing(access_of(0x82, 0xA108), [](Bytes& b) { b[11] = 0x04; })}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

struct Faulty {
  const char* name;
  const char* found_by;
  std::function<void(GigeCameraSettings&)> what;
};
void PrintTo(const Faulty& faulty, std::ostream* out) {
  *out << faulty.name;
}

template <class Fault>
std::function<void(GigeCameraSettings&)> with(const Fault& fault, Duration begin = Duration{0}) {
  return [=](GigeCameraSettings& settings) {
    settings.faults.push_back({{begin, std::chrono::hours{1}}, fault});
  };
}

class GigeVisionFaulty : public testing::TestWithParam<Faulty> {};

TEST_P(GigeVisionFaulty, IsNoticed) {
  GigeCameraSettings broken = settings();
  GetParam().what(broken);
  EXPECT_THAT(wrong_ids(judge(broken, {}, {GetParam().found_by})), testing::Not(IsEmpty()));
}

// What exposures and triggers are asked for is in makers' registers, which no profile names.
INSTANTIATE_TEST_SUITE_P(
    , GigeVisionFaulty,
    testing::Values(
        Faulty{"lost", "gige-vision/blocks/5",
               with(emulators::LostStreamPacketsFault{.share = 0.1})},
        Faulty{"swapped", "gige-vision/blocks/5",
               with(emulators::SwappedStreamPacketsFault{.share = 0.2})},
        Faulty{"repeated", "gige-vision/blocks/6",
               with(emulators::DuplicatedStreamPacketsFault{.share = 0.2})},
        Faulty{"frozen", "gige-vision/blocks/14", with(emulators::FrozenFrameFault{})},
        Faulty{"refuses", "gige-vision/control/8", with(emulators::RefusedWritesFault{})},
        // While it acquires.
        Faulty{"unplugged", "gige-vision/blocks/1",
               with(emulators::LinkDownFault{}, std::chrono::seconds{2})},
        Faulty{"over_temperature", "gige-vision/blocks/1", with(emulators::OverTemperatureFault{})},
        Faulty{"slow", "gige-vision/blocks/23", with(emulators::SlowPicturesFault{.share = 0.9})}),
    [](const auto& faulty) { return std::string(faulty.param.name); });

}  // namespace
}  // namespace rigwire::conform
