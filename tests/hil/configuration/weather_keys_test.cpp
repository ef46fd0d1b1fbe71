// Keys of a scene's weather.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "findings_of.h"
#include "hil/configuration/reader.h"
#include "hil/world/scene.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string findings_of(const std::string& yaml) {
  SceneConfiguration scene;
  return findings_of(yaml, scene);
}

TEST(WeatherKeys, UnitsReachTheMembers) {
  SceneConfiguration scene;
  ASSERT_EQ(
      findings_of("weather:\n"
                  "  course:\n"
                  "    - {rain: 10 mm/h, wind: 36 km/h, wind_from: 90 deg, dryness: 0.5}\n"
                  "    - {at: 2 min, fog_visibility: 0.2 km, snow: 1, haze_visibility: 8 km}\n"
                  "  rain: {model: goodin}\n"
                  "  dust: {echo: optical_depth, silt: 8 %}\n"
                  "  wind_gusts: {gust_time: 4 s}\n",
                  scene),
      "");
  const sim::WeatherParameters& weather = scene.weather;
  ASSERT_EQ(weather.course.size(), 2U);
  EXPECT_NEAR(weather.course[0].rain_mmph, 10.0, 1e-12);
  EXPECT_NEAR(weather.course[0].wind_mps, 10.0, 1e-12);
  EXPECT_NEAR(weather.course[0].wind_from_rad, 0.5 * std::numbers::pi, 1e-12);
  EXPECT_EQ(weather.course[0].dryness, 0.5);
  EXPECT_EQ(weather.course[1].at, std::chrono::minutes(2));
  EXPECT_EQ(weather.course[1].fog_visibility_m, 200.0);
  EXPECT_EQ(weather.course[1].snow_mmph, 1.0);
  EXPECT_EQ(weather.course[1].haze_visibility_m, 8000.0);
  EXPECT_EQ(weather.rain.model, sim::RainModel::goodin);
  EXPECT_EQ(weather.dust.echo, sim::DustEchoModel::optical_depth);
  EXPECT_NEAR(weather.dust.silt_share, 0.08, 1e-15);
  EXPECT_EQ(weather.wind.gust_time_s, 4.0);
  EXPECT_TRUE(weather.any());
}

TEST(WeatherKeys, ASceneWithoutThemHasClearAir) {
  SceneConfiguration scene;
  ASSERT_EQ(findings_of("name: fair", scene), "");
  EXPECT_FALSE(scene.weather.any());
}

TEST(WeatherKeys, ACourseCanBeSetOnTheCommandLine) {
  Problems problems;
  Value document = parse_document("name: fair", "a.yaml", RIGWIRE_SOURCE_DIR, problems);
  apply_set(document, "weather.course=[{rain: 20 mm/h}]", problems);
  Origins origins;
  SceneConfiguration scene;
  read(document, scene, problems, origins);
  EXPECT_NO_THROW(problems.throw_if_any());
  ASSERT_EQ(scene.weather.course.size(), 1U);
  EXPECT_NEAR(scene.weather.course[0].rain_mmph, 20.0, 1e-12);
}

TEST(WeatherKeys, BadValuesAreFoundWithTheirPlace) {
  EXPECT_THAT(
      findings_of("weather:\n  course:\n    - {rain: -3 mm/h}\n"),
      AllOf(HasSubstr("a.yaml:3"), HasSubstr("weather.course.0.rain"), HasSubstr("0 .. 300 mm/h")));
  EXPECT_THAT(findings_of("weather:\n  course:\n    - {rain: .nan}\n"), HasSubstr("course.0.rain"));
  EXPECT_THAT(findings_of("weather:\n  course:\n    - {rain: 5 kg}\n"), HasSubstr("mm/h"));
  EXPECT_THAT(findings_of("weather:\n  course:\n    - {rian: 5}\n"),
              HasSubstr("did you mean rain"));
  EXPECT_THAT(findings_of("weather:\n  course:\n    - {fog_visibility: 1 mm}\n"),
              HasSubstr("weather.course.0.fog_visibility: found 0.001 m"));
  EXPECT_THAT(findings_of("weather:\n  course:\n    - {at: 5 s, rain: 5}\n    - {at: 1 s}\n"),
              HasSubstr("later than the key frame before"));
}

}  // namespace
}  // namespace rigwire::hil
