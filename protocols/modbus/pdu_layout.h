// Where the fields of a PDU are: the one table that the encoders and decoders of both directions
// share. Offsets count from the function code. Source: V1.1b3, section 6.
#pragma once

#include <cstddef>

namespace rigwire::protocols::modbus::layout {

inline constexpr std::size_t kFunction = 0;

// Requests 1-6, 15, 16, 22 and the echoes of 5, 6, 15, 16, 22.
inline constexpr std::size_t kAddress = kFunction + 1;
inline constexpr std::size_t kQuantity = kAddress + 2;  // 5, 6: value; 22: AND mask
inline constexpr std::size_t kValue = kQuantity;
inline constexpr std::size_t kAndMask = kQuantity;
inline constexpr std::size_t kPlainSize = kQuantity + 2;  // 1-6, echoes of 15 and 16
inline constexpr std::size_t kOrMask = kAndMask + 2;
inline constexpr std::size_t kMaskWriteSize = kOrMask + 2;
inline constexpr std::size_t kWriteByteCount = kQuantity + 2;  // requests 15, 16
inline constexpr std::size_t kWriteData = kWriteByteCount + 1;
static_assert(kPlainSize == 5 && kMaskWriteSize == 7 && kWriteData == 6);

// Request 23.
inline constexpr std::size_t kReadAddress = kFunction + 1;
inline constexpr std::size_t kReadQuantity = kReadAddress + 2;
inline constexpr std::size_t kWriteAddress = kReadQuantity + 2;
inline constexpr std::size_t kWriteQuantity = kWriteAddress + 2;
inline constexpr std::size_t kReadWriteByteCount = kWriteQuantity + 2;
inline constexpr std::size_t kReadWriteData = kReadWriteByteCount + 1;
static_assert(kReadWriteData == 10);

// Responses 1-4, 17, 23.
inline constexpr std::size_t kByteCount = kFunction + 1;
inline constexpr std::size_t kData = kByteCount + 1;

// 43/14.
inline constexpr std::size_t kInterface = kFunction + 1;
inline constexpr std::size_t kAccess = kInterface + 1;
inline constexpr std::size_t kObject = kAccess + 1;
inline constexpr std::size_t kIdentificationRequestSize = kObject + 1;
inline constexpr std::size_t kConformity = kAccess + 1;
inline constexpr std::size_t kMoreFollows = kConformity + 1;
inline constexpr std::size_t kNextObject = kMoreFollows + 1;
inline constexpr std::size_t kObjectCount = kNextObject + 1;
inline constexpr std::size_t kObjects = kObjectCount + 1;
static_assert(kIdentificationRequestSize == 4 && kObjects == 7);

// Exceptions.
inline constexpr std::size_t kExceptionCode = kFunction + 1;
inline constexpr std::size_t kExceptionSize = kExceptionCode + 1;

}  // namespace rigwire::protocols::modbus::layout
