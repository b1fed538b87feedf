# Compile flags that every target of Tessera shares, as one interface library.
add_library(tessera_flags INTERFACE)
target_compile_features(tessera_flags INTERFACE cxx_std_20)
# No contraction to fused multiply-add and no assumption about floating point: the bits are the contract.
target_compile_options(tessera_flags INTERFACE -ffp-contract=off -fno-fast-math
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
# Templates over the number type combine masks with & and |, which are plain bools in the one-lane case.
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  target_compile_options(tessera_flags INTERFACE -Wno-bitwise-instead-of-logical)
endif()
if(TESSERA_WERROR)
  target_compile_options(tessera_flags INTERFACE -Werror)
endif()
target_include_directories(tessera_flags INTERFACE
  ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include)

if(TESSERA_SANITIZE)
  if(NOT TESSERA_SANITIZE MATCHES "^(address|undefined|address,undefined|thread)$")
    message(FATAL_ERROR "TESSERA_SANITIZE=${TESSERA_SANITIZE}: expected address, undefined, address,undefined or thread")
  endif()
  add_compile_options(-fsanitize=${TESSERA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<$<CONFIG:Release>:-g1>)
  add_link_options(-fsanitize=${TESSERA_SANITIZE})
endif()
if(NOT TESSERA_THREADS MATCHES "^(tbb|std)$")
  message(FATAL_ERROR "TESSERA_THREADS=${TESSERA_THREADS}: expected tbb or std")
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

# Instrumented, g++ 12 mistakes sound code of the standard library for overflows and uninitialised reads; builds without
# sanitizers have these warnings.
if(TESSERA_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(tessera_flags INTERFACE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
    -Wno-maybe-uninitialized -Wno-restrict)
endif()
