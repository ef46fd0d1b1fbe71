// The memory that a client reads and writes: bootstrap registers, the camera's own, and the
// description. It knows which addresses there are, who may do what with them, and which values a
// feature's register can hold; what a value does is the owner's.
//
// Of the discovery block (0 .. 0xF7) what is no register reads as zero; everywhere else a read or
// write that leaves what is there is refused as a whole.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/gige_vision/genicam.h"
#include "protocols/gige_vision/status.h"

namespace rigwire::emulators {

/// One register of the map.
struct BankRegister {
  protocols::gige_vision::RegisterRow row;
  const protocols::gige_vision::Feature* feature = nullptr;  ///< Null: only a bootstrap register.
  std::uint32_t selected = 0;                                ///< Value of its selector.
  std::size_t offset = 0;                                    ///< In the bank's memory.
};

class RegisterOwner {
 public:
  virtual ~RegisterOwner() = default;
  /// The register is about to be read: whatever depends on the present is brought up to date.
  virtual void refresh(const BankRegister& target) = 0;
  /// The register holds what a client has written, of a value that its feature allows. An error
  /// puts the former value back.
  [[nodiscard]] virtual protocols::gige_vision::Status written(const BankRegister& target) = 0;
};

class RegisterBank {
 public:
  using Status = protocols::gige_vision::Status;

  /// `description` lies at `description_address`.
  RegisterBank(std::vector<protocols::gige_vision::Feature> features, std::string description,
               std::uint32_t description_address);
  RegisterBank(const RegisterBank&) = delete;
  RegisterBank& operator=(const RegisterBank&) = delete;

  // --- The device's own side. Precondition of all: there is a register of that size at the
  // address.

  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] double real(std::uint32_t address) const;
  void set_real(std::uint32_t address, double value);
  /// Up to the first zero.
  [[nodiscard]] std::string_view text(std::uint32_t address) const;
  /// Writes the text, truncated to leave room for a final zero.
  void set_text(std::uint32_t address, std::string_view text);

  // --- The client's side. Precondition: addresses and sizes are multiples of 4.

  Status read(std::uint32_t address, std::span<std::uint8_t> out, RegisterOwner& owner);
  struct Written {
    Status status = Status::success;
    std::size_t bytes = 0;  ///< Bytes that took effect before an error.
  };
  Written write(std::uint32_t address, std::span<const std::uint8_t> bytes, RegisterOwner& owner);

 private:
  /// Null when no register covers the address.
  [[nodiscard]] const BankRegister* covering(std::uint32_t address) const;
  [[nodiscard]] const BankRegister& at(std::uint32_t address) const;
  [[nodiscard]] std::span<std::uint8_t> memory(const BankRegister& target);
  [[nodiscard]] std::span<const std::uint8_t> memory(const BankRegister& target) const;
  [[nodiscard]] Status check_value(const BankRegister& target, RegisterOwner& owner);
  [[nodiscard]] const BankRegister* limit(std::string_view feature) const;
  void add(const BankRegister& target);

  std::vector<protocols::gige_vision::Feature> features_;
  std::string description_;
  std::uint32_t description_address_;
  std::vector<BankRegister> registers_;  ///< In order of their addresses.
  std::vector<std::uint8_t> memory_;
};

}  // namespace rigwire::emulators
