// SPDX-License-Identifier: Apache-2.0
// Replaces the allocation functions of the whole program: include it in exactly one source file of a program.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace dts::pipeline {

/// Allocations and releases of this program so far, all threads. Thread: any.
inline std::atomic<std::uint64_t> heap_calls{0};

inline void* counted_allocation(std::size_t size, std::size_t alignment) {
  heap_calls.fetch_add(1, std::memory_order_relaxed);
  const std::size_t rounded = (size / alignment + 1) * alignment;  // aligned_alloc wants a multiple
  void* const memory = std::aligned_alloc(alignment, rounded);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

inline void counted_release(void* memory) noexcept {
  if (memory != nullptr) heap_calls.fetch_add(1, std::memory_order_relaxed);
  std::free(memory);
}

}  // namespace dts::pipeline

// The array and nothrow forms of the standard library call these.
void* operator new(std::size_t size) { return dts::pipeline::counted_allocation(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return dts::pipeline::counted_allocation(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { dts::pipeline::counted_release(memory); }
void operator delete(void* memory, std::size_t) noexcept { dts::pipeline::counted_release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { dts::pipeline::counted_release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { dts::pipeline::counted_release(memory); }
