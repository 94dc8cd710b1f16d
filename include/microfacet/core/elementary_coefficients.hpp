// Derived by tools/derive_elementary.py in 60 digits; do not edit by hand. Lowest power first.
#pragma once

#include <array>

namespace microfacet::coefficients {

// exp(r) = 1 + r + r^2 P(r), |r| <= ln(2)/2: relative error 3.3e-9
inline constexpr std::array<float, 5> exp_32{
    0.49999994F, 0.1666652F, 0.041668322F, 0.008368842F, 0.0013814194F};

// exp(r) = 1 + r + r^2 P(r), |r| <= ln(2)/2: relative error 4.7e-18
inline constexpr std::array<double, 10> exp_64{
    0.5000000000000011, 0.16666666666666413, 0.0416666666665289, 0.008333333333495405, 0.0013888888943907874,
    0.00019841269504775549, 2.4801492773655365e-05, 2.755758730647569e-06, 2.763037578847069e-07,
    2.49999858751376e-08};

// log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 0.1717: relative error 8.2e-10
inline constexpr std::array<float, 3> log_32{
    0.66666776F, 0.39977548F, 0.29872414F};

// log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 0.1717: relative error 1.4e-18
inline constexpr std::array<double, 7> log_64{
    0.6666666666666735, 0.39999999999412517, 0.28571428742907484, 0.22222198511917987, 0.1818356790278174,
    0.15313949408595148, 0.14797054375124805};

// log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 1/5: relative error 2.8e-9
inline constexpr std::array<float, 3> log_of_quotient_32{
    0.6666695F, 0.39957777F, 0.30361018F};

// log((1 + s)/(1 - s)) = 2 s + s^3 R(s^2), |s| <= 1/5: relative error 1.6e-19
inline constexpr std::array<double, 8> log_of_quotient_64{
    0.666666666666666, 0.4000000000005613, 0.2857142855596282, 0.22222224281629047, 0.18181666743229735,
    0.15391084265654587, 0.13174054736423008, 0.13840016812631298};

// log(1 + f) = f - f^2/2 + f^3 Q(f), sqrt(1/2) <= 1 + f <= sqrt(2): relative error 5.9e-9
inline constexpr std::array<float, 8> log_polynomial_32{
    0.3333333F, -0.2500082F, 0.20001228F, -0.1662338F, 0.14201836F, -0.13160256F, 0.1276128F, -0.07633949F};

// sin(pi y/2) = y S(y^2), |y| <= 1/2: relative error 2.9e-8
inline constexpr std::array<float, 4> sin_32{
    1.5707964F, -0.6459638F, 0.07967998F, -0.0046016686F};

// sin(pi y/2) = y S(y^2), |y| <= 1/2: relative error 3.9e-17
inline constexpr std::array<double, 7> sin_64{
    1.5707963267948966, -0.6459640975062442, 0.07969262624603952, -0.00468175413228158,
    0.00016044115028427083, -3.5986417265036328e-06, 5.633717162635701e-08};

// cos(pi y/2) = C(y^2), |y| <= 1/2: relative error 1.9e-9
inline constexpr std::array<float, 5> cos_32{
    1.0F, -1.2337005F, 0.2536691F, -0.020860262F, 0.0009037633F};

// cos(pi y/2) = C(y^2), |y| <= 1/2: relative error 4.2e-18
inline constexpr std::array<double, 8> cos_64{
    1.0, -1.2337005501361697, 0.25366950790104653, -0.020863480763312688, 0.0009192602741911358,
    -2.520203678874807e-05, 4.7106096839409796e-07, -6.321203877522691e-09};

}  // namespace microfacet::coefficients
