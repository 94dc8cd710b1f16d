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

// -ffast-math, -Ofast and -fassociative-math let a compiler turn (a + b) - a into b. MICROFACET_HOLD(x)
// leaves the variable x, a number, as it is, and nothing is regrouped across it; MICROFACET_HOLD_LANES(x)
// does so to a vector. Without such flags both are nothing at all. On x86 Clang has a word for it. GCC has
// one that it forgets where it turns a loop over numbers into vectors, which an asm prevents. GCC before 12,
// and Clang on other processors, tell only of -ffast-math and -Ofast, not of -fassociative-math alone.
#if defined(__clang__) && (defined(__x86_64__) || defined(__i386__))
#define MICROFACET_HOLD(x) static_cast<void>(x = __arithmetic_fence(x))
#define MICROFACET_HOLD_LANES(x) MICROFACET_HOLD(x)
#elif defined(__ASSOCIATIVE_MATH__) || (defined(__FAST_MATH__) && __GNUC__ < 12)
#if defined(__x86_64__) || defined(__i386__)
#define MICROFACET_HOLD(x) asm("" : "+x"(x))
#elif defined(__aarch64__)
#define MICROFACET_HOLD(x) asm("" : "+w"(x))
#else
#define MICROFACET_HOLD(x) asm("" : "+m"(x))
#endif
#if __GNUC__ >= 12
#define MICROFACET_HOLD_LANES(x) static_cast<void>(x = __builtin_assoc_barrier(x))
#else
#define MICROFACET_HOLD_LANES(x) asm("" : "+m"(x))
#endif
#else
#define MICROFACET_HOLD(x) static_cast<void>(x)
#define MICROFACET_HOLD_LANES(x) static_cast<void>(x)
#endif

// Results with more digits than their type has are as wrong as regrouped ones.
#if defined(__FLT_EVAL_METHOD__) && \
    (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2)
#error \
    "microfacet: float and double have to be rounded to their own precision; \
replace -mfpmath=387 by -msse2 -mfpmath=sse"
#endif
