// Derived by tools/derive_visible.py; do not edit by hand. Lowest power first.
#pragma once

#include <array>

#include "microfacet/special/bivariate.hpp"

namespace microfacet::coefficients {

// g/s with (1 + g) exp(-g) = exp(-s^2/2), s <= 13.4: relative error 7.4e-08
inline constexpr std::array<float, 5> k0_excess_numerator_32{
    0.99999994F, 0.8109059F, 0.27189732F, 0.042726535F, 0.0024127956F};

inline constexpr std::array<float, 4> k0_excess_denominator_32{
    1.0F, 0.47757024F, 0.084940866F, 0.004830029F};

// g/s with (1 + g) exp(-g) = exp(-s^2/2), s <= 37.8: relative error 1.4e-08
inline constexpr std::array<double, 6> k0_excess_numerator_64{
    0.9999999861, 0.9066784085, 0.3520403333, 0.06914749642, 0.006274364965, 0.0001463389835};

inline constexpr std::array<double, 5> k0_excess_denominator_64{
    1.0, 0.5733446103, 0.1331500386, 0.01253725143, 0.0002927139189};

// P over what it is where the logarithm of the probability is a parabola: error 3.9e-03
inline constexpr bivariate<float, 5, 5, 5, 5> visible_upper{{
    0.996402F, 0.0751876F, -0.238852F, 0.251652F, -0.0881446F, -0.00234275F, -1.05609F, 5.41965F, -7.47116F,
    3.24007F, 0.00521959F, -1.79473F, -1.69058F, 6.36453F, -3.50417F, -0.00323735F, 1.65397F, -1.18305F,
    -1.31072F, 1.14027F}};

// What (P - X)(P + X) has beyond the depth, over its root: error 1.8e-03
inline constexpr bivariate<float, 5, 5, 5, 5> visible_below{{
    1.77202e-05F, 2.99158F, -0.805212F, -1.69073F, 0.91824F, 0.00370069F, -5.66015F, 12.6135F, -10.8097F,
    3.15661F, 0.0317452F, 1.80688F, -16.7552F, 28.1992F, -13.533F, -0.029653F, 1.48917F, 0.658504F, -8.95085F,
    6.51034F}};

// -log((X + P)/X) (WIDTH + X)/depth: error 1.2e-02
inline constexpr bivariate<float, 6, 6, 6, 6, 6> visible_lower{{
    -1.1292F, 17.445F, -47.6974F, 62.7586F, -41.0272F, 10.625F, 5.56029F, -53.9851F, 167.811F, -240.308F,
    162.951F, -42.4546F, -5.0592F, 50.0847F, -152.565F, 208.163F, -133.005F, 32.476F, 1.89028F, -19.3552F,
    60.3879F, -83.9556F, 54.623F, -13.6007F, -0.244135F, 2.5493F, -8.06306F, 11.347F, -7.47658F, 1.8879F}};

}  // namespace microfacet::coefficients
