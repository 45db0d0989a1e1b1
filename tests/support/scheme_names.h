/// Lists all schemes by name, so that tests cannot miss a new scheme.
#ifndef CHRONORMAL_TESTS_SUPPORT_SCHEME_NAMES_H_
#define CHRONORMAL_TESTS_SUPPORT_SCHEME_NAMES_H_

#include <string>
#include <vector>

#include "chronormal/schemes/scheme.h"

namespace chronormal::test {

/// Returns names that make_scheme() accepts, at least one for each scheme. A scheme like lagrange:K gets several names,
/// in which numbers replace its parameter.
[[nodiscard]] inline std::vector<std::string> scheme_names() {
  std::vector<std::string> names;
  for (const SchemeDescription& description : scheme_descriptions()) {
    const std::string name(description.name);
    const std::string stem = name.substr(0, name.rfind(':'));
    if (name == "lagrange:K") {
      for (const char* degree : {":1", ":2", ":3", ":5", ":8"}) names.push_back(stem + degree);
    } else if (name == "decasteljau:K") {
      for (const char* count : {":2", ":3", ":4", ":6"}) names.push_back(stem + count);
    } else if (name == "quaternion:random:SEED") {
      for (const char* seed : {":1", ":7"}) names.push_back(stem + seed);
    } else {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_SCHEME_NAMES_H_
