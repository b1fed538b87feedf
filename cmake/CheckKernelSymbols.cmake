# cmake -D NM=nm -D ISA=avx2 -D OBJECTS=a.o;b.o -P CheckKernelSymbols.cmake
# Fails when an object defines a weak symbol outside the namespaces of its instruction set
# (tessera::avx2, or Highway's own hwy::N_AVX2). Such a symbol comes from an inline function or
# template that other files may instantiate too; the linker keeps one copy, and that copy may hold
# instructions that the processor lacks. The symbol itself is looked at mangled: namespace avx2 is
# "4avx2" there, be it the function's own or that of a template argument.
cmake_minimum_required(VERSION 3.25)
string(LENGTH ${ISA} length)
set(highway_sse4 6N_SSE4)
set(highway_avx2 6N_AVX2)
set(highway_avx512 6N_AVX3)
set(bad "")
foreach(object ${OBJECTS})
  execute_process(COMMAND ${NM} --defined-only ${object} OUTPUT_VARIABLE symbols
    COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE ";" "," symbols "${symbols}")
  string(REPLACE "\n" ";" symbols "${symbols}")
  list(FILTER symbols INCLUDE REGEX " [WwVvu] ")
  # The compiler's own reference to the C++ runtime: data, the same in every object.
  list(FILTER symbols EXCLUDE REGEX " DW\\.ref\\.__gxx_personality_v0$")
  list(FILTER symbols EXCLUDE REGEX "(7tessera|S[0-9A-Z]*_)${length}${ISA}|${highway_${ISA}}")
  foreach(symbol ${symbols})
    string(REGEX REPLACE "^[^ ]* +" "" symbol "${symbol}")
    string(APPEND bad "  ${symbol}  in ${object}\n")
  endforeach()
endforeach()
if(bad)
  message(FATAL_ERROR "weak symbols outside the namespaces of ${ISA}:\n${bad}")
endif()
