# An executable beside that of trace/: both have test helpers of the same names.
target_sources(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/raster/kernel_world.cpp)
