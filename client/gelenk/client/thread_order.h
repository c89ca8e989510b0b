// Order that ThreadSanitizer cannot see, as gRPC is not instrumented: between
// the start of an operation and its completion. In other builds these do
// nothing.
#ifndef GELENK_CLIENT_THREAD_ORDER_H_
#define GELENK_CLIENT_THREAD_ORDER_H_

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace gelenk::client {

// What this thread did until now happens before whatever comes after
// ThreadOrderAfter of the same key.
inline void ThreadOrderBefore([[maybe_unused]] void* key) {
#if defined(__SANITIZE_THREAD__)
  __tsan_release(key);
#endif
}

inline void ThreadOrderAfter([[maybe_unused]] void* key) {
#if defined(__SANITIZE_THREAD__)
  __tsan_acquire(key);
#endif
}

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_THREAD_ORDER_H_
