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
