# tessera_kernels(TARGET file.simd.cpp ...): compiles every file once per instruction set, with that
# set's flags, TESSERA_ISA_NAMESPACE (scalar, sse4, avx2, avx512) and TESSERA_SIMD_LANES, and adds the
# objects to TARGET (a module of tessera_module, or an executable). The flags are what simd/isa.cpp
# looks for in the processor. Elsewhere than on x86-64 only `scalar` is compiled.
# TESSERA_ISAS takes some of them, which shortens a build: the others are refused by name when the
# program runs. `scalar` is always there, as every processor has it.
set(isas scalar)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  list(APPEND isas sse4 avx2 avx512)
endif()
set(TESSERA_ISAS "${isas}" CACHE STRING "Instruction sets that kernels are compiled for: scalar and any of ${isas}")
list(REMOVE_DUPLICATES TESSERA_ISAS)
foreach(isa ${TESSERA_ISAS})
  if(NOT isa IN_LIST isas)
    message(FATAL_ERROR "TESSERA_ISAS: \"${isa}\" is no instruction set for this processor; expected some of ${isas}")
  endif()
endforeach()
if(NOT "scalar" IN_LIST TESSERA_ISAS)
  message(FATAL_ERROR "TESSERA_ISAS=${TESSERA_ISAS}: scalar must be among them")
endif()
if(NOT TESSERA_ISAS STREQUAL "scalar")
  find_path(TESSERA_HIGHWAY_INCLUDE_DIR hwy/highway.h REQUIRED)
endif()

# For simd/isa.h: TESSERA_BUILT_ISAS is a list of tessera::Isa.
set(names "")
foreach(isa ${TESSERA_ISAS})
  string(SUBSTRING ${isa} 0 1 initial)
  string(TOUPPER ${initial} initial)
  string(SUBSTRING ${isa} 1 -1 rest)
  list(APPEND names tessera::Isa::k${initial}${rest})
endforeach()
list(JOIN names "," names)
target_compile_definitions(tessera_flags INTERFACE TESSERA_BUILT_ISAS=${names})

set(TESSERA_ISA_LANES_scalar 1)
set(TESSERA_ISA_LANES_sse4 4)
set(TESSERA_ISA_LANES_avx2 8)
set(TESSERA_ISA_LANES_avx512 16)
set(TESSERA_ISA_FLAGS_scalar "")
set(TESSERA_ISA_FLAGS_sse4 -msse4.2 -maes -mpclmul)
set(TESSERA_ISA_FLAGS_avx2 -mavx2 -mfma -mf16c -mbmi -mbmi2 -mlzcnt -maes -mpclmul)
set(TESSERA_ISA_FLAGS_avx512 -march=skylake-avx512 -mprefer-vector-width=512)
# g++ copies structures of vectors through memory, in pieces of half a vector, which whole loads then
# wait for: whole pieces, and registers instead of memory for larger structures.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  foreach(isa sse4 avx2 avx512)
    list(APPEND TESSERA_ISA_FLAGS_${isa} "SHELL:--param sra-max-scalarization-size-Ospeed=8192"
      "SHELL:--param sra-max-propagations=1024")
  endforeach()
  list(APPEND TESSERA_ISA_FLAGS_avx2 -mmove-max=256 -mstore-max=256)
  list(APPEND TESSERA_ISA_FLAGS_avx512 -mmove-max=512 -mstore-max=512)
endif()

function(tessera_kernels target)
  get_target_property(type ${target} TYPE)
  foreach(isa ${TESSERA_ISAS})
    set(library ${target}_${isa})
    add_library(${library} OBJECT ${ARGN})
    # Optimised in every configuration: without inlining Highway leaves symbols that its instruction
    # sets share, and the kernels crawl.
    # Without sanitizers: instrumented, inlined vector code takes minutes and gigabytes to compile, and
    # kernels read no files; their tests have guard bytes.
    target_compile_options(${library} PRIVATE ${TESSERA_ISA_FLAGS_${isa}} $<$<CONFIG:Debug>:-O2>)
    if(TESSERA_SANITIZE)
      target_compile_options(${library} PRIVATE -O2 -fno-sanitize=all)
    endif()
    target_compile_definitions(${library} PRIVATE
      TESSERA_ISA_NAMESPACE=${isa} TESSERA_SIMD_LANES=${TESSERA_ISA_LANES_${isa}})
    target_link_libraries(${library} PRIVATE tessera_flags)
    target_include_directories(${library} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    if(NOT isa STREQUAL scalar)
      target_include_directories(${library} SYSTEM PRIVATE ${TESSERA_HIGHWAY_INCLUDE_DIR})
      set_property(GLOBAL APPEND PROPERTY TESSERA_KERNEL_LIBRARIES ${library})
    endif()
    if(type STREQUAL OBJECT_LIBRARY)
      set_property(GLOBAL APPEND PROPERTY TESSERA_MODULES ${library})
    else()
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:${library}>)
    endif()
  endforeach()
endfunction()

# Adds one test per vector object library: none of its objects may define a symbol that the linker
# could take in place of another instruction set's copy. To be called after all kernels are known.
function(tessera_add_kernel_symbol_tests)
  get_property(libraries GLOBAL PROPERTY TESSERA_KERNEL_LIBRARIES)
  foreach(library ${libraries})
    string(REGEX REPLACE ".*_" "" isa ${library})
    tessera_add_kernel_symbol_test(kernel_symbols.${library} ${library} ${isa})
  endforeach()
endfunction()
function(tessera_add_kernel_symbol_test name library isa)
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D ISA=${isa}
    -D "OBJECTS=$<JOIN:$<TARGET_OBJECTS:${library}>,;>" -P ${PROJECT_SOURCE_DIR}/cmake/CheckKernelSymbols.cmake)
endfunction()
