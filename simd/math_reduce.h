// Reduction of large angles, for math_trig.h. Compiled once, in math_reduce.cpp.
#pragma once

namespace tessera::math {

// x = (4 m + quadrant) * pi/2 + high + low for some integer m; |high| <= pi/4.
struct ReducedAngle {
    double high, low;
    unsigned quadrant;  // 0 .. 3
};
// For |x| >= 2^16; infinities and NaN give NaN.
ReducedAngle reduce_angle(double x);

}  // namespace tessera::math
