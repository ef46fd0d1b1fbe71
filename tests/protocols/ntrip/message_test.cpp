#include "protocols/ntrip/message.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::ntrip {
namespace {

Decoded<Request> read(const std::string& text) {
  return decode_request({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// What str2str 2.4.3 b34 sends.
const std::string kRtklib =
    "GET /MP HTTP/1.0\r\nUser-Agent: NTRIP RTKLIB/2.4.3\r\nAuthorization: Basic dTpw\r\n\r\n";

TEST(NtripRequest, RtklibsIsRead) {
  const auto request = read(kRtklib);
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request.consumed(), kRtklib.size());
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->mount(), "MP");
  EXPECT_EQ(request->user_agent, "NTRIP RTKLIB/2.4.3");
  EXPECT_EQ(request->credentials, "u:p");
  EXPECT_FALSE(request->second_version);
}

TEST(NtripRequest, SecondVersionIsSaidByItsHeader) {
  const auto request = read(
      "GET /A?x HTTP/1.1\r\nhost: b\r\nntrip-version: NTRIP/2.0\r\nAUTHORIZATION: basic "
      "YWxhZGRpbjpvcGVuIHNlc2FtZQ==\r\n\r\nrest");
  ASSERT_TRUE(request.ok());
  EXPECT_TRUE(request->second_version);
  EXPECT_EQ(request->mount(), "A");
  EXPECT_EQ(request->credentials, "aladdin:open sesame");
}

TEST(NtripRequest, EveryBeginningIsIncomplete) {
  for (std::size_t size = 0; size < kRtklib.size(); ++size) {
    EXPECT_TRUE(read(kRtklib.substr(0, size)).incomplete()) << size;
  }
}

TEST(NtripRequest, GarbageAndEndlessHeadsAreMalformed) {
  EXPECT_TRUE(read(std::string("\x16\x03\x01\x02", 4)).malformed()) << "TLS";
  EXPECT_TRUE(read("\r\n\r\n").malformed());
  EXPECT_TRUE(read("GET\r\n\r\n").malformed());
  EXPECT_TRUE(read("GET / HTTP/1.0\r\nX: " + std::string(5000, 'x')).malformed());
  EXPECT_TRUE(read(std::string(5000, 'x')).malformed());
}

TEST(NtripRequest, Base64IsThatOfTheRfc) {
  EXPECT_EQ(from_base64(""), "");
  EXPECT_EQ(from_base64("Zg=="), "f");
  EXPECT_EQ(from_base64("Zm8="), "fo");
  EXPECT_EQ(from_base64("Zm9vYmFy"), "foobar");
  EXPECT_FALSE(from_base64("Zm9*"));
}

TEST(NtripAnswer, TableHasNineteenFields) {
  Stream stream;
  stream.latitude_deg = 49.424;
  const std::string line = table_line(stream);
  EXPECT_EQ(std::count(line.begin(), line.end(), ';'), 18);
  EXPECT_EQ(line.substr(0, 28), "STR;BASE;Rigwire;RTCM 3.3;;1");
  EXPECT_NE(line.find(";49.42;0.00;0;0;"), std::string::npos);
}

TEST(NtripAnswer, FirstVersionIsNoHttp) {
  EXPECT_EQ(stream_head(false, true, {}), "ICY 200 OK\r\n") << "str2str takes the rest for data";
  EXPECT_TRUE(source_table(false, {}, "").starts_with("SOURCETABLE 200 OK\r\n"));
  EXPECT_TRUE(unauthorized(false, {}, "MP").starts_with("HTTP/1.0 401 Unauthorized\r\n"));
}

TEST(NtripAnswer, SecondVersionIsHttpWithChunks) {
  const std::string head = stream_head(true, true, {});
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\n"));
  EXPECT_NE(head.find("\r\nTransfer-Encoding: chunked\r\n"), std::string::npos);
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
  EXPECT_EQ(stream_head(true, false, {}).find("chunked"), std::string::npos);
  const std::vector<std::uint8_t> bytes(26, 'x');
  EXPECT_EQ(chunk(bytes), "1a\r\n" + std::string(26, 'x') + "\r\n");
}

}  // namespace
}  // namespace rigwire::protocols::ntrip
