// A distribution as the materials' kernels take it, whatever its family: functions on arrays, which walks and
// samplers call, and the fused kernels of single scattering that know its type.
#pragma once

#include <array>
#include <cstddef>

#include "bindings/loop/numpy.hpp"
#include "bindings/material/block.hpp"
#include "microfacet/smith/mean_plane.hpp"
#include "microfacet/smith/ndf.hpp"
#include "microfacet/tabulated/tabulated.hpp"

namespace microfacet::bindings {

enum class quantity { D, sigma, visible, visible_of_mixture, visible_bounded, count };
// Single scattering, of a metal and of a transparent medium.
enum class event { eval, pdf, sample, facets, count };

template <class Real>
class array_distribution;
template <class Real>
using material_kernel = void (*)(const array_distribution<Real>&, material_blocks<Real>&);
template <class Real>
struct fused_kernels {
  std::array<material_kernel<Real>, static_cast<std::size_t>(event::count)> conductor, dielectric;
};

template <class Real>
class array_distribution {
 public:
  struct function {
    block_kernel<Real> kernel = nullptr;
    const void* distribution = nullptr;
  };
  std::array<function, static_cast<std::size_t>(quantity::count)> functions;
  const fused_kernels<Real>* fused = nullptr;
  const void* fused_distribution = nullptr;  // of the type that the fused kernels know
  // Where the mean plane is not horizontal: the coordinates of the functions, in which it is.
  const mean_plane::frame* frame = nullptr;

  bool has(quantity q) const { return of(q).kernel != nullptr; }
  void D(int n, const block3<Real>& m, block<Real>& out) const { call(quantity::D, n, m, out.data()); }
  void sigma(int n, const block3<Real>& w, block<Real>& out) const {
    call(quantity::sigma, n, w, out.data());
  }
  // By the scheme for walks, from four arrays of uniform numbers.
  void visible(int n, const block3<Real>& w, const block<Real>* xi, block3<Real>& m) const {
    draw(has(quantity::visible_of_mixture) ? quantity::visible_of_mixture : quantity::visible, n, w,
         {xi[0].data(), xi[1].data(), xi[2].data(), xi[3].data()}, m);
  }
  void draw(quantity q, int n, const block3<Real>& w, const std::array<const Real*, 4>& xi,
            block3<Real>& m) const {
    const std::array<const Real*, 7> in{w.x.data(), w.y.data(), w.z.data(), xi[0], xi[1], xi[2], xi[3]};
    const std::array<Real*, 3> out{m.x.data(), m.y.data(), m.z.data()};
    of(q).kernel(of(q).distribution, in.data(), out.data(), n);
  }
  template <class Vectors>
  void call(quantity q, int n, const Vectors& v, Real* result) const {
    const std::array<const Real*, 3> in{v.x.data(), v.y.data(), v.z.data()};
    of(q).kernel(of(q).distribution, in.data(), &result, n);
  }

 private:
  const function& of(quantity q) const { return functions[static_cast<std::size_t>(q)]; }
};

// The tables of any density under the shape of directions.
template <class Real>
using tabulated_directions = ndf<tabulated<lanes<Real>>, lanes<Real>, anisotropic_shape<lanes<Real>>>;
// Fused kernels that are compiled once, in materials.cpp: on the tables of any density, and on the functions
// on arrays, for densities without good tables, in double precision alone.
template <class Real>
const fused_kernels<Real>& fused_kernels_on_tables();
const fused_kernels<double>& fused_kernels_on_arrays();

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
