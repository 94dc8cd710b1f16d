// Derived by tools/derive_erfc_inverse.py in 60 digits; do not edit by hand. Lowest power first.
#pragma once

#include <array>

namespace microfacet::coefficients {

// t^2/depth, t <= 9.3: relative error 2.4e-07
inline constexpr std::array<float, 6> erfc_inverse_numerator_32{
    0.78539824F, 0.25728488F, 0.050678216F, 0.006791091F, 0.00049535016F, 5.752003e-06F};

inline constexpr std::array<float, 6> erfc_inverse_denominator_32{
    1.0F, 0.30398998F, 0.057869907F, 0.0076034525F, 0.0005111189F, 5.759826e-06F};

// t^2/depth, t <= 26.5: relative error 2.8e-06
inline constexpr std::array<double, 6> erfc_inverse_numerator_64{
    0.7853959664478631, 0.1718360977811877, 0.031174066563665077, 0.0025673887221137714,
    2.0197043069474992e-05, 5.759207593759044e-10};

inline constexpr std::array<double, 6> erfc_inverse_denominator_64{
    1.0, 0.19515369810500469, 0.03568738579853024, 0.0026272719648934213, 2.0217121235772912e-05,
    5.690483119503762e-10};

// t/log(1 + v), t <= 9.4: relative error 9.8e-08
inline constexpr std::array<float, 7> ierfc_inverse_numerator_32{
    0.28209478F, 0.047884967F, 0.008927109F, 0.0007633241F, 3.671807e-05F, 3.5194148e-07F, 2.9213973e-10F};

inline constexpr std::array<float, 7> ierfc_inverse_denominator_32{
    1.0F, 0.16974598F, 0.03540702F, 0.0033374925F, 0.00021764607F, 4.640731e-06F, 1.543412e-08F};

}  // namespace microfacet::coefficients
