# What every target of the project is compiled with.
#
#   -ffp-contract=off                   a * b + c stays two roundings: the same bits from every compiler
#   -fno-math-errno -fno-trapping-math  let sqrt and selects become vector instructions; results do not change
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_FLAGS_RELEASE "-O3")  # without NDEBUG: assertions stay on in the builds that have tests
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(chronormal_flags INTERFACE)
target_compile_options(
  chronormal_flags
  INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
            -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CHRONORMAL_WERROR)
  target_compile_options(chronormal_flags INTERFACE -Werror)
endif()
if(NOT CHRONORMAL_TESTS AND NOT CHRONORMAL_FUZZ AND CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_definitions(chronormal_flags INTERFACE NDEBUG)
endif()
if(CHRONORMAL_SANITIZE)
  target_compile_options(chronormal_flags INTERFACE -fsanitize=${CHRONORMAL_SANITIZE} -fno-sanitize-recover=all
                                                    -fno-omit-frame-pointer)
  target_link_options(chronormal_flags INTERFACE -fsanitize=${CHRONORMAL_SANITIZE})
endif()
if(CHRONORMAL_FUZZ)
  target_compile_options(chronormal_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
