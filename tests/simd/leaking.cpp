// A kernel file as it must not be: its inline function leaves a weak symbol that files compiled for
// other instruction sets share. The symbol check must find it.
namespace tessera {
__attribute__((noinline)) inline float shared_between_isas(float x) { return x * x + 1.0f; }
namespace avx2 {
float leaking_kernel(float x) { return shared_between_isas(x); }
}  // namespace avx2
}  // namespace tessera
