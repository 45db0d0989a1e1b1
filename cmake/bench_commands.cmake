# Builds the benchmark of commands (./run bench --commands), but only on request. Libraries that are not installed are
# left out of the comparison.
add_executable(chronormal_bench_commands EXCLUDE_FROM_ALL bench/commands/main.cpp)
target_include_directories(chronormal_bench_commands PRIVATE src)
target_link_libraries(chronormal_bench_commands PRIVATE chronormal_io chronormal_product_flags CLI11::CLI11 fmt::fmt
                                                       nlohmann_json::nlohmann_json)
foreach(reader "ASSIMP assimp/Importer.hpp assimp" "TINYOBJ tiny_obj_loader.h tinyobjloader")
  separate_arguments(reader)
  list(POP_FRONT reader name header library)
  find_path(${name}_INCLUDE ${header})
  find_library(${name}_LIBRARY ${library})
  if(${name}_INCLUDE AND ${name}_LIBRARY)
    target_include_directories(chronormal_bench_commands SYSTEM PRIVATE ${${name}_INCLUDE})
    target_link_libraries(chronormal_bench_commands PRIVATE ${${name}_LIBRARY})
    target_compile_definitions(chronormal_bench_commands PRIVATE CHRONORMAL_HAVE_${name})
  endif()
endforeach()
