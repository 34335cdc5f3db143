// SPDX-License-Identifier: Apache-2.0
#pragma once

// The classes under test come first: relacy redefines words of the language as macros, which are taken back below.
#include <atomic>
#include <cstdint>

#include "core/broadcast_ring.h"
#include "core/latest_value.h"
#include "core/spsc_ring.h"
// then the checker
#include <relacy/relacy.hpp>

#undef new
#undef delete
#undef malloc
#undef calloc
#undef realloc
#undef free
#undef assert
#undef errno
#undef memory_order_relaxed
#undef memory_order_consume
#undef memory_order_acquire
#undef memory_order_release
#undef memory_order_acq_rel
#undef memory_order_seq_cst

namespace dts::model_check {

/// Takes one memory order away from one thread: what the code would be with a weaker order at that side. The default
/// takes nothing away: the shipped code.
struct Weakening {
  unsigned thread = 0;
  bool loses_release = false;
  bool loses_acquire = false;
};

constexpr rl::memory_order without_release(rl::memory_order order) noexcept {
  return order == rl::mo_release ? rl::mo_relaxed : order == rl::mo_acq_rel ? rl::mo_acquire : order;
}

constexpr rl::memory_order without_acquire(rl::memory_order order) noexcept {
  return order == rl::mo_acquire ? rl::mo_relaxed : order == rl::mo_acq_rel ? rl::mo_release : order;
}

constexpr rl::memory_order to_relacy(std::memory_order order) noexcept {
  switch (order) {
    case std::memory_order_relaxed: return rl::mo_relaxed;
    case std::memory_order_consume: return rl::mo_consume;
    case std::memory_order_acquire: return rl::mo_acquire;
    case std::memory_order_release: return rl::mo_release;
    case std::memory_order_acq_rel: return rl::mo_acq_rel;
    case std::memory_order_seq_cst: return rl::mo_seq_cst;
  }
  return rl::mo_relaxed;
}

/// Replaces std::atomic in the lock-free classes; every access is a step the checker may interleave, and a load
/// may return any value the C++ memory model allows.
template <class T, Weakening weakening>
class CheckedAtomic {
 public:
  CheckedAtomic() : CheckedAtomic(T{}) {}
  CheckedAtomic(T value) : atomic_(value) {}  // NOLINT(google-explicit-constructor): as std::atomic

  T load(std::memory_order order) const { return atomic_.load(effective(order), RL_INFO); }
  void store(T value, std::memory_order order) { atomic_.store(value, effective(order), RL_INFO); }
  T exchange(T value, std::memory_order order) { return atomic_.exchange(value, effective(order), RL_INFO); }

 private:
  static rl::memory_order effective(std::memory_order order) {
    rl::memory_order result = to_relacy(order);
    if (rl::thread_index() != weakening.thread) return result;
    if (weakening.loses_release) result = without_release(result);
    if (weakening.loses_acquire) result = without_acquire(result);
    return result;
  }

  rl::atomic<T> atomic_;
};

/// The template parameter of the classes under test takes one argument.
template <Weakening weakening>
struct With {
  template <class T>
  using Atomic = CheckedAtomic<T, weakening>;
};

/// An element in two parts. Plain memory as the checker sees it: two accesses without an order between them, one of them
/// a write, are reported as a data race. Two parts, so that a torn copy would also show.
class CheckedElement {
 public:
  CheckedElement() : CheckedElement(0) {}
  explicit CheckedElement(std::uint64_t value) : value_(value), copy_(value) {}
  CheckedElement(const CheckedElement&) = default;
  CheckedElement& operator=(const CheckedElement& other) noexcept {
    value_(RL_INFO) = other.value_(RL_INFO).load();
    copy_(RL_INFO) = other.copy_(RL_INFO).load();
    return *this;
  }
  ~CheckedElement() = default;

  [[nodiscard]] std::uint64_t value() const { return value_(RL_INFO).load(); }
  [[nodiscard]] bool is_whole() const { return value() == copy_(RL_INFO).load(); }

 private:
  rl::var<std::uint64_t> value_;
  rl::var<std::uint64_t> copy_;
};

/// Ends the run as failed when `is_true` is not.
inline void require(bool is_true, const char* claim) {
  if (!is_true) rl::ctx().fail_test(claim, rl::test_result_user_assert_failed, RL_INFO);
}

struct Search {
  rl::scheduler_type_e kind = rl::sched_random;
  rl::iteration_t iterations = 100'000;  ///< Of the random search.
  unsigned preemptions = 0;              ///< Of the bounded search, which is complete within the bound.
};

inline constexpr Search kAtRandom{.kind = rl::sched_random, .iterations = 200'000};

struct Verdict {
  rl::test_result_e result = rl::test_result_success;
  std::string report;  ///< What the checker wrote, with the history of the failing run.
};

template <class Suite>
Verdict check(const Search& search) {
  rl::ostringstream output;  // its allocations bypass the checker
  rl::test_params params;
  params.search_type = search.kind;
  params.iteration_count = search.iterations;
  params.context_bound = search.preemptions;
  params.output_stream = &output;
  params.progress_stream = &output;
  rl::simulate<Suite>(params);
  return {params.test_result, std::string(output.str().c_str())};
}

}  // namespace dts::model_check
