// A distribution as functions on arrays, whatever its family: what materials are computed from. One set of
// kernels serves the quantities of directions and every material.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "bindings/loop/numpy.hpp"
#include "microfacet/bsdf/walk/rays.hpp"

namespace microfacet::bindings {

enum class quantity { D, area, visible, visible_of_mixture, visible_bounded, pdf_bounded, count };

template <class Real>
class array_distribution {
 public:
  struct function {
    block_kernel<Real> kernel = nullptr;
    const void* distribution = nullptr;
  };
  std::array<function, static_cast<std::size_t>(quantity::count)> functions;

  bool has(quantity q) const { return of(q).kernel != nullptr; }
  void D(int n, const block3<Real>& m, block<Real>& out) const { call(quantity::D, n, m, out); }
  void area(int n, const block3<Real>& w, block<Real>& out) const { call(quantity::area, n, w, out); }
  // By the scheme for walks, from four arrays of uniform numbers.
  void visible(int n, const block3<Real>& w, const block<Real>* xi, block3<Real>& m) const {
    draw(has(quantity::visible_of_mixture) ? quantity::visible_of_mixture : quantity::visible, n, w, xi, m);
  }
  void draw(quantity q, int n, const block3<Real>& w, const block<Real>* xi, block3<Real>& m) const {
    const std::array<const Real*, 7> in{w.x.data(),   w.y.data(),   w.z.data(),  xi[0].data(),
                                        xi[1].data(), xi[2].data(), xi[3].data()};
    const std::array<Real*, 3> out{m.x.data(), m.y.data(), m.z.data()};
    of(q).kernel(of(q).distribution, in.data(), out.data(), n);
  }
  void pdf_bounded(int n, const block3<Real>& m, const block3<Real>& w, block<Real>& density) const {
    const std::array<const Real*, 6> in{m.x.data(), m.y.data(), m.z.data(),
                                        w.x.data(), w.y.data(), w.z.data()};
    Real* out = density.data();
    of(quantity::pdf_bounded).kernel(of(quantity::pdf_bounded).distribution, in.data(), &out, n);
  }

 private:
  const function& of(quantity q) const { return functions[static_cast<std::size_t>(q)]; }
  void call(quantity q, int n, const block3<Real>& v, block<Real>& result) const {
    const std::array<const Real*, 3> in{v.x.data(), v.y.data(), v.z.data()};
    Real* out = result.data();
    of(q).kernel(of(q).distribution, in.data(), &out, n);
  }
};

// A family for materials: its parameters, and its distributions made for the length of a call. `then` is not
// called, and the result false, where arithmetic in Real does not serve these parameters.
template <class Real>
using with_distribution = bool (*)(const double* parameters,
                                   void (*then)(const array_distribution<Real>&, void*), void* data);
struct material_family {
  std::size_t parameters;
  with_distribution<float> single;
  with_distribution<double> wide;
  template <class Real>
  with_distribution<Real> with() const {
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return wide;
    }
  }
};

// The ufuncs of all materials of a family.
bool add_materials(PyObject* space, const material_family& family);

}  // namespace microfacet::bindings
