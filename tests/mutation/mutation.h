// SPDX-License-Identifier: Apache-2.0
// The first line of a file with mutants (scripts/mutate): the switch between what the file says and what a mutant makes of it.
#pragma once

// A mutant may be worth a warning.
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Wint-in-bool-context"
#pragma GCC diagnostic ignored "-Wbool-compare"
#pragma GCC diagnostic ignored "-Wtautological-compare"
#pragma GCC diagnostic ignored "-Wlogical-not-parentheses"
#pragma GCC diagnostic ignored "-Wdiv-by-zero"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wreturn-type"
#pragma GCC diagnostic ignored "-Wimplicit-fallthrough"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace dts::mutation {

/// The identifiers of the mutants that a process has come by, for other processes to read: open addressing, 0 is free.
inline constexpr std::size_t kPlaces = 1U << 16U;
using Place = std::atomic<std::uint64_t>;

/// Maps the file that DTS_MUTATION_REACH names; null without one.
inline Place* map_places() noexcept {
  const char* const path = std::getenv("DTS_MUTATION_REACH");
  if (path == nullptr) return nullptr;
  const int file = ::open(path, O_RDWR | O_CLOEXEC);
  if (file < 0) return nullptr;
  void* const mapped = ::mmap(nullptr, kPlaces * sizeof(Place), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<Place*>(mapped);
}

inline std::uint64_t read_active() noexcept {
  const char* const text = std::getenv("DTS_MUTANT");
  return text == nullptr ? 0 : std::strtoull(text, nullptr, 16);
}

inline const std::uint64_t active = read_active();
inline Place* const places = map_places();

[[gnu::noinline, gnu::cold]] inline void mark(std::uint64_t id) noexcept {
  for (std::size_t i = id % kPlaces;; i = (i + 1) % kPlaces) {
    std::uint64_t seen = places[i].load(std::memory_order_relaxed);
    if (seen == id) return;
    if (seen == 0 && (places[i].compare_exchange_strong(seen, id) || seen == id)) return;
  }
}

/// Whether mutant `id` is the one that this process runs with.
inline bool live(std::uint64_t id) noexcept {
  if (places != nullptr) [[unlikely]] mark(id);
  return id == active;
}

/// The same; what the compiler evaluates itself stays as it was written.
constexpr bool on(std::uint64_t id) noexcept { return __builtin_is_constant_evaluated() ? false : live(id); }

}  // namespace dts::mutation
