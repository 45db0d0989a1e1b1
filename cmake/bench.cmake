# Builds the benchmarks (./run bench). Libraries that are not installed are left out, with a message.
find_package(benchmark QUIET)
if(NOT benchmark_FOUND)
  message(STATUS "Google Benchmark was not found (Debian: libbenchmark-dev): the benchmarks are not built")
  return()
endif()

file(GLOB_RECURSE bench_sources CONFIGURE_DEPENDS bench/*.cpp)
list(FILTER bench_sources EXCLUDE REGEX "/bench/(peers|commands)/")
add_executable(chronormal_bench ${bench_sources})
target_include_directories(chronormal_bench PRIVATE bench src)
target_compile_definitions(chronormal_bench PRIVATE CHRONORMAL_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                    "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_AVX3_DL)")
target_link_libraries(chronormal_bench PRIVATE chronormal_io chronormal_product_flags benchmark::benchmark hwy::hwy
                                               CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json
                                               meshoptimizer::meshoptimizer)
find_package(Eigen3 QUIET NO_MODULE)
if(TARGET Eigen3::Eigen)
  target_link_libraries(chronormal_bench PRIVATE Eigen3::Eigen)
  target_compile_definitions(chronormal_bench PRIVATE CHRONORMAL_HAVE_EIGEN)
else()
  message(STATUS "Eigen was not found (Debian: libeigen3-dev): the benchmarks do without it")
endif()
if(TARGET chronormal_peers)
  target_link_libraries(chronormal_bench PRIVATE chronormal_peers)
  target_compile_definitions(chronormal_bench PRIVATE CHRONORMAL_HAVE_PEERS)
endif()
