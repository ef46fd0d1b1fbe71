#include "protocols/slcan/acceptance_filter.h"

namespace rigwire::protocols::slcan {
namespace {

/// What the frame holds, placed as the registers are, and which of those bits it has at all.
struct Image {
  std::uint32_t bits = 0;
  std::uint32_t present = 0;
};

std::uint32_t base_field(const can::Frame& frame) {
  return (frame.id & 0x7FFU) << 5U | (frame.remote ? 1U : 0U) << 4U;
}

Image single_image(const can::Frame& frame) {
  if (frame.extended) {
    return {(frame.id & 0x1FFFFFFFU) << 3U | (frame.remote ? 1U : 0U) << 2U, 0xFFFFFFFCU};
  }
  Image image{base_field(frame) << 16U, 0xFFF00000U};
  const auto data = frame.payload();
  if (!data.empty()) {
    image.bits |= std::uint32_t{data[0]} << 8U;
    image.present |= 0xFF00U;
  }
  if (data.size() > 1) {
    image.bits |= data[1];
    image.present |= 0xFFU;
  }
  return image;
}

Image first_image(const can::Frame& frame) {
  if (frame.extended) {
    return {((frame.id & 0x1FFFFFFFU) >> 13U) << 16U, 0xFFFF0000U};
  }
  Image image{base_field(frame) << 16U, 0xFFF00000U};
  const auto data = frame.payload();
  if (!data.empty()) {
    image.bits |= std::uint32_t{data[0]} >> 4U << 16U | (data[0] & 0xFU);
    image.present |= 0x000F000FU;
  }
  return image;
}

Image second_image(const can::Frame& frame) {
  if (frame.extended) {
    return {(frame.id & 0x1FFFFFFFU) >> 13U, 0xFFFFU};
  }
  return {base_field(frame), 0xFFF0U};
}

}  // namespace

bool AcceptanceFilter::accepts(const can::Frame& frame) const {
  const auto matches = [this](const Image& image) {
    return ((image.bits ^ code) & image.present & ~mask) == 0;
  };
  return single ? matches(single_image(frame))
                : matches(first_image(frame)) || matches(second_image(frame));
}

}  // namespace rigwire::protocols::slcan
