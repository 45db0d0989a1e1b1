/// Reads whole motions for tests, given names of files or options.
#ifndef TESTS_SUPPORT_READ_INPUT_H_
#define TESTS_SUPPORT_READ_INPUT_H_

#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"

namespace chronormal::test {

/// Opens an input and returns its motion, with all keyframes in memory.
[[nodiscard]] inline Result<Motion> read_motion(const InputOptions& options) {
  Result<Input> input = open_input(options);
  if (!input) return input.error();
  const Result<const Motion*> motion = input.value().motion();
  if (!motion) return motion.error();
  return *motion.value();
}

[[nodiscard]] inline InputOptions files(std::vector<std::string> names, double frames_per_second = 1) {
  InputOptions options;
  options.files = std::move(names);
  options.frames_per_second = frames_per_second;
  return options;
}

/// Returns the options that open the file `base` as a base mesh, and the files `names` as its morph targets.
[[nodiscard]] inline InputOptions targets_over(std::string base, std::vector<std::string> names) {
  InputOptions options = files(std::move(names));
  options.base = std::move(base);
  return options;
}

}  // namespace chronormal::test

#endif  // TESTS_SUPPORT_READ_INPUT_H_
