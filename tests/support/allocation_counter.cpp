// SPDX-License-Identifier: Apache-2.0
#include "support/allocation_counter.h"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <string_view>

namespace dts::test {
namespace {

thread_local std::uint64_t calls_of_this_thread = 0;
std::atomic<bool> counts_sample_threads{false};
std::atomic<std::uint64_t> calls_of_sample_threads{0};

void count() noexcept {
  ++calls_of_this_thread;
  if (!counts_sample_threads.load(std::memory_order_relaxed)) return;
  std::array<char, 16> buffer{};
  pthread_getname_np(pthread_self(), buffer.data(), buffer.size());
  const std::string_view name(buffer.data());
  if (name.starts_with("acq-")) calls_of_sample_threads.fetch_add(1, std::memory_order_relaxed);
}

void* try_to_allocate(std::size_t size, std::size_t alignment) noexcept {
  count();
  return std::aligned_alloc(alignment, (size / alignment + 1) * alignment);  // aligned_alloc wants a multiple
}

void* allocate(std::size_t size, std::size_t alignment) {
  if (void* memory = try_to_allocate(size, alignment)) return memory;
  throw std::bad_alloc();
}

void release(void* memory) noexcept {
  if (memory != nullptr) count();
  std::free(memory);
}

}  // namespace

std::uint64_t heap_calls_of_this_thread() noexcept { return calls_of_this_thread; }
void count_sample_threads(bool is_on) noexcept { counts_sample_threads.store(is_on, std::memory_order_relaxed); }
std::uint64_t heap_calls_of_sample_threads() noexcept { return calls_of_sample_threads.load(std::memory_order_relaxed); }

}  // namespace dts::test

// The array forms of the standard library call these. The nothrow forms would, but the sanitizers bring their own.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return dts::test::try_to_allocate(size, alignof(std::max_align_t)); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return dts::test::try_to_allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size) { return dts::test::allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) { return dts::test::allocate(size, static_cast<std::size_t>(alignment)); }
void operator delete(void* memory) noexcept { dts::test::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { dts::test::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { dts::test::release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { dts::test::release(memory); }
