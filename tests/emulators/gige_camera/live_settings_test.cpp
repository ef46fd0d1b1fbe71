// What a camera is told while it runs is what its client reads of its features.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "gige_camera_fixture.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

class GigeCameraLiveSettings : public GigeCameraFixture {
 protected:
  std::string tell(std::string_view key, const GigeCameraSettings& wanted) {
    const auto rows = GigeCamera::live_settings();
    return std::string(
        std::ranges::find(rows, key, &GigeCamera::Live::key)->tell(*camera, now, wanted));
  }
};

TEST_F(GigeCameraLiveSettings, EachIsTheFeatureThatAClientReads) {
  make();
  take_control();
  GigeCameraSettings wanted = small();
  wanted.frame_period = 100ms;
  wanted.exposure = 2ms;
  wanted.gain_db = 6.0;
  wanted.black_level = 3.0;
  wanted.throughput_bps = 80e6;
  wanted.packet_size = 1000;
  for (const char* key : {"rate", "exposure", "gain", "black_level", "throughput", "packet_size"}) {
    EXPECT_EQ(tell(key, wanted), "") << key;
  }
  EXPECT_DOUBLE_EQ(read_real(reg::kFrameRate), 10.0);
  EXPECT_DOUBLE_EQ(read_real(reg::kExposureTime), 2000.0);
  EXPECT_DOUBLE_EQ(read_real(reg::kGain), 6.0);
  EXPECT_DOUBLE_EQ(read_real(reg::kBlackLevel), 3.0);
  EXPECT_EQ(read(reg::kThroughputLimit), 10'000'000U);
  EXPECT_EQ(read(boot::kStreamPacketSize) & 0xFFFFU, 1000U);
  EXPECT_EQ(camera->frame_period(), 100ms);
  wanted.exposure_auto = true;
  wanted.gain_auto = true;
  EXPECT_EQ(tell("exposure_auto", wanted), "");
  EXPECT_EQ(tell("gain_auto", wanted), "");
  EXPECT_EQ(read(reg::kExposureAuto), 1U);
  EXPECT_EQ(read(reg::kGainAuto), 1U);
}

TEST_F(GigeCameraLiveSettings, WhatItRefusesItsClientItRefusesHere) {
  make();
  start_streaming();
  GigeCameraSettings wanted = small();
  wanted.packet_size = 1000;
  EXPECT_NE(tell("packet_size", wanted), "") << "while it acquires";
  EXPECT_EQ(read(boot::kStreamPacketSize) & 0xFFFFU, 1500U);
  wanted.exposure_auto = true;
  EXPECT_EQ(tell("exposure_auto", wanted), "");
  wanted.exposure = 2ms;
  EXPECT_NE(tell("exposure", wanted), "") << "it chooses that itself";
}

}  // namespace
}  // namespace rigwire::emulators
