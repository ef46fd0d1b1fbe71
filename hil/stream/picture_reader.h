// The picture that a GigE Vision camera sent, from the packets of its stream, small enough to be
// looked at: of every so many pixels one, grey or red, green and blue.
//
// Of a block of several parts the first image is shown. A block of which a packet is missing makes
// no picture.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/gige_vision/gvsp.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct SmallPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string_view encoding;  ///< "mono8" or "rgb8".
  std::vector<std::uint8_t> pixels;
  // Of the picture that was sent.
  std::uint64_t block = 0;
  std::uint32_t sent_width = 0;
  std::uint32_t sent_height = 0;
};

class PictureReader {
 public:
  static constexpr std::uint32_t kMostWidth = 320;
  /// A picture beyond that is left out.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20U;
  /// From one picture to the next at least, simulated.
  static constexpr Duration kEvery = std::chrono::milliseconds{200};

  /// The next datagram of the stream. When a picture is whole it; valid until the next call.
  [[nodiscard]] const SmallPicture* take(SimTime at, std::span<const std::uint8_t> datagram);

 private:
  void begin(SimTime at, const protocols::gige_vision::StreamPacket& packet);
  void add(const protocols::gige_vision::StreamPacket& packet);
  /// Whether nothing is missing.
  [[nodiscard]] bool end();
  void place(std::size_t from, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool make_small();

  std::optional<std::uint64_t> block_;
  bool multipart_ = false;
  protocols::gige_vision::PartLeader part_;
  std::size_t part_number_ = 0;
  std::size_t part_from_ = 0;  ///< In the payload.
  std::vector<std::uint8_t> bytes_;
  std::size_t come_ = 0;    ///< Bytes, each counted once.
  std::size_t room_ = 0;    ///< Of a packet; 0: none has come.
  std::uint32_t last_ = 0;  ///< Number of the packet that came last.
  SimTime next_ = kStart;
  SmallPicture small_;
};

}  // namespace rigwire::hil
