# An independent reader to compare with; without it that test is left out.
find_package(assimp QUIET)
if(assimp_FOUND)
  target_link_libraries(${target} PRIVATE assimp::assimp)
  target_compile_definitions(${target} PRIVATE TESSERA_HAS_ASSIMP)
else()
  message(STATUS "assimp not found: tests/load/oracle_test.cpp compares nothing")
endif()
