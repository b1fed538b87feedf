tessera_kernels(${target} ${CMAKE_CURRENT_SOURCE_DIR}/shading/chain.simd.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/shading/lookup.simd.cpp)
foreach(isa ${TESSERA_ISAS})
  target_include_directories(${target}_${isa} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
