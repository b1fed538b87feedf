# Compilation of *.simd.cpp once per instruction set (placeholder until the number layer lands).
