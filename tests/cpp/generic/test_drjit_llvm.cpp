// The headers on Dr.Jit's traced arrays, and their derivatives by its automatic differentiation. A program
// that only compiles where Dr.Jit finds no LLVM: it then says so and returns 77.

#include <drjit/autodiff.h>
#include <drjit/jit.h>

#include <string_view>
#include <tuple>

#include "../../../src/microfacet/mitsuba/plugin/drjit_scalar.hpp"
#include "families_on.hpp"
#include "microfacet/family/all.hpp"

namespace {

bool llvm_runs() {
  jit_set_log_level_stderr(LogLevel::Error);
  jit_init(1u << static_cast<unsigned>(JitBackend::LLVM));
  return jit_has_backend(JitBackend::LLVM) != 0;
}

// Thousands of steps, each of them traced, are what a prepared density is for.
bool few_steps(std::string_view name) {
  bool few = false;
  const auto look = [&]<class Tag>(Tag) {
    using family = typename Tag::template type<double>;
    if (family::name == name)
      few = !family::tables_alone && (family::tabulate & microfacet::of_survival) == 0;
  };
  std::apply([&](auto... tags) { (look(tags), ...); }, microfacet::all_families{});
  return few;
}

template <class Array>
struct traced {
  using T = drjit::scalar_t<Array>;
  template <class Function>
  static std::vector<T> map(const Function& function, const std::vector<T>& x) {
    std::vector<T> y(x.size());
    drjit::store(y.data(), Array(function(drjit::load<Array>(x.data(), x.size()))));
    return y;
  }
};

template <class T>
void run() {
  using array = drjit::LLVMArray<T>;
  generic::families_on<array, traced<array>>("LLVM", few_steps);
}

// d mean_excess/dx = -slope_sf
template <class T>
void differentiate() {
  using array = drjit::LLVMArray<T>;
  using differentiable = drjit::DiffArray<JitBackend::LLVM, T>;
  families::each([&]<class Tag>(const families::arguments& a) {
    if (!few_steps(Tag::template type<T>::name)) return;
    const check::note family(Tag::template type<T>::name);
    const auto f = families::make<differentiable, Tag>(a);
    const auto got = traced<array>::map(
        [&](const array& x) {
          differentiable y = x;
          drjit::enable_grad(y);
          differentiable z = f.mean_excess(y);
          drjit::backward(z);
          return drjit::detach<false>(drjit::grad(y));
        },
        generic::arguments<T>);
    const auto g = families::make<double, Tag>(a);
    for (std::size_t i = 0; i < got.size(); ++i)
      CHECK_NEAR(got[i], -g.slope_sf(double(generic::arguments<T>[i])),
                 1e4 * std::numeric_limits<T>::epsilon());
  });
}

}  // namespace

TEST(families_on_traced_arrays) {
  if (!llvm_runs()) {
    std::puts("skipped: Dr.Jit finds no LLVM here");
    std::exit(77);
  }
  run<float>(), run<double>();
}
TEST(derivatives_of_traced_arrays) { differentiate<double>(); }
