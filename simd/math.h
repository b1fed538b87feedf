// Elementary functions with the same bits on every machine, compiler and instruction set: templates
// over a number type F (float, double, or a vector of floats; see vec.h), made of + - * / sqrt and
// operations on bits, without libm, tables or branches. A vector's lane has the bits of `float`.
// exp2, exp, log2, log, pow, rsqrt, cbrt: math_exp.h. sin, cos, sincos, tan, asin, acos, atan, atan2,
// radians, degrees: math_trig.h. Maximum errors are stated there. The rounding mode must be to nearest
// and denormals must be on (FpEnvironment of src/core), as for every operation of vec.h.
#pragma once

#include "simd/math_exp.h"
#include "simd/math_trig.h"
