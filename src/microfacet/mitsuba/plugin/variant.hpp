// The types of the variant of Mitsuba that is being compiled: MICROFACET_VARIANT is its name.
#pragma once

#include <drjit/autodiff.h>
#include <drjit/jit.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/mitsuba.h>

namespace microfacet::plugin {

namespace variants {

using mitsuba::Color;
using mitsuba::MuellerMatrix;
template <class Float_, class Spectrum_>
struct types {
  using Float = Float_;
  using Spectrum = Spectrum_;
};
template <class Float>
using wavelengths = mitsuba::Spectrum<Float, 4>;
using llvm = drjit::DiffArray<JitBackend::LLVM, float>;
using cuda = drjit::DiffArray<JitBackend::CUDA, float>;

using scalar_rgb = types<float, Color<float, 3>>;
using scalar_spectral = types<float, wavelengths<float>>;
using scalar_spectral_polarized = types<float, MuellerMatrix<wavelengths<float>>>;
using llvm_ad_rgb = types<llvm, Color<llvm, 3>>;
using llvm_ad_mono = types<llvm, Color<llvm, 1>>;
using llvm_ad_mono_polarized = types<llvm, MuellerMatrix<Color<llvm, 1>>>;
using llvm_ad_spectral = types<llvm, wavelengths<llvm>>;
using llvm_ad_spectral_polarized = types<llvm, MuellerMatrix<wavelengths<llvm>>>;
using cuda_ad_rgb = types<cuda, Color<cuda, 3>>;
using cuda_ad_mono = types<cuda, Color<cuda, 1>>;
using cuda_ad_mono_polarized = types<cuda, MuellerMatrix<Color<cuda, 1>>>;
using cuda_ad_spectral = types<cuda, wavelengths<cuda>>;
using cuda_ad_spectral_polarized = types<cuda, MuellerMatrix<wavelengths<cuda>>>;

}  // namespace variants

using variant = variants::MICROFACET_VARIANT;
using Float = variant::Float;
using Spectrum = variant::Spectrum;

}  // namespace microfacet::plugin
