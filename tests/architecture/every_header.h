/// Declares what every_header.cpp.in defines, for every_header_test.cpp.
#ifndef CHRONORMAL_TESTS_ARCHITECTURE_EVERY_HEADER_H_
#define CHRONORMAL_TESTS_ARCHITECTURE_EVERY_HEADER_H_

#include <cstddef>

namespace chronormal {

/// The number of headers that every_header.cpp includes.
extern const std::size_t kEveryHeaderCount;

}  // namespace chronormal

#endif  // CHRONORMAL_TESTS_ARCHITECTURE_EVERY_HEADER_H_
