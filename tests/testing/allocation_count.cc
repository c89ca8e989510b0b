#include "tests/testing/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<int> allocation_count = 0;

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the linker's names.
extern "C" {
void* __real_malloc(size_t size);
void* __real_calloc(size_t count, size_t size);
void* __real_realloc(void* memory, size_t size);
void* __real_aligned_alloc(size_t alignment, size_t size);

void* __wrap_malloc(size_t size) {
  ++allocation_count;
  return __real_malloc(size);
}
void* __wrap_calloc(size_t count, size_t size) {
  ++allocation_count;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* memory, size_t size) {
  ++allocation_count;
  return __real_realloc(memory, size);
}
void* __wrap_aligned_alloc(size_t alignment, size_t size) {
  ++allocation_count;
  return __real_aligned_alloc(alignment, size);
}
}
// NOLINTEND(readability-identifier-naming)

// Out of line, or the compiler pairs new with free and warns.
[[gnu::noinline]] void* operator new(size_t size) {
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(size_t size, std::align_val_t alignment) {
  const size_t step = static_cast<size_t>(alignment);
  const size_t whole_steps = (size + step - 1) / step * step;
  if (void* memory = std::aligned_alloc(step, whole_steps)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(size_t size,
                                     const std::nothrow_t&) noexcept {
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory,
                                       std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t,
                                       std::align_val_t) noexcept {
  std::free(memory);
}

namespace gelenk::testing {

int AllocationCount() { return allocation_count; }

}  // namespace gelenk::testing
