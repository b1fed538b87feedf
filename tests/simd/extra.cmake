tessera_kernels(${target} ${CMAKE_CURRENT_SOURCE_DIR}/simd/operations.simd.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/simd/record_kernels.simd.cpp ${CMAKE_CURRENT_SOURCE_DIR}/simd/texel_kernels.simd.cpp)

# Sanitizers add weak symbols of their own.
if(NOT TESSERA_SANITIZE)
  cmake_language(DEFER CALL tessera_add_kernel_symbol_tests)
endif()
if(NOT TESSERA_SANITIZE AND "avx2" IN_LIST TESSERA_ISAS)
  add_library(tessera_leaking_avx2 OBJECT ${CMAKE_CURRENT_SOURCE_DIR}/simd/leaking.cpp)
  target_compile_options(tessera_leaking_avx2 PRIVATE ${TESSERA_ISA_FLAGS_avx2})
  target_link_libraries(tessera_leaking_avx2 PRIVATE tessera_flags)
  tessera_add_kernel_symbol_test(kernel_symbols.finds_a_leak tessera_leaking_avx2 avx2)
  set_tests_properties(kernel_symbols.finds_a_leak PROPERTIES
    PASS_REGULAR_EXPRESSION "weak symbols outside the namespaces of avx2:[ \n]*_ZN7tessera19shared_between_isasEf")
endif()

# The recorded bits once more, with the C library's fused and AVX2 paths switched off.
add_test(NAME simd.bits_without_glibc_fma COMMAND ${target} --gtest_filter=OperationsHash.*)
set_tests_properties(simd.bits_without_glibc_fma PROPERTIES
  ENVIRONMENT "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F")
