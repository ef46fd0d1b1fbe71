// "Did you mean": the nearest of some known words.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`
/// (optimal string alignment distance), case ignored. O(|a| |b|) time.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Bytes of the longest word for which a known one is suggested: as long as a file's name can be.
inline constexpr std::size_t kMaxSuggestedFor = 255;

/// The known word nearest to `word`; empty when none is near enough to be a likely slip: within
/// about a third of the longer word's length (at least 1), or one being the beginning of the other.
/// Empty, too, for a word that is longer than kMaxSuggestedFor.
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// "a, b, c" for messages.
[[nodiscard]] std::string join_words(std::span<const std::string> words);

}  // namespace rigwire::hil
