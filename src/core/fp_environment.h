// The floating-point environment of the exactness contract: round to nearest, no flush-to-zero, no
// denormals-are-zero, all exceptions masked. Set for the life of the object, then restored. Every
// task, the reference renderer and the scene evaluation hold one.
#pragma once

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace tessera {

class FpEnvironment {
  public:
#if defined(__x86_64__)
    FpEnvironment() : saved_(_mm_getcsr()) { _mm_setcsr(kExact); }
    ~FpEnvironment() { _mm_setcsr(saved_); }

  private:
    static constexpr unsigned kExact = 0x1f80;  // the reset value of MXCSR
    unsigned saved_;

  public:
#else
    FpEnvironment() {}
#endif
    FpEnvironment(const FpEnvironment&) = delete;
    FpEnvironment& operator=(const FpEnvironment&) = delete;
};

}  // namespace tessera
