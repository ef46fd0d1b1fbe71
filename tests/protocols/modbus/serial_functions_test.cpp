#include "protocols/modbus/pdu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <set>
#include <vector>

namespace rigwire::protocols::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes diagnostics(std::uint16_t sub_function, std::uint16_t data) {
  return {8, static_cast<std::uint8_t>(sub_function >> 8U), static_cast<std::uint8_t>(sub_function),
          static_cast<std::uint8_t>(data >> 8U), static_cast<std::uint8_t>(data)};
}

Refusal serial_functions_refusal_of(const Bytes& pdu) {
  const auto decoded = decode_serial_request(pdu);
  const auto* refusal = decoded ? std::get_if<Refusal>(&*decoded) : nullptr;
  EXPECT_NE(refusal, nullptr) << "the request was taken";
  return refusal != nullptr ? *refusal : Refusal{};
}

bool serial_functions_taken(const Bytes& pdu) {
  const auto decoded = decode_serial_request(pdu);
  return decoded && std::holds_alternative<SerialRequest>(*decoded);
}

TEST(SerialFunctions, LeavesTheOthersAlone) {
  for (unsigned function = 0; function < 256; ++function) {
    const bool ours = function == 7 || function == 8 || function == 11;
    EXPECT_EQ(decode_serial_request(Bytes{static_cast<std::uint8_t>(function)}).has_value(), ours);
  }
}

TEST(SerialFunctions, StatusAndEventCounterHaveNoData) {
  for (const std::uint8_t function : {std::uint8_t{7}, std::uint8_t{11}}) {
    EXPECT_TRUE(serial_functions_taken({function}));
    EXPECT_EQ(serial_functions_refusal_of({function, 0}),
              (Refusal{function, ExceptionCode::illegal_data_value, true}));
  }
}

TEST(SerialFunctions, SubFunctionsThatExistAndNoOthers) {
  const std::set<std::uint16_t> exist{0, 1, 2, 4, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20};
  for (unsigned sub_function = 0; sub_function < 65536; ++sub_function) {
    const auto code = static_cast<std::uint16_t>(sub_function);
    const Bytes pdu = diagnostics(code, 0);
    if (exist.contains(code)) {
      EXPECT_TRUE(serial_functions_taken(pdu)) << code;
    } else {
      EXPECT_EQ(serial_functions_refusal_of(pdu).code, ExceptionCode::illegal_function) << code;
    }
  }
}

TEST(SerialFunctions, TheSubFunctionIsJudgedBeforeItsData) {
  EXPECT_EQ(serial_functions_refusal_of(diagnostics(3, 7)).code, ExceptionCode::illegal_function);
  EXPECT_EQ(serial_functions_refusal_of(diagnostics(2, 7)).code, ExceptionCode::illegal_data_value);
  EXPECT_EQ(serial_functions_refusal_of(diagnostics(4, 0xFF00)).code,
            ExceptionCode::illegal_data_value);
  EXPECT_TRUE(serial_functions_taken(diagnostics(1, 0xFF00)));
  EXPECT_EQ(serial_functions_refusal_of(diagnostics(1, 0xFF01)).code,
            ExceptionCode::illegal_data_value);
}

TEST(SerialFunctions, QueryDataIsAnyEvenNumberOfBytes) {
  EXPECT_TRUE(serial_functions_refusal_of({8, 0, 0}).wrong_length);
  EXPECT_TRUE(serial_functions_refusal_of({8, 0, 0, 1}).wrong_length);
  EXPECT_TRUE(serial_functions_refusal_of({8, 0}).wrong_length);
  const Bytes pdu{8, 0, 0, 0xA5, 0x37, 1, 2};
  const auto decoded = decode_serial_request(pdu);
  const auto& query = std::get<Diagnostics>(std::get<SerialRequest>(*decoded));
  EXPECT_THAT(query.query, ::testing::ElementsAre(0xA5, 0x37, 1, 2));
}

TEST(SerialFunctions, AnswersAsInTheExamplesOfTheSpecification) {
  EXPECT_THAT(encode_exception_status(0x6D).view(), ::testing::ElementsAre(0x07, 0x6D));
  EXPECT_THAT(encode_diagnostics(SubFunction::bus_message_count, 0x0102).view(),
              ::testing::ElementsAre(8, 0, 11, 1, 2));
  EXPECT_THAT(encode_comm_event_counter(true, 0x0108).view(),
              ::testing::ElementsAre(0x0B, 0xFF, 0xFF, 0x01, 0x08));
}

}  // namespace
}  // namespace rigwire::protocols::modbus
