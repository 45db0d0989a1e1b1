# The wasm build.
add_compile_options(-fwasm-exceptions)
add_link_options(-fwasm-exceptions)
include(cmake/sources.cmake)
# What has no loop that takes time is compiled for size, since a module is sent to browsers and compiled there.
set(for_size $<$<CONFIG:Release>:-Os>)
target_compile_options(pugixml PRIVATE ${for_size})
target_compile_options(draco PRIVATE ${for_size})
# This version of Highway has no vectors of float64 for wasm, so that its own plain loops over 16 bytes are what is compiled.
# The compiler makes SIMD128 of them, of float64 as well (-msimd128 in cmake/product.cmake), which changes no bit.
target_compile_definitions(hwy PUBLIC HWY_COMPILE_ONLY_EMU128)
# But for evaluation, where it spends more on moving lanes than it wins: 7.2 ns for a curve within 1e-6 rad, and 4.4 without.
set_source_files_properties(src/normals/curves/kernels/evaluate.cpp PROPERTIES COMPILE_OPTIONS -mno-simd128)
