// The loops behind every ufunc of a distribution: whether parameters are constant, in which arithmetic, from the
// family's own forms or from tables.
#include <algorithm>
#include <array>
#include <type_traits>

#include "bindings/density/kernels.hpp"
#include "bindings/loop/numpy.hpp"

namespace microfacet::bindings {
namespace {

// From this length on a ufunc tabulates a density whose parameters are constant.
constexpr npy_intp long_array = 8192;

// Consecutive elements of what NumPy hands to a loop for values of type T.
template <class T>
class elements {
 public:
  elements(const operation_kernels& op, char* const* args, const npy_intp* steps, npy_intp first, npy_intp n)
      : op_(op), args_(args), steps_(steps), first_(first), n_(n) {}

  void evaluate() const {
    const bool constant = std::all_of(steps_ + op_.plan.values, steps_ + op_.plan.inputs,
                                      [](npy_intp step) { return step == 0; });
    const bool has_tables_alone = op_.wide.constant == nullptr;
    if (constant && (op_.plan.wide_parameters || has_tables_alone || n_ >= long_array) && from_any_tables())
      return;
    if (has_tables_alone && constant)
      fill_with_nan();
    else if (has_tables_alone && op_.wide.varying == nullptr)
      for (npy_intp i = 0; i < n_; ++i) part(i, 1).evaluate();
    else if (std::is_same_v<T, float> &&
             (op_.single.constant != nullptr || op_.single.varying_tables != nullptr))
      in_float32_where_it_serves(constant);
    else
      in_own_forms<double>(constant);
  }

 private:
  elements part(npy_intp first, npy_intp n) const { return {op_, args_, steps_, first_ + first, n}; }
  char* at(std::size_t argument, npy_intp i) const {
    return args_[argument] + (first_ + i) * steps_[argument];
  }
  double parameter(std::size_t k, npy_intp i) const {
    const char* const p = at(op_.plan.values + k, i);
    return op_.plan.wide_parameters ? *reinterpret_cast<const double*>(p)
                                    : static_cast<double>(*reinterpret_cast<const T*>(p));
  }
  std::array<double, most_parameters> parameters(npy_intp i = 0) const {
    std::array<double, most_parameters> numbers;
    for (std::size_t k = 0; k < op_.plan.inputs - op_.plan.values; ++k) numbers[k] = parameter(k, i);
    return numbers;
  }
  T& result(std::size_t k, npy_intp i) const { return *reinterpret_cast<T*>(at(op_.plan.inputs + k, i)); }
  template <class Compute>
  void run(bool constant, block_kernel<Compute> kernel, const void* distribution) const {
    in_blocks<Compute, T>(op_.plan, args_, steps_, first_, n_, constant, kernel, distribution);
    // A normal on the horizon by rounding alone stays above it.
    if (!op_.samples_visible || std::is_same_v<Compute, T>) return;
    for (npy_intp i = 0; i < n_; ++i)
      if (result(2, i) == T(0)) result(2, i) = smallest<T>();
  }

  // At constant parameters: false where the maker has no distribution of them.
  template <class Compute>
  bool run_made(typename kernel_set<Compute>::maker make, block_kernel<Compute> kernel) const {
    distribution_in_use made;
    if (!make(parameters().data(), op_.functions, made)) return false;
    run(true, kernel, made.distribution.data());
    return true;
  }
  template <class Compute>
  void in_own_forms(bool constant) const {
    const kernel_set<Compute>& kernels = op_.of<Compute>();
    if (constant)
      run_made<Compute>(kernels.own_forms, kernels.constant);
    else if (kernels.varying_tables != nullptr)
      from_varying_tables(kernels);
    else if (kernels.varying != nullptr)
      run(false, kernels.varying, nullptr);
    else  // frozen distributions have constant parameters: no kernel of its own for others
      for (npy_intp i = 0; i < n_; ++i) part(i, 1).template in_own_forms<Compute>(true);
  }
  template <class Compute>
  void from_varying_tables(const kernel_set<Compute>& kernels) const {
    distribution_in_use made;
    if (!kernels.varying_tables(parameters().data(), op_.functions, made)) return fill_with_nan();
    run(false, kernels.varying, made.distribution.data());
  }
  bool fits_float32(npy_intp i = 0) const {
    return op_.fits_float32(parameters(i).data(), op_.samples_visible);
  }
  bool all_in_float32_ranges() const {
    bool outside = false;
    for (std::size_t k = 0; k < op_.plan.inputs - op_.plan.values; ++k) {
      const interval range = op_.float32_ranges[k];
      for (npy_intp i = 0; i < n_; ++i) outside |= range.excludes(parameter(k, i));
    }
    return !outside;
  }
  void in_float32_where_it_serves(bool constant) const {
    if (constant || op_.plan.wide_parameters) return in_runs(constant);
    for (npy_intp first = 0; first < n_; first += block_length) {
      const elements block = part(first, std::min<npy_intp>(block_length, n_ - first));
      block.all_in_float32_ranges() ? block.template in_own_forms<float>(false) : block.in_runs(false);
    }
  }
  void in_runs(bool constant) const {
    // Runs of elements of one kind, each in its own arithmetic.
    for (npy_intp first = 0, last = 0; first < n_; first = last) {
      const bool fits = fits_float32(first);
      last = constant ? n_ : first + 1;
      while (last < n_ && fits_float32(last) == fits) ++last;
      const elements alike = part(first, last - first);
      fits ? alike.template in_own_forms<float>(constant) : alike.template in_own_forms<double>(constant);
    }
  }

  // Whether tables did it: there are some that keep the contract.
  template <class Compute>
  bool from_tables() const {
    const kernel_set<Compute>& kernels = op_.of<Compute>();
    return kernels.table != nullptr && run_made<Compute>(kernels.tables, kernels.table);
  }
  bool from_any_tables() const {
    if (op_.samples_visible && op_.draws_in_closed_form(parameters().data())) return false;
    if constexpr (std::is_same_v<T, float>) {
      // A second look at visible normals needs the arguments, which a result may take the place of.
      if (op_.single.table != nullptr && fits_float32() && !(op_.samples_visible && in_place()) &&
          from_tables<float>()) {
        if (op_.samples_visible) draw_rest_in_double();
        return true;
      }
    }
    return from_tables<double>();
  }
  bool in_place() const {
    char* const* const results = args_ + op_.plan.inputs;
    return std::find_first_of(args_, results, results, results + op_.plan.outputs) != results;
  }
  // Directions so far below the horizon that tables in float32 do not reach them were left at nan.
  void draw_rest_in_double() const {
    const auto is_left = [this](npy_intp i) { return result(2, i) != result(2, i); };
    for (npy_intp first = 0, last; first < n_; first = last + 1) {
      while (first < n_ && !is_left(first)) ++first;
      last = first;
      while (last < n_ && is_left(last)) ++last;
      if (last == first) continue;
      const elements rest = part(first, last - first);
      if (!rest.template from_tables<double>() && op_.wide.constant != nullptr)
        rest.template in_own_forms<double>(true);
    }
  }
  void fill_with_nan() const {
    for (std::size_t k = 0; k < op_.plan.outputs; ++k)
      for (npy_intp i = 0; i < n_; ++i) result(k, i) = nan<T>();
  }

  const operation_kernels& op_;
  char* const* args_;
  const npy_intp* steps_;
  npy_intp first_, n_;
};

}  // namespace

template <class T>
void density_loop(char** args, const npy_intp* dimensions, const npy_intp* steps, void* data) {
  if (dimensions[0] == 0) return;
  const quiet_floating_point guard;
  elements<T>(*static_cast<const operation_kernels*>(data), args, steps, 0, dimensions[0]).evaluate();
}
template void density_loop<float>(char**, const npy_intp*, const npy_intp*, void*);
template void density_loop<double>(char**, const npy_intp*, const npy_intp*, void*);

}  // namespace microfacet::bindings
