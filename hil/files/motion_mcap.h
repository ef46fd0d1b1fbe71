// Motion out of an MCAP of JSON messages, chunks not compressed, by the schemas of its channels:
//
//   foxglove.FrameTransforms, foxglove.FrameTransform   poses of links by child_frame_id; of
//                                                       parents that are no links, as in W
//   foxglove.PoseInFrame                                poses of the first link
//   rigwire.Motion, rigwire.Truth                       of a recording: velocities and
//                                                       accelerations of its links, what its ports
//                                                       read, the machine's fields
//
// The zero of a recording is the start of its run.
#pragma once

#include "hil/files/motion_contents.h"

namespace rigwire::hil {

/// Errors as read_motion() has them (hil/files/motion_file.h).
void read_mcap_motion(const MotionSettings& settings, MotionContents& contents);

}  // namespace rigwire::hil
