// Whether this program is built under a sanitizer: our code then runs several times slower than the
// libraries it is compared with, and a test of speed proves nothing.
#pragma once

namespace rigwire {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace rigwire
