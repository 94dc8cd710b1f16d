// Prepared tables of the densities that were used last, shared by all threads: what a ufunc with constant
// shape parameters and a frozen distribution draw on.
//
// An entry does not change once it is shared, and no lock is held while one is built: two threads that want
// the same tables at once both build them, and the last one's are kept. A cache keeps the 64 densities that
// were used last: 53 kB each in double precision and 15 kB in single, so 4.4 MB at most for a family.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

#include "bindings/density/fork_safe_lock.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::bindings {

template <class Real, std::size_t Parameters>
class table_cache {
 public:
  using parameters = std::array<double, Parameters>;
  using tables = radial_tables<Real>;

  // Tables of these parameters with `functions` built, or nothing where they miss the accuracy contract.
  // build(tables, functions) adds functions to them.
  template <class Build>
  std::shared_ptr<const tables> get(const parameters& key, unsigned functions, const Build& build) {
    std::shared_ptr<const entry> e = find(key);
    if (e == nullptr || (functions & ~e->built) != 0) {
      const auto wider = e == nullptr ? std::make_shared<entry>() : std::make_shared<entry>(*e);
      wider->key = key;
      build(wider->tables, functions & ~wider->built);
      wider->built |= functions;
      keep(wider);
      e = wider;
    }
    return e->tables.good(functions) ? std::shared_ptr<const tables>(e, &e->tables) : nullptr;
  }

 private:
  struct entry {
    parameters key;
    unsigned built = 0;
    table_cache::tables tables;
  };
  using pointer = std::shared_ptr<const entry>;

  using entries = std::array<pointer, 64>;
  typename entries::iterator place_of(const parameters& key) {
    return std::find_if(entries_.begin(), entries_.end(),
                        [&](const pointer& e) { return e != nullptr && e->key == key; });
  }
  pointer& to_front(typename entries::iterator place) {
    std::rotate(entries_.begin(), place, place + 1);
    return entries_.front();
  }
  pointer find(const parameters& key) {
    const locked lock(shared_lock);
    const auto place = place_of(key);
    return place == entries_.end() ? nullptr : to_front(place);
  }
  // What leaves the cache is freed after the lock.
  void keep(pointer e) {
    const locked lock(shared_lock);
    const auto place = place_of(e->key);
    to_front(place == entries_.end() ? place - 1 : place).swap(e);
  }

  entries entries_;  // the last used first
};

}  // namespace microfacet::bindings
