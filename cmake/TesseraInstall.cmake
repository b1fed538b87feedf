# Install rules: headers, library, command, documents, the CMake package and the pkg-config file.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Tessera)

# A static library carries no dependencies of its own, so whoever links it must find them again.
# GLM is header-only and used inside only; nothing of it is needed here.
set(TESSERA_STATIC OFF)
set(TESSERA_PC_REQUIRES_PRIVATE "")
set(TESSERA_PC_LIBS_PRIVATE "")
if(NOT BUILD_SHARED_LIBS)
  set(TESSERA_STATIC ON)
  set(static_libraries PNG::PNG ZLIB::ZLIB JPEG::JPEG simdjson::simdjson PkgConfig::LIBDEFLATE PkgConfig::WEBP PkgConfig::DRACO
    PkgConfig::MINIZIP meshoptimizer::meshoptimizer embree Threads::Threads)
  set(TESSERA_PC_REQUIRES_PRIVATE "libpng zlib libjpeg libdeflate libwebp simdjson draco minizip")
  set(TESSERA_PC_LIBS_PRIVATE "-lmeshoptimizer -lembree3 -pthread -lstdc++ -lm")
  if(TESSERA_THREADS STREQUAL "tbb")
    list(APPEND static_libraries TBB::tbb)
    string(APPEND TESSERA_PC_REQUIRES_PRIVATE " tbb")
  endif()
  foreach(library ${static_libraries})
    target_link_libraries(tessera INTERFACE $<INSTALL_INTERFACE:$<LINK_ONLY:${library}>>)
  endforeach()
endif()

install(TARGETS tessera EXPORT TesseraTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Opened on demand, never linked.
if(TARGET tessera_oiio)
  install(TARGETS tessera_oiio LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/tessera)
endif()
install(EXPORT TesseraTargets NAMESPACE Tessera:: DESTINATION ${package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tessera DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/include/tessera/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tessera)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/TesseraConfig.cmake.in
  ${PROJECT_BINARY_DIR}/TesseraConfig.cmake INSTALL_DESTINATION ${package_dir})
# Before 1.0 a minor version may break what an embedder compiled against.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TesseraConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TesseraConfig.cmake ${PROJECT_BINARY_DIR}/TesseraConfigVersion.cmake
  DESTINATION ${package_dir})

# The .pc file finds its prefix from where it lies, so that an installed tree can be moved; the way
# up depends on how deep the library folder is (lib, lib64, lib/x86_64-linux-gnu).
file(RELATIVE_PATH TESSERA_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" TESSERA_PC_PREFIX "${TESSERA_PC_PREFIX}")
configure_file(${PROJECT_SOURCE_DIR}/cmake/tessera.pc.in ${PROJECT_BINARY_DIR}/tessera.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/tessera.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

if(TARGET tessera_command)
  file(RELATIVE_PATH to_library /prefix/${CMAKE_INSTALL_BINDIR} /prefix/${CMAKE_INSTALL_LIBDIR})
  set_target_properties(tessera_command PROPERTIES INSTALL_RPATH "$ORIGIN/${to_library}")
  install(TARGETS tessera_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
file(GLOB documents ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/docs/*.md)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DOCDIR})
