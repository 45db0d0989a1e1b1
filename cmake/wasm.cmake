# Sets the options of the wasm build.
add_compile_options(-fwasm-exceptions)
add_link_options(-fwasm-exceptions)
include(cmake/sources.cmake)
# Optimises for size, because browsers download and compile the module. Only code without loops that take time gets this
# option.
set(for_size $<$<CONFIG:Release>:-Os>)
target_compile_options(pugixml PRIVATE ${for_size})
target_compile_options(draco PRIVATE ${for_size})
# This version of Highway has no float64 vectors for wasm, so its plain loops over 16 bytes are compiled. The compiler
# turns these loops into SIMD128, for float64 as well (-msimd128 in cmake/product.cmake), without changing a bit of the
# results.
target_compile_definitions(hwy PUBLIC HWY_COMPILE_ONLY_EMU128)
# The evaluation is compiled without SIMD128, because moving lanes would cost more than vectors gain: evaluating a curve
# whose error is at most 1e-6 rad takes 7.2 ns with SIMD128, and 4.4 ns without.
set_source_files_properties(src/normals/curves/kernels/evaluate.cpp PROPERTIES COMPILE_OPTIONS -mno-simd128)
