// Decodes the picture that a GigE Vision camera sent, from the packets of its stream, and reduces
// it for viewing: takes one of several pixels, grey or red, green and blue.
//
// A block of several parts is shown by its first image. Without one it is shown by its disparities
// or distances, grey within fixed limits, so that two pictures can be compared. A block with a
// missing packet makes no picture.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/gige_vision/gvsp.h"
#include "sim/samples/picture_sample.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// How the third coordinate of a camera's pictures is shown: grey in proportion, from black to
/// white. A pixel without a coordinate is black, too.
struct CoordinateScale {
  CoordinateCoding coding;
  std::string quantity;  ///< "disparity".
  std::string unit;      ///< "px": of the limits.
  double black = 0.0;
  double white = 1.0;  ///< May be less than `black`, but not equal to it.
};

struct SmallPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string_view encoding;  ///< "mono8" or "rgb8".
  std::vector<std::uint8_t> pixels;
  std::string remark;  ///< Limits of the grey of a coordinate; empty for an image.
  // Block number and size of the picture that was sent.
  std::uint64_t block = 0;
  std::uint32_t sent_width = 0;
  std::uint32_t sent_height = 0;
};

class PictureReader {
 public:
  static constexpr std::uint32_t kMostWidth = 320;
  /// Maximum size of a picture; a larger one is left out.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20U;
  /// Minimum simulated time from one picture to the next.
  static constexpr Duration kEvery = std::chrono::milliseconds{200};

  /// `scale`: of a camera with a third coordinate. Without it, coordinates are left out.
  explicit PictureReader(std::optional<CoordinateScale> scale = std::nullopt)
      : scale_(std::move(scale)) {}

  /// Takes the next datagram of the stream. Returns the picture that it completes; valid until the
  /// next call.
  [[nodiscard]] const SmallPicture* take(SimTime at, std::span<const std::uint8_t> datagram);

 private:
  void begin(SimTime at, const protocols::gige_vision::StreamPacket& packet);
  void add(const protocols::gige_vision::StreamPacket& packet);
  /// Returns whether nothing is missing.
  [[nodiscard]] bool end();
  void place(std::size_t from, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool make_small();
  /// Returns whether its pixels can be shown.
  [[nodiscard]] bool can_show(protocols::gige_vision::PixelFormatCode format) const;

  std::optional<CoordinateScale> scale_;
  std::optional<std::uint64_t> block_;
  bool multipart_ = false;
  protocols::gige_vision::PartLeader part_;
  std::size_t part_number_ = 0;
  std::size_t part_from_ = 0;  ///< In the payload.
  std::vector<std::uint8_t> bytes_;
  std::size_t come_ = 0;    ///< Bytes received, each counted once.
  std::size_t room_ = 0;    ///< Payload bytes of a full packet; 0: no packet yet.
  std::uint32_t last_ = 0;  ///< Number of the last received packet.
  SimTime next_ = kStart;
  SmallPicture small_;
};

}  // namespace rigwire::hil
