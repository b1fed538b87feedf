find_package(benchmark REQUIRED)
target_link_libraries(tessera_label_bench PRIVATE benchmark::benchmark)
target_sources(tessera_label_bench PRIVATE ${PROJECT_SOURCE_DIR}/src/cli/workload_meshes.cpp)
