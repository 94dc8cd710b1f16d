// What the compiler and its flags decide.
#pragma once

// Whether the hardware rounds a * b + c once.
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
#define MICROFACET_FUSED 1
#else
#define MICROFACET_FUSED 0
#endif

// A pack that is passed through memory costs more than the function.
#if defined(__GNUC__)
#define MICROFACET_INLINE [[gnu::always_inline]] inline
#else
#define MICROFACET_INLINE inline
#endif

// x, and nothing is regrouped across it: -ffast-math, -Ofast and -fassociative-math let a compiler turn
// (a + b) - a into b. Without them it is nothing at all. MICROFACET_HOLD(x) does so to a variable that is one
// number: GCC loses the other barrier where it turns a loop into vectors, which an asm prevents.
#if defined(__clang__) && (defined(__x86_64__) || defined(__i386__))
#define MICROFACET_ROUNDED(x) __arithmetic_fence(x)
#define MICROFACET_HOLD(x) (x = __arithmetic_fence(x))
#elif defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 && defined(__ASSOCIATIVE_MATH__)
#define MICROFACET_ROUNDED(x) __builtin_assoc_barrier(x)
#if defined(__x86_64__) || defined(__i386__)
#define MICROFACET_HOLD(x) asm("" : "+x"(x))
#elif defined(__aarch64__)
#define MICROFACET_HOLD(x) asm("" : "+w"(x))
#else
#define MICROFACET_HOLD(x) asm("" : "+m"(x))
#endif
#elif defined(__ASSOCIATIVE_MATH__) || (defined(__clang__) && defined(__FAST_MATH__))
#error \
    "microfacet: this compiler has no barrier against -fassociative-math (part of -ffast-math and -Ofast); \
add -fno-associative-math behind it, or use g++ 12 or newer, or clang++ on x86"
#else
#define MICROFACET_ROUNDED(x) (x)
#define MICROFACET_HOLD(x) static_cast<void>(x)
#endif

// Results with more digits than their type has are as wrong as regrouped ones.
#if defined(__FLT_EVAL_METHOD__) && \
    (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2)
#error \
    "microfacet: float and double have to be rounded to their own precision; \
replace -mfpmath=387 by -msse2 -mfpmath=sse"
#endif
