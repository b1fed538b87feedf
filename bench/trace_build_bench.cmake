find_package(CLI11 REQUIRED)
target_link_libraries(tessera_trace_build_bench PRIVATE embree TBB::tbb CLI11::CLI11)
