// A field program's camera client takes any description, any answers and any stream: it refuses or
// reads, never reads past an end, holds no more memory than the camera promised, and hands over
// whole pictures only.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "field/gige_client.h"
#include "field/gige_description.h"
#include "field/gige_stream.h"

namespace field = rigwire::field;
namespace gev = rigwire::protocols::gige_vision;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void read_description(std::string_view text) {
  try {
    const field::GigeUrl url = field::read_gige_url(text);
    require(url.size > 0);
  } catch (const field::DescriptionError&) {
  }
  try {
    const field::GigeDescription description(text);
    for (const std::string_view name : {"A", "B", "C", "Width", "Scan3dBaseline"}) {
      try {
        const field::GigeFeature feature = description.find(name);
        if (!feature.constant && feature.kind != field::GigeFeature::Kind::text) {
          require(feature.length >= 1 && feature.length <= 8);
          require(feature.lowest_bit <= feature.highest_bit);
          require(feature.highest_bit < 8 * feature.length);
          std::array<std::uint8_t, 8> bytes{1, 2, 3, 4, 5, 6, 7, 8};
          (void)feature.decode(bytes.data());
          feature.encode(1, bytes.data());
        }
        (void)feature.value_of("1");
      } catch (const field::DescriptionError&) {
      }
    }
  } catch (const field::DescriptionError&) {
  }
}

/// Datagrams are cut out of the bytes: how long, after how much time, on which channel.
template <class Take>
static void datagrams(std::span<const std::uint8_t> bytes, Take take) {
  while (bytes.size() >= 3) {
    const std::uint8_t kind = bytes[0];
    const std::uint8_t wait = bytes[1];
    const auto data = bytes.subspan(3, std::min<std::size_t>(bytes.size() - 3, bytes[2]));
    bytes = bytes.subspan(3 + data.size());
    take(kind, std::chrono::milliseconds{wait}, data);
  }
}

static void receive_stream(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kPayload = 512;
  field::GigeStream::Instant now{0};
  field::GigeStream stream(
      {576, kPayload, true},
      [](const gev::PacketResend& resend) { require(resend.first <= resend.last); },
      [](const field::GigeBlock& block) {
        std::size_t total = 0;
        for (const field::GigePicture& picture : block.pictures) {
          require(picture.bytes.size() == picture.info.length);
          total += picture.bytes.size();
        }
        require(total <= kPayload);
      });
  datagrams(bytes, [&](std::uint8_t, std::chrono::milliseconds wait, auto data) {
    now += wait;
    stream.advance(now);
    stream.receive(now, data);
    const auto next = stream.next_event();
    require(!next || *next >= now - field::GigeStream::kQuiet);
  });
}

static void converse(std::span<const std::uint8_t> bytes) {
  field::GigeClientSettings settings;
  settings.settings = {{"A", "1", "B", "C", true}};
  settings.readings = {{"C", true}};
  std::size_t sent = 0;
  field::GigeClient client(settings, {0x7F00'0001, 50000},
                           {.send =
                                [&sent](std::span<const std::uint8_t> d) {
                                  require(d.size() <= gev::kGvcpSizeMaximum);
                                  ++sent;
                                },
                            .block = [](const field::GigeBlock&) {}});
  field::GigeClient::Instant now{0};
  client.start(now);
  datagrams(bytes, [&](std::uint8_t kind, std::chrono::milliseconds wait, auto data) {
    now += wait;
    client.advance(now);
    if (kind % 4 == 0) {
      client.receive_stream(now, data);
      return;
    }
    // Half of the answers belong to the command that is on its way, which counts from 1.
    std::vector<std::uint8_t> answer(data.begin(), data.end());
    if (kind % 4 != 1 && answer.size() >= 8) {
      answer[6] = 0;
      answer[7] = static_cast<std::uint8_t>(kind / 4);
    }
    client.receive_control(now, answer);
  });
  client.stop();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  read_description({reinterpret_cast<const char*>(data), size});
  receive_stream(bytes);
  converse(bytes);
  return 0;
}
