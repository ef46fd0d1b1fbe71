#include "protocols/modbus/pdu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

namespace rigwire::protocols::modbus {
namespace {

using ::testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const Pdu& pdu) {
  return {pdu.view().begin(), pdu.view().end()};
}

Refusal refusal_of(const Bytes& pdu) {
  const auto decoded = decode_request(pdu);
  const auto* refusal = std::get_if<Refusal>(&decoded);
  EXPECT_NE(refusal, nullptr) << "the request was taken";
  return refusal != nullptr ? *refusal : Refusal{};
}

ExceptionCode code_of(const Bytes& pdu) {
  return refusal_of(pdu).code;
}

bool taken(const Bytes& pdu) {
  return std::holds_alternative<Request>(decode_request(pdu));
}

Bytes plain(std::uint8_t function, std::uint16_t address, std::uint16_t second) {
  return {function, static_cast<std::uint8_t>(address >> 8U), static_cast<std::uint8_t>(address),
          static_cast<std::uint8_t>(second >> 8U), static_cast<std::uint8_t>(second)};
}

Bytes write_many(std::uint8_t function, std::uint16_t address, std::uint16_t quantity,
                 std::size_t byte_count, std::size_t data) {
  Bytes pdu = plain(function, address, quantity);
  pdu.push_back(static_cast<std::uint8_t>(byte_count));
  pdu.resize(pdu.size() + data, 0x01);
  return pdu;
}

Bytes read_write(std::uint16_t read_address, std::uint16_t read_quantity,
                 std::uint16_t write_address, std::uint16_t write_quantity) {
  Bytes pdu = plain(23, read_address, read_quantity);
  const Bytes write = plain(0, write_address, write_quantity);
  pdu.insert(pdu.end(), write.begin() + 1, write.end());
  pdu.push_back(static_cast<std::uint8_t>(2 * write_quantity));
  pdu.resize(pdu.size() + 2U * write_quantity, 0);
  return pdu;
}

constexpr auto kFunction01 = ExceptionCode::illegal_function;
constexpr auto kAddress02 = ExceptionCode::illegal_data_address;
constexpr auto kValue03 = ExceptionCode::illegal_data_value;

// The worked examples of the specification, section 6, byte for byte.
TEST(ModbusPdu, EncodesTheExamplesOfTheSpecification) {
  EXPECT_THAT(bytes_of(encode_request(ReadBits{BitTable::coils, 0x13, 0x13})),
              ElementsAreArray({0x01, 0x00, 0x13, 0x00, 0x13}));
  EXPECT_THAT(bytes_of(encode_request(ReadRegisters{RegisterTable::holding, 0x6B, 3})),
              ElementsAreArray({0x03, 0x00, 0x6B, 0x00, 0x03}));
  EXPECT_THAT(bytes_of(encode_request(WriteCoil{0xAC, true})),
              ElementsAreArray({0x05, 0x00, 0xAC, 0xFF, 0x00}));
  EXPECT_THAT(bytes_of(encode_request(WriteRegister{1, 3})),
              ElementsAreArray({0x06, 0x00, 0x01, 0x00, 0x03}));
  EXPECT_THAT(bytes_of(encode_request(MaskWriteRegister{4, 0xF2, 0x25})),
              ElementsAreArray({0x16, 0x00, 0x04, 0x00, 0xF2, 0x00, 0x25}));
  const std::uint16_t two[] = {0x000A, 0x0102};
  EXPECT_THAT(bytes_of(encode_request(WriteRegisters{1, make_registers(two)})),
              ElementsAreArray({0x10, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0A, 0x01, 0x02}));
  const std::uint16_t three[] = {0xFF, 0xFF, 0xFF};
  EXPECT_THAT(bytes_of(encode_request(ReadWriteRegisters{3, 6, 0x0E, make_registers(three)})),
              ElementsAreArray({0x17, 0x00, 0x03, 0x00, 0x06, 0x00, 0x0E, 0x00, 0x03, 0x06, 0x00,
                                0xFF, 0x00, 0xFF, 0x00, 0xFF}));
  WriteCoils coils{0x13, {}};
  coils.coils.count = 10;
  for (const std::size_t on : {0, 2, 3, 6, 7, 8}) {
    coils.coils.set(on, true);
  }
  EXPECT_THAT(bytes_of(encode_request(coils)),
              ElementsAreArray({0x0F, 0x00, 0x13, 0x00, 0x0A, 0x02, 0xCD, 0x01}));
  EXPECT_THAT(bytes_of(encode_request(ReadDeviceIdentification{})),
              ElementsAreArray({0x2B, 0x0E, 0x01, 0x00}));
}

TEST(ModbusPdu, MaskWriteFollowsTheFormulaOfTheSpecification) {
  EXPECT_EQ((MaskWriteRegister{4, 0xF2, 0x25}.apply(0x12)), 0x17);
}

TEST(ModbusPdu, QuantityAtTheLimitIsTakenAndBeyondItRefused) {
  for (const std::uint8_t function : Bytes{1, 2}) {
    EXPECT_TRUE(taken(plain(function, 0, 2000)));
    EXPECT_EQ(code_of(plain(function, 0, 2001)), kValue03);
    EXPECT_EQ(code_of(plain(function, 0, 0)), kValue03);
  }
  for (const std::uint8_t function : Bytes{3, 4}) {
    EXPECT_TRUE(taken(plain(function, 0, 125)));
    EXPECT_EQ(code_of(plain(function, 0, 126)), kValue03);
    EXPECT_EQ(code_of(plain(function, 0, 0)), kValue03);
  }
  EXPECT_TRUE(taken(write_many(15, 0, 1968, 246, 246)));
  EXPECT_EQ(code_of(write_many(15, 0, 1969, 247, 247)), kValue03);
  EXPECT_EQ(code_of(write_many(15, 0, 0, 0, 0)), kValue03);
  EXPECT_TRUE(taken(write_many(16, 0, 123, 246, 246)));
  EXPECT_EQ(code_of(write_many(16, 0, 124, 248, 247)), kValue03);
  EXPECT_EQ(code_of(write_many(16, 0, 0, 0, 0)), kValue03);
  EXPECT_TRUE(taken(read_write(0, 125, 0, 121)));
  EXPECT_EQ(code_of(read_write(0, 126, 0, 1)), kValue03);
  EXPECT_EQ(code_of(read_write(0, 0, 0, 1)), kValue03);
  EXPECT_EQ(code_of(read_write(0, 1, 0, 122)), kValue03);
  EXPECT_EQ(code_of(read_write(0, 1, 0, 0)), kValue03);
}

TEST(ModbusPdu, RangesEndAt65535) {
  for (const std::uint8_t function : Bytes{1, 2, 3, 4}) {
    EXPECT_TRUE(taken(plain(function, 65535, 1)));
    EXPECT_EQ(code_of(plain(function, 65535, 2)), kAddress02);
  }
  EXPECT_TRUE(taken(write_many(16, 65534, 2, 4, 4)));
  EXPECT_EQ(code_of(write_many(16, 65534, 3, 6, 6)), kAddress02);
  EXPECT_TRUE(taken(write_many(15, 65526, 10, 2, 2)));
  EXPECT_EQ(code_of(write_many(15, 65527, 10, 2, 2)), kAddress02);
  EXPECT_EQ(code_of(read_write(65535, 2, 0, 1)), kAddress02);
  EXPECT_EQ(code_of(read_write(0, 1, 65535, 2)), kAddress02);
}

TEST(ModbusPdu, QuantityIsCheckedBeforeAddress) {
  EXPECT_EQ(code_of(plain(3, 65535, 126)), kValue03);
  EXPECT_EQ(code_of(write_many(16, 65535, 2, 3, 4)), kValue03);
  EXPECT_EQ(code_of(read_write(65535, 2, 65535, 122)), kValue03);
}

TEST(ModbusPdu, ByteCountMustMatchTheQuantity) {
  EXPECT_EQ(code_of(write_many(16, 0, 2, 5, 5)), kValue03);
  EXPECT_EQ(code_of(write_many(15, 0, 8, 2, 2)), kValue03);
  Bytes pdu = read_write(0, 1, 0, 2);
  pdu[9] = 3;
  EXPECT_EQ(code_of(pdu), kValue03);
}

TEST(ModbusPdu, CoilValueIsOnOrOffAndNothingElse) {
  EXPECT_TRUE(taken(plain(5, 7, 0xFF00)));
  EXPECT_TRUE(taken(plain(5, 7, 0x0000)));
  EXPECT_EQ(code_of(plain(5, 7, 0x0001)), kValue03);
  EXPECT_EQ(code_of(plain(5, 7, 0xFFFF)), kValue03);
}

TEST(ModbusPdu, UnknownFunctionsAreRefusedWithoutTheFlag) {
  for (const std::uint8_t function : Bytes{0, 7, 8, 11, 20, 24, 44, 100, 127}) {
    EXPECT_EQ(refusal_of({function, 0, 0}), (Refusal{function, kFunction01, false}));
  }
  EXPECT_EQ(refusal_of({0x83, 0, 0}), (Refusal{3, kFunction01, false}));
  EXPECT_EQ(code_of({43, 13, 1, 0}), kFunction01);  // CANopen encapsulation
}

TEST(ModbusPdu, IdentificationAccessIsOneToFour) {
  for (const std::uint8_t access : Bytes{1, 2, 3, 4}) {
    EXPECT_TRUE(taken({43, 14, access, 0}));
  }
  EXPECT_EQ(code_of({43, 14, 0, 0}), kValue03);
  EXPECT_EQ(code_of({43, 14, 5, 0}), kValue03);
}

TEST(ModbusPdu, RequestsOfAWrongLengthAreToldApart) {
  const Bytes whole[] = {plain(1, 0, 1),
                         plain(3, 0, 1),
                         plain(5, 0, 0xFF00),
                         plain(6, 0, 1),
                         write_many(15, 0, 8, 1, 1),
                         write_many(16, 0, 1, 2, 2),
                         Bytes{17},
                         Bytes{22, 0, 0, 0, 0, 0, 0},
                         read_write(0, 1, 0, 1),
                         Bytes{43, 14, 1, 0}};
  for (const Bytes& pdu : whole) {
    EXPECT_TRUE(taken(pdu));
    Bytes longer = pdu;
    longer.push_back(0);
    EXPECT_EQ(refusal_of(longer), (Refusal{pdu[0], kValue03, true}));
    for (std::size_t size = 1; size < pdu.size(); ++size) {
      EXPECT_EQ(refusal_of({pdu.begin(), pdu.begin() + static_cast<std::ptrdiff_t>(size)}),
                (Refusal{pdu[0], kValue03, true}))
          << "function " << int{pdu[0]} << " cut to " << size;
    }
  }
}

TEST(ModbusPdu, DecodedRequestsEncodeToTheSameBytes) {
  const Bytes whole[] = {plain(1, 3, 9),
                         plain(2, 3, 9),
                         plain(3, 3, 9),
                         plain(4, 3, 9),
                         plain(5, 3, 0xFF00),
                         plain(6, 3, 0x8001),
                         write_many(15, 2, 8, 1, 1),
                         write_many(16, 2, 5, 10, 10),
                         Bytes{17},
                         Bytes{22, 1, 2, 3, 4, 5, 6},
                         read_write(7, 8, 9, 10),
                         Bytes{43, 14, 4, 2}};
  for (const Bytes& pdu : whole) {
    const auto decoded = decode_request(pdu);
    ASSERT_TRUE(std::holds_alternative<Request>(decoded));
    EXPECT_EQ(bytes_of(encode_request(std::get<Request>(decoded))), pdu);
  }
}

std::vector<Response> sample_responses() {
  BitBlock bits;
  bits.count = 16;
  bits.set(0, true);
  bits.set(15, true);
  const std::uint16_t words[] = {1, 0x8000, 65535};
  ServerIdResponse id;
  id.data[0] = 'x';
  id.data[1] = 0xFF;
  id.size = 2;
  DeviceIdentificationResponse identification;
  EXPECT_TRUE(identification.append(0, "vendor"));
  EXPECT_TRUE(identification.append(1, ""));
  return {ReadBitsResponse{BitTable::discrete_inputs, bits},
          RegistersResponse{Function::read_write_registers, make_registers(words)},
          WriteCoil{5, true},
          WriteRegister{5, 6},
          WriteManyResponse{Function::write_coils, 1, 1968},
          id,
          MaskWriteRegister{1, 2, 3},
          identification,
          ExceptionResponse{3, kAddress02}};
}

TEST(ModbusPdu, ResponsesSurviveTheRoundTripAndEveryCutIsIncomplete) {
  for (const Response& response : sample_responses()) {
    const Bytes pdu = bytes_of(encode_response(response));
    const auto decoded = decode_response(pdu);
    ASSERT_TRUE(decoded.ok()) << "function " << int{pdu[0]};
    EXPECT_EQ(decoded.consumed(), pdu.size());
    EXPECT_EQ(bytes_of(encode_response(*decoded)), pdu);
    for (std::size_t size = 0; size < pdu.size(); ++size) {
      const auto cut = decode_response(std::span(pdu).first(size));
      ASSERT_TRUE(cut.incomplete()) << "function " << int{pdu[0]} << " cut to " << size;
      EXPECT_GT(cut.shortage().needed, size);
      EXPECT_EQ(cut.shortage().had, size);
    }
  }
}

TEST(ModbusPdu, ResponsesThatNoServerMaySendAreMalformed) {
  for (const Bytes& pdu : {Bytes{3, 3, 0, 0, 0}, Bytes{3, 0}, Bytes{1, 251}, Bytes{99, 0},
                           Bytes{5, 0, 0, 1, 0}, Bytes{16, 0, 0, 0, 124}, Bytes{17, 252},
                           Bytes{43, 13, 1, 0x81, 0, 0, 0}, Bytes{43, 14, 1, 0x81, 7, 0, 0}}) {
    EXPECT_TRUE(decode_response(pdu).malformed()) << "function " << int{pdu[0]};
  }
}

TEST(ModbusPdu, IdentificationObjectsAreFoundByNumberAndStopAtTheEndOfThePdu) {
  DeviceIdentificationResponse response;
  EXPECT_TRUE(response.append(0, std::string(200, 'a')));
  EXPECT_FALSE(response.append(1, std::string(43, 'b')));  // 246 - 202 - 2 = 42 are left
  EXPECT_TRUE(response.append(1, std::string(42, 'b')));
  EXPECT_EQ(response.find(1), std::string(42, 'b'));
  EXPECT_EQ(response.find(2), std::nullopt);
  EXPECT_EQ(encode_response(response).size, kPduMaximum);
}

}  // namespace
}  // namespace rigwire::protocols::modbus
