// Prepared tables of the densities that were used last, shared by all threads: what a ufunc with constant
// shape parameters and a frozen distribution draw on.
#pragma once

#include <array>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

#include "microfacet/family/prepared.hpp"

namespace microfacet::bindings {

template <class Real, std::size_t Parameters>
class prepared_cache {
 public:
  using parameters = std::array<double, Parameters>;
  using tables = radial_tables<Real>;

  // Tables of these parameters with `functions` built, or nothing where they miss the accuracy contract.
  // build(tables, functions) adds functions to them.
  template <class Build>
  std::shared_ptr<const tables> get(const parameters& key, unsigned functions, const Build& build) {
    const std::shared_ptr<entry> e = find(key);
    const std::lock_guard<std::mutex> one_builds(e->mutex);
    if (const unsigned missing = functions & ~e->built; missing != 0) {
      build(e->tables, missing);
      e->built |= missing;
    }
    return e->tables.good(functions) ? std::shared_ptr<const tables>(e, &e->tables) : nullptr;
  }

 private:
  struct entry {
    std::mutex mutex;
    unsigned built = 0;
    prepared_cache::tables tables;
  };

  std::shared_ptr<entry> find(const parameters& key) {
    constexpr std::size_t most = 64;
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto i = entries_.begin(); i != entries_.end(); ++i) {
      if (i->first == key) {
        entries_.splice(entries_.begin(), entries_, i);
        return i->second;
      }
    }
    if (entries_.size() == most) entries_.pop_back();
    entries_.emplace_front(key, std::make_shared<entry>());
    return entries_.front().second;
  }

  std::mutex mutex_;
  std::list<std::pair<parameters, std::shared_ptr<entry>>> entries_;
};

}  // namespace microfacet::bindings
