// Things that Python makes and names by a number, a handle, which stands where a ufunc has its parameters.
#pragma once

#include <memory>
#include <unordered_map>
#include <utility>

#include "bindings/density/fork_safe_lock.hpp"
#include "bindings/loop/numpy.hpp"

namespace microfacet::bindings {

template <class Entry>
class named_entries {
 public:
  double add(std::shared_ptr<const Entry> entry) {
    const locked lock(shared_lock);
    entries_.emplace(++last_, std::move(entry));
    return static_cast<double>(last_);
  }
  void remove(double handle) {
    const locked lock(shared_lock);
    entries_.erase(static_cast<long long>(handle));
  }
  std::shared_ptr<const Entry> find(double handle) {
    const locked lock(shared_lock);
    const auto found =
        handle > 0 && handle < 0x1p53 ? entries_.find(static_cast<long long>(handle)) : entries_.end();
    return found == entries_.end() ? nullptr : found->second;
  }

 private:
  std::unordered_map<long long, std::shared_ptr<const Entry>> entries_;
  long long last_ = 0;
};
// No variable of a function: its first call would hold a lock of the compiler's, which a fork copies.
template <class Entry>
inline named_entries<Entry> entries_of;

// A capsule with which the entry lives, and its handle; null, with Python's error set, where there is no memory.
template <class Entry>
PyObject* capsule_of(std::shared_ptr<const Entry> entry, double& handle) {
  auto named = std::make_unique<double>(entries_of<Entry>.add(std::move(entry)));
  PyObject* capsule = PyCapsule_New(named.get(), Entry::name, [](PyObject* c) {
    auto* own = static_cast<double*>(PyCapsule_GetPointer(c, Entry::name));
    entries_of<Entry>.remove(*own);
    delete own;
  });
  handle = *named;
  if (capsule == nullptr) {
    entries_of<Entry>.remove(handle);
  } else {
    named.release();
  }
  return capsule;
}

}  // namespace microfacet::bindings
