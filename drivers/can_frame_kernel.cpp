#include "drivers/can_frame_kernel.h"

#include <algorithm>

#include "protocols/can/error_frame.h"

namespace rigwire::drivers {

using protocols::can::ControllerReport;
using protocols::can::ErrorFrame;
using protocols::can::Frame;

can_frame to_kernel(const Frame& frame) {
  can_frame out{};
  out.can_id = frame.extended ? (frame.id & CAN_EFF_MASK) | CAN_EFF_FLAG : frame.id & CAN_SFF_MASK;
  out.can_id |= frame.remote ? CAN_RTR_FLAG : 0U;
  out.len = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

can_frame to_kernel(const ControllerReport& report) {
  const ErrorFrame frame = protocols::can::to_error_frame(report);
  can_frame out{};
  out.can_id = frame.id;
  out.len = CAN_MAX_DLEN;
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

Frame from_kernel(const can_frame& in) {
  Frame frame;
  frame.extended = (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (in.can_id & CAN_RTR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(in.len, CAN_MAX_DLEN);
  if (!frame.remote) {
    std::copy_n(in.data, frame.length, frame.data.begin());
  }
  return frame;
}

std::optional<ControllerReport> report_from_kernel(const can_frame& in) {
  ErrorFrame frame{in.can_id, {}};
  std::copy_n(in.data, frame.data.size(), frame.data.begin());
  const auto report = protocols::can::from_error_frame(frame);
  return report.ok() ? std::optional(*report) : std::nullopt;
}

}  // namespace rigwire::drivers
