// Fields of RTCM 3 messages: bit_fields.h, as long as a payload can be.
//
// Source: RTCM 10403.3, section 3.3 (data types).
#pragma once

#include "protocols/bit_fields.h"
#include "protocols/rtcm3/frame.h"

namespace rigwire::protocols::rtcm3 {

using protocols::BitReader;
using protocols::nearest_count;
using protocols::Sign;
using BitWriter = protocols::BitWriter<kGreatestPayload>;

}  // namespace rigwire::protocols::rtcm3
