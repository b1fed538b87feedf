# tessera_module(NAME [DEPENDS targets...]): an object library of the .cpp files in this folder. The
# layering (which module may include which) is checked by tests/layering_test.cpp.
function(tessera_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp *.h)
  list(FILTER sources EXCLUDE REGEX "\\.simd\\.cpp$")
  add_library(tessera_${name} OBJECT ${sources})
  target_link_libraries(tessera_${name} PUBLIC tessera_flags ${ARG_DEPENDS})
  set_property(GLOBAL APPEND PROPERTY TESSERA_MODULES tessera_${name})
endfunction()
