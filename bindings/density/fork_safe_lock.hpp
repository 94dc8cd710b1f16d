// The one lock of the bindings. A fork copies a lock as it is: held by a thread that the child does not have,
// it would never be released there. So fork waits for this one, which guards nothing longer than an exchange
// of pointers, and both processes release it afterwards.
#pragma once

#include <mutex>

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#define MICROFACET_FORKS 1
#endif

namespace microfacet::bindings {

class fork_safe_lock {
 public:
#if defined(MICROFACET_FORKS)
  fork_safe_lock() { pthread_atfork(&lock, &unlock, &unlock); }
#endif
  static void lock() { mutex_.lock(); }
  static void unlock() { mutex_.unlock(); }

 private:
  static constinit inline std::mutex mutex_;
};

// Registered when the module is loaded, and no variable of a function: the first call of one would hold a
// lock of the compiler's.
inline fork_safe_lock shared_lock;
using locked = std::lock_guard<fork_safe_lock>;

}  // namespace microfacet::bindings
