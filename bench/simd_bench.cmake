find_package(benchmark REQUIRED)
target_link_libraries(tessera_simd_bench PRIVATE benchmark::benchmark)
target_include_directories(tessera_simd_bench PRIVATE ${PROJECT_SOURCE_DIR}/tests)
tessera_kernels(tessera_simd_bench ${PROJECT_SOURCE_DIR}/tests/simd/operations.simd.cpp)
