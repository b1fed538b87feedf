foreach(name all_pairs exactness kernel_setup kernel_world)
  target_sources(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/raster/${name}.cpp)
endforeach()
# The workloads of `tessera bench`.
foreach(name workloads workload_meshes traced_workloads parse)
  target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/cli/${name}.cpp)
endforeach()
