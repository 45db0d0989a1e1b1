# The wasm build.
add_compile_options(-fwasm-exceptions)
add_link_options(-fwasm-exceptions)
include(cmake/sources.cmake)
# This version of Highway has no vectors of float64 for wasm, so that its own plain loops are what is compiled, and without
# SIMD128, which any runtime of wasm can do without.
target_compile_definitions(hwy PUBLIC HWY_COMPILE_ONLY_EMU128)
