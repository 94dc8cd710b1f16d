// Names that system headers define as macros, for headers that must not use them. Function-like ones (min,
// max) bite where a parenthesis follows. The standard library comes first: it does use some.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// <windows.h> and what it includes
#define near
#define far
#define small char
#define hyper long
#define interface struct
#define huge
#define pascal
#define cdecl
#define IN
#define OUT
#define OPTIONAL
#define CONST const
#define VOID void
#define THIS this
#define PURE
#define STRICT 1
#define TRUE 1
#define FALSE 0
#define ERROR 0
#define NO_ERROR 0
#define DELETE 1
#define ABSOLUTE 1
#define RELATIVE 2
#define OPAQUE 2
#define TRANSPARENT 1
#define ALTERNATE 1
#define INFINITE 0xffffffff
#define MAX_PATH 260
#define Yield()
#define RGB(r, g, b) 0
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define rad1 1
#define chx1 1
#define psh1 1
#define grp1 1

// <math.h>, <complex.h>, <limits.h> of some systems
#define I 1
#define complex 1
#define imaginary 1
#define DOMAIN 1
#define SING 2
#define OVERFLOW 3
#define UNDERFLOW 4
#define PLOSS 5
#define TLOSS 6
#define HUGE 1
#define PI 3
#define EPSILON 1

// <sys/sysmacros.h>, <sys/param.h>, <termios.h>, and what GNU compilers define by themselves
#define major(x) 0
#define minor(x) 0
#define makedev(x, y) 0
#define MIN(a, b) 0
#define MAX(a, b) 0
#define howmany(x, y) 0
#define roundup(x, y) 0
#define ECHO 1
#define B0 1
#define B50 1
#define unix 1
#define linux 1

// X11
#define None 0L
#define Bool int
#define True 1
#define False 0
#define Status int
#define Success 0
#define Always 2
#define Above 0
#define Below 1
#define Complex 0
#define Convex 2
#define Unsorted 0
#define FocusIn 9
#define CursorShape 0

// Qt, AssertMacros.h and Objective-C of macOS
#define emit
#define slots
#define signals public
#define foreach 1
#define forever for (;;)
#define check(x)
#define verify(x)
#define require(x, y)
#define nil 0
#define YES 1
#define NO 0
