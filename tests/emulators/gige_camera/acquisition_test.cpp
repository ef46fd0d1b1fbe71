// When the camera exposes, and what it wants of its sensor.
#include "emulators/gige_camera/acquisition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gige_camera_fixture.h"

namespace rigwire::emulators {
namespace {

using gev::Status;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

class AcquisitionTest : public GigeCameraFixture {
 protected:
  void by_software() {
    ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
    ASSERT_EQ(write(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::software)),
              Status::success);
  }
  Status trigger() { return write(reg::kTriggerSoftware, 1); }
};

TEST_F(AcquisitionTest, FreeRunningExposesFromItsStartAtItsRate) {
  make();
  EXPECT_EQ(camera->sample_plan().first, kNever);
  start_streaming();
  EXPECT_EQ(camera->sample_plan(), (SamplePlan{now, milliseconds{50}}));
  EXPECT_NEAR(camera->nominal_rate_hz(), 20.0 * 5, 1e-9);
  ASSERT_EQ(write(reg::kAcquisitionStop, 1), Status::success);
  EXPECT_EQ(camera->sample_plan().first, kNever);
  EXPECT_EQ(camera->nominal_rate_hz(), 0.0);
}

TEST_F(AcquisitionTest, AChangedRateActsAWholePeriodAfterTheLastExposure) {
  make();
  start_streaming();
  const SimTime start = now;
  pass(milliseconds{70});
  ASSERT_EQ(write_real(reg::kFrameRate, 10.0), Status::success);
  EXPECT_EQ(camera->sample_plan(), (SamplePlan{start + milliseconds{150}, milliseconds{100}}));
  // Other settings leave it as it is.
  ASSERT_EQ(write_real(reg::kGain, 6.0), Status::success);
  EXPECT_EQ(camera->sample_plan(), (SamplePlan{start + milliseconds{150}, milliseconds{100}}));
}

TEST_F(AcquisitionTest, TheRateIsLimitedByExposureReadOutAndNetwork) {
  make();
  take_control();
  ASSERT_EQ(write(reg::kFrameRateEnable, 0), Status::success);
  ASSERT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  EXPECT_DOUBLE_EQ(read_real(reg::kResultingFrameRate), 1.0 / 480e-6);  // 48 rows of 10 us
  ASSERT_EQ(write_real(reg::kExposureTime, 20'000.0), Status::success);
  EXPECT_DOUBLE_EQ(read_real(reg::kResultingFrameRate), 50.0);
  EXPECT_EQ(write_real(reg::kFrameRate, 51.0), Status::invalid_parameter);
  ASSERT_EQ(write(reg::kThroughputLimit, 1'000'000), Status::success);
  EXPECT_DOUBLE_EQ(read_real(reg::kResultingFrameRate), 50.0);
  ASSERT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  // Five packets of 1500 bytes at 1 MB/s.
  EXPECT_DOUBLE_EQ(read_real(reg::kResultingFrameRate), 1.0 / 7.5e-3);
}

TEST_F(AcquisitionTest, SettingsThatChangeTheBlockAreRefusedWhileItRuns) {
  make();
  start_streaming();
  for (const std::uint32_t address :
       {reg::kWidth, reg::kHeight, reg::kBinningHorizontal, reg::kBinningVertical}) {
    EXPECT_EQ(write(address, read(address)), Status::access_denied) << address;
  }
  EXPECT_EQ(write(reg::kPixelFormat, 0x0108'0001), Status::access_denied);
  EXPECT_EQ(write_real(reg::kExposureTime, 1234.5), Status::success);
  EXPECT_EQ(camera->command().exposure, Duration{1'234'500});
  EXPECT_EQ(write_real(reg::kGain, 3.25), Status::success);
  EXPECT_EQ(camera->command().gain_db, 3.25);
  EXPECT_EQ(write_real(reg::kBlackLevel, 2.0), Status::success);
  EXPECT_EQ(camera->command().black_level, 2.0);
}

TEST_F(AcquisitionTest, AutomaticExposureIsReadFromThePictures) {
  make();
  start_streaming();
  ASSERT_EQ(write(reg::kExposureAuto, 1), Status::success);
  ASSERT_EQ(write(reg::kGainAuto, 1), Status::success);
  EXPECT_TRUE(camera->command().exposure_auto);
  EXPECT_TRUE(camera->command().gain_auto);
  EXPECT_EQ(write_real(reg::kExposureTime, 100.0), Status::access_denied);
  EXPECT_EQ(write_real(reg::kGain, 1.0), Status::access_denied);
  const CameraCommand before = camera->command();
  auto picture = std::make_shared<Picture>(*drawn(before, now));
  picture->exposure = microseconds{777};
  picture->gain_db = 2.5;
  camera->update({now, now, picture});
  EXPECT_EQ(read_real(reg::kExposureTime), 777.0);
  EXPECT_EQ(read_real(reg::kGain), 2.5);
  EXPECT_EQ(camera->command(), before) << "the sensor is not told its own choice";
  ASSERT_EQ(write(reg::kExposureAuto, 0), Status::success);
  EXPECT_EQ(camera->command().exposure, microseconds{777});
}

TEST_F(AcquisitionTest, ASingleFrameEndsTheAcquisition) {
  make();
  take_control();
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionMode, 1), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  expose();
  EXPECT_FALSE(camera->acquiring());
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(received().size(), 1U);
  EXPECT_TRUE(received().at(1).trailer) << "the last block leaves to its end";
}

TEST_F(AcquisitionTest, SeveralFramesEndTheAcquisition) {
  make();
  take_control();
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionMode, 2), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionFrameCount, 3), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  for (int i = 0; i < 5; ++i) {
    expose();
    pass(milliseconds{10});
  }
  EXPECT_EQ(received().size(), 3U);
  EXPECT_FALSE(camera->acquiring());
}

TEST_F(AcquisitionTest, PicturesOfBeforeAreNotOfTheAcquisition) {
  make();
  take_control();
  open_stream();
  const SimTime before = now;
  now += milliseconds{20};
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  camera->update({now, before, drawn(camera->command(), before)});
  pass(milliseconds{10});
  EXPECT_TRUE(stream.sent.empty());
}

TEST_F(AcquisitionTest, LatePicturesAreCountedAndSent) {
  make();
  start_streaming();
  camera->update({now, now, drawn(camera->command(), now), true});
  EXPECT_EQ(camera->counters().late_pictures, 1U);
  EXPECT_EQ(camera->counters().pictures, 1U);
  pass(milliseconds{10});
  EXPECT_EQ(received().size(), 1U);
}

TEST_F(AcquisitionTest, SkippedPicturesAreCounted) {
  make();
  start_streaming();
  camera->update({now, now, nullptr});
  EXPECT_EQ(camera->counters().skipped_pictures, 1U);
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(received().begin()->first, 1U);
}

TEST_F(AcquisitionTest, ATriggerIsOneExposure) {
  make();
  take_control();
  by_software();
  EXPECT_EQ(trigger(), Status::access_denied) << "nothing waits for it yet";
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  EXPECT_EQ(camera->sample_plan().first, kNever);
  EXPECT_EQ(trigger(), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 1U);
  EXPECT_EQ(read(reg::kTriggerSoftware), 0U);
}

TEST_F(AcquisitionTest, ATriggerThatComesTooEarlyIsIgnoredAndCounted) {
  make();
  start_streaming();
  by_software();
  EXPECT_EQ(trigger(), Status::success);
  pass(microseconds{4999});  // the exposure takes 5 ms
  EXPECT_EQ(trigger(), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 1U);
  EXPECT_EQ(camera->counters().ignored_triggers, 1U);
  pass(microseconds{1});
  EXPECT_EQ(trigger(), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 2U);
}

TEST_F(AcquisitionTest, ADelayedTriggerActsLater) {
  make();
  start_streaming();
  by_software();
  ASSERT_EQ(write_real(reg::kTriggerDelay, 1500.0), Status::success);
  EXPECT_EQ(trigger(), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 0U);
  EXPECT_EQ(camera->next_event(), now + microseconds{1500});
  pass(microseconds{1500});
  EXPECT_EQ(camera->command().software_triggers, 1U);
}

TEST_F(AcquisitionTest, TheLineExposesAtItsPulses) {
  GigeCameraSettings settings = small();
  settings.line = {milliseconds{7}, milliseconds{100}, milliseconds{1}};
  make(settings);
  start_streaming();
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  ASSERT_EQ(write(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::line)),
            Status::success);
  EXPECT_EQ(camera->sample_plan(), (SamplePlan{kStart + milliseconds{1007}, milliseconds{100}}));
  EXPECT_EQ(trigger(), Status::access_denied);
  ASSERT_EQ(write_real(reg::kTriggerDelay, 250.0), Status::success);
  EXPECT_EQ(camera->sample_plan().first, kStart + microseconds{1'007'250});
}

TEST_F(AcquisitionTest, PulsesThatComeTooFastArePassedOver) {
  GigeCameraSettings settings = small();
  settings.line = {Duration{0}, milliseconds{2}, microseconds{100}};
  make(settings);
  start_streaming();  // exposures of 5 ms
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  ASSERT_EQ(write(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::line)),
            Status::success);
  EXPECT_EQ(camera->sample_plan().period, milliseconds{6});
}

TEST_F(AcquisitionTest, ALineWithoutPulsesExposesNothing) {
  make();
  start_streaming();
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  ASSERT_EQ(write(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::line)),
            Status::success);
  EXPECT_EQ(camera->sample_plan().first, kNever);
}

TEST_F(AcquisitionTest, PartsThatContradictThemselvesAreNotSent) {
  make();
  start_streaming();
  auto picture = std::make_shared<Picture>(*drawn(camera->command(), now));
  picture->parts[0].bytes.pop_back();
  camera->update({now, now, picture});
  pass(milliseconds{10});
  EXPECT_TRUE(stream.sent.empty());
}

TEST_F(AcquisitionTest, SettingsThatCannotBeAreRefusedByName) {
  const auto message = [](const auto& change) {
    GigeCameraSettings settings = small();
    change(settings);
    try {
      validate(settings);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  using testing::HasSubstr;
  EXPECT_EQ(message([](GigeCameraSettings&) {}), "nothing");
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.width = 60; }), HasSubstr("width is 60"));
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.serial_number = std::string(16, '1'); }),
              HasSubstr("serial_number has 16 bytes"));
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.formats = {PixelFormat::coord3d_c16}; }),
              HasSubstr("formats"));
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.exposure = seconds{2}; }),
              HasSubstr("exposure is 2 s"));
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.gain_db = 30; }), HasSubstr("gain_db"));
  EXPECT_THAT(message([](GigeCameraSettings& s) { s.address.address = 0x0A00'0001; }),
              HasSubstr("address is 10.0.0.1"));
  EXPECT_THAT(message([](GigeCameraSettings& s) {
                s.line = {Duration{0}, milliseconds{1}, milliseconds{1}};
              }),
              HasSubstr("width is 1 ms"));
}

}  // namespace
}  // namespace rigwire::emulators
