// How decoders answer. Steady state never throws: a decoder returns a Decoded<T>, which either
// holds the value and the number of bytes it took, or says whether more bytes could help
// (incomplete) or not (malformed), and why.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

namespace rigwire::protocols {

/// More bytes are needed before anything can be said.
struct Incomplete {
  std::size_t needed = 0;  ///< Total bytes of the item, at least.
  std::size_t had = 0;     ///< Bytes that were offered.
};

/// No further byte can make this valid.
struct Malformed {
  std::string_view reason;  ///< Static text: what was expected and is missing.
  std::size_t offset = 0;   ///< Offset of the first invalid byte.
};

template <class T>
class [[nodiscard]] Decoded {
 public:
  /// The value, and how many of the offered bytes belong to it.
  Decoded(T value, std::size_t consumed)  // NOLINT(google-explicit-constructor)
      : content_(std::move(value)), consumed_(consumed) {}
  Decoded(Incomplete incomplete) : content_(incomplete) {}  // NOLINT(google-explicit-constructor)
  Decoded(Malformed malformed) : content_(malformed) {}     // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  [[nodiscard]] bool incomplete() const { return std::holds_alternative<Incomplete>(content_); }
  [[nodiscard]] bool malformed() const { return std::holds_alternative<Malformed>(content_); }

  /// Precondition: ok().
  [[nodiscard]] const T& value() const {
    assert(ok());
    return std::get<T>(content_);
  }
  [[nodiscard]] const T& operator*() const { return value(); }
  [[nodiscard]] const T* operator->() const { return &value(); }

  /// Bytes used; 0 unless ok().
  [[nodiscard]] std::size_t consumed() const { return consumed_; }

  /// Precondition: incomplete().
  [[nodiscard]] const Incomplete& shortage() const { return std::get<Incomplete>(content_); }
  /// Precondition: malformed().
  [[nodiscard]] const Malformed& fault() const { return std::get<Malformed>(content_); }

 private:
  std::variant<T, Incomplete, Malformed> content_;
  std::size_t consumed_ = 0;
};

}  // namespace rigwire::protocols
