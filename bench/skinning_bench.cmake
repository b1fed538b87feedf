find_package(benchmark REQUIRED)
target_link_libraries(tessera_skinning_bench PRIVATE benchmark::benchmark)
