# Adds `bits`, a program of tests that compare results with constants bit by bit. GoogleTest is compiled into it, so it
# runs on a machine of another kind on which nothing is installed. The constants are the same on all machines.
set(gtest /usr/src/googletest/googletest)
add_executable(bits EXCLUDE_FROM_ALL ${gtest}/src/gtest-all.cc ${gtest}/src/gtest_main.cc tests/core/charconv_test.cpp
                    tests/core/portable_math_test.cpp tests/normals/curves/golden_bits_test.cpp)
target_include_directories(bits PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
target_include_directories(bits SYSTEM PRIVATE ${gtest} ${gtest}/include)
target_link_libraries(bits PRIVATE chronormal chronormal_flags)
if(EMSCRIPTEN)
  # The output is a single file. This version of Emscripten would load a second file with fetch(), which Node.js has but
  # which fails there for files.
  target_link_options(bits PRIVATE -sSINGLE_FILE=1 -sALLOW_MEMORY_GROWTH=1 -sTOTAL_STACK=4MB -sEXIT_RUNTIME=1)
else()
  target_link_options(bits PRIVATE -static)
endif()
