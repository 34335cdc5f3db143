// SPDX-License-Identifier: Apache-2.0
#include "core/suggest.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/join.h"

namespace dts::core {
namespace {

constexpr std::size_t kMaxLength = 64;  // names are short; the search is quadratic, so long garbage is skipped

char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same(char a, char b) noexcept { return lower(a) == lower(b); }

/// Returns the optimal string alignment distance. Works row by row and keeps only the last two rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_previous(b.size() + 1);
  std::vector<std::size_t> previous(b.size() + 1);
  std::vector<std::size_t> current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = previous[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      current[j] = std::min({replaced, previous[j] + 1, current[j - 1] + 1});
      const bool is_swap = i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]);
      if (is_swap) current[j] = std::min(current[j], before_previous[j - 2] + 1);
    }
    before_previous.swap(previous);
    previous.swap(current);
  }
  return previous[b.size()];
}

}  // namespace

std::string suggest(std::string_view word, std::span<const std::string_view> known) {
  if (word.empty() || word.size() > kMaxLength) return {};
  std::size_t smallest = std::max<std::size_t>(1, word.size() / 3) + 1;
  std::string_view best;
  for (const std::string_view candidate : known) {
    if (candidate.size() > kMaxLength) continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= smallest) continue;
    smallest = distance;
    best = candidate;
  }
  return std::string(best);
}

std::string known_words_hint(std::string_view word, std::span<const std::string_view> known) {
  if (known.empty()) return "there are none";
  const std::string similar = suggest(word, known);
  return similar.empty() ? "known: " + join(known) : "did you mean '" + similar + "'?";
}

std::string known_words_hint(std::string_view word, const std::vector<std::string>& known) {
  return known_words_hint(word, std::vector<std::string_view>(known.begin(), known.end()));
}

}  // namespace dts::core
