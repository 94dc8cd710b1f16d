// What approx/accumulate.hpp is on the recording scalar: a loop, whose states carry derivatives as further states.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include "microfacet/approx/accumulate.hpp"
#include "microfacet/record/loops.hpp"

namespace microfacet {

template <class Real>
struct term<record::number<Real>> {
  using constant = record::number<Real>;
  constant index;

  constant plus(int n) const { return index + constant(n); }
  constant inverse(int n) const { return constant(1) / plus(n); }
  template <class Number, std::size_t N>
  constant of(const std::array<Number, N>& values) const {
    std::array<Real, std::bit_ceil(N)> rows{};
    for (std::size_t i = 0; i < N; ++i) rows[i] = static_cast<Real>(values[i]);
    // The last bits of a number of this size count ones.
    const constant ones(sizeof(Real) == 4 ? 0x1.8p23 : 0x1.8p52);
    return record::lookup<rows.size()>(rows, bits(index + ones));
  }
};

namespace record {

namespace detail {

// The states of a sum: the index, the values, and those derivatives of them that are not zero throughout.
template <class Real>
class sum_states {
  using T = number<Real>;

 public:
  explicit sum_states(const std::vector<T>& initial) : size_(initial.size()) { (void)add(initial); }

  // Whether x has derivatives that were not there before: they are from here on.
  bool add(const std::vector<T>& x) {
    const std::size_t before = varying_.size();
    for (std::size_t i = 0; i < size_; ++i)
      for (std::size_t k = 0; k < x[i].directions(); ++k) {
        const std::pair one(i, k);
        const bool zero = known_as(x[i].derivative(k).id(), 0);
        if (!zero && std::find(varying_.begin(), varying_.end(), one) == varying_.end())
          varying_.push_back(one), directions_ = (std::max)(directions_, k + 1);
      }
    return varying_.size() > before;
  }
  std::vector<T> packed(const T& index, const std::vector<T>& x) const {
    std::vector<T> all{index.value()};
    for (const T& value : x) all.push_back(value.value());
    for (const auto& [i, k] : varying_) all.push_back(x[i].derivative(k));
    return all;
  }
  std::vector<T> unpacked(const std::vector<T>& all) const {
    std::vector<T> x;
    for (std::size_t i = 0; i < size_; ++i)
      x.push_back(all[i + 1].with_derivatives(directions_, [&](std::size_t k) {
        const auto at = std::find(varying_.begin(), varying_.end(), std::pair(i, k));
        return at == varying_.end() ? T(0) : all[1 + size_ + static_cast<std::size_t>(at - varying_.begin())];
      }));
    return x;
  }

 private:
  std::size_t size_, directions_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> varying_;
};

template <class Real, class State, class Body, class Unsettled>
State record_sum(int most, const mask& moving, const State& initial, const Body& body,
                 const Unsettled& unsettled) {
  using T = number<Real>;
  using parts = numbers_of<State>;
  std::vector<T> from;
  parts::collect(initial, from);
  sum_states<Real> states(from);
  while (true) {
    std::vector<T> last;
    const std::vector<T> found =
        record_loop(most, states.packed(T(0), from), moving, [&](const std::vector<T>& all) {
          const std::vector<T> now = states.unpacked(all);
          last.clear();
          parts::collect(body(term<T>{all[0]}, parts::made(now.data())), last);
          const T index = all[0] + T(1);
          return std::pair(states.packed(index, last), unsettled(index));
        });
    if (!states.add(last)) return parts::made(states.unpacked(found).data());
  }
}

}  // namespace detail

template <class Real, class Body>
number<Real> accumulate(int terms, number<Real> initial, const Body& body) {
  return detail::record_sum<Real>(terms, mask(true), initial, body,
                                  [](const number<Real>&) { return mask(true); });
}
template <class Real, std::size_t N, class Body>
std::array<number<Real>, N> accumulate(int terms, std::array<number<Real>, N> initial, const Body& body) {
  return detail::record_sum<Real>(terms, mask(true), initial, body,
                                  [](const number<Real>&) { return mask(true); });
}
template <int together = 1, class Real, class State, class Body>
State accumulate(int most, const number<Real>& count, State initial, const Body& body) {
  const number<Real> terms = count.value();
  return detail::record_sum<Real>(most, number<Real>(0) < terms, initial, body,
                                  [&](const number<Real>& index) { return index < terms; });
}

}  // namespace record

}  // namespace microfacet
