/// Checks that no file that a command writes replaces another output or an input, even if the same file has different
/// names.
#ifndef CLI_OPTIONS_OUTPUTS_H_
#define CLI_OPTIONS_OUTPUTS_H_

#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"

namespace chronormal::cli {

/// A file with the option that names it, for messages.
struct NamedFile {
  std::string option;
  std::string path;
};

/// Lists the files of an input that can be found without opening the input. Files that cannot be found are ignored
/// here, and reported when the input is opened.
[[nodiscard]] std::vector<NamedFile> input_files(const InputOptions& input);

/// Checks that each output differs from all earlier outputs and from all inputs. The name "-" is the standard output,
/// which may be a file as well. Errors: kUsage, with the option of the output as the place.
[[nodiscard]] Status check_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& read);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_OUTPUTS_H_
