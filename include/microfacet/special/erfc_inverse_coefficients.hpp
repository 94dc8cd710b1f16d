// Derived by tools/derive_erfc_inverse.py in 60 digits; do not edit by hand. Lowest power first.
#pragma once

#include <array>

namespace microfacet::coefficients {

// t^2/depth, t <= 9.3: relative error 2.4e-07
inline constexpr std::array<float, 6> erfc_inverse_numerator_32{0.78539824F,  0.25750113F,    0.050726343F,
                                                                0.006800833F, 0.00049635087F, 5.76281e-06F};

inline constexpr std::array<float, 6> erfc_inverse_denominator_32{1.0F,         0.3042654F,    0.057924524F,
                                                                  0.007614829F, 0.0005121499F, 5.770646e-06F};

// t^2/depth, t <= 26.5: relative error 3.1e-06
inline constexpr std::array<double, 6> erfc_inverse_numerator_64{
    0.7853958927798798,   0.1752423697392566,     0.03198941552187104,
    0.002695920903168646, 2.6799138651935628e-05, 2.9006738684368312e-08};

inline constexpr std::array<double, 6> erfc_inverse_denominator_64{1.0,
                                                                   0.1994888133448623,
                                                                   0.036626763846125225,
                                                                   0.002768947287578417,
                                                                   2.6913920196160936e-05,
                                                                   2.900991676480004e-08};

}  // namespace microfacet::coefficients
