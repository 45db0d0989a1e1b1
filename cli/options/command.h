/// Declares the parts that all commands share: their common options, exit codes, and output.
///
/// Each command is one file, NAME_command.cpp, with one function that describes it. The contract on which scripts
/// depend (stdout, stderr, exit codes) is in docs/cli.md.
#ifndef CLI_OPTIONS_COMMAND_H_
#define CLI_OPTIONS_COMMAND_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/paths.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/sample.h"
#include "chronormal/workflow/viewers.h"
#include "cli/options/options.h"
#include "cli/terminal/progress.h"

namespace chronormal::cli {

inline constexpr int kExitDone = 0;
inline constexpr int kExitBeyond = 4;  ///< a tolerance or a limit was exceeded

/// The options that every command has: its output and its verbosity.
struct CommonOptions {
  std::string output = "-";
  bool force = false;
  bool quiet = false;

  [[nodiscard]] std::vector<Option> table(bool output_required);
};

/// Returns the table of the options that set the members of `input` (InputOptions in io/input.h), without the options
/// that the command refuses.
[[nodiscard]] std::vector<Option> input_table(InputOptions& input, const std::vector<RefusedOption>& refused = {});

/// Opens the input that the options name, with a progress bar. Prints notes on how the input was read (Input::notes())
/// and on how curves were cut. The notes begin with the name `command`.
[[nodiscard]] Result<Input> open_input(const char* command, InputOptions options, Progress& progress);

/// Prints a message about a written file, unless --quiet: "-> walk.npz: 5 keyframes".
void say_written(const CommonOptions& common, const std::string& what);

/// The options that choose the elements whose normals are computed: --elements, --crease, --no-weld.
struct ElementArguments {
  std::string usual;  ///< the kind of elements if --elements is not given
  std::optional<std::string> asked = {};
  double crease_angle = 180;  ///< degrees
  bool no_weld = false;

  [[nodiscard]] std::vector<Option> table();
  [[nodiscard]] std::string kind() const { return asked.value_or(usual); }
  /// Returns the requested elements. Errors: kUsage for an unknown kind, and for options that do not fit the kind.
  [[nodiscard]] Result<ElementOptions> options() const;
};

/// The options of commands that judge stored normals: --weighting, --for, --samples.
struct JudgeArguments {
  std::string weighting;               ///< if empty, the stored base normals suggest the weighting
  std::string viewers;                 ///< if empty, normals are judged only as the glTF specification defines them
  std::string viewers_by_old_name;     ///< given by --host, the old name of --for, which causes a warning
  std::optional<std::size_t> samples;  ///< samples per segment

  /// Returns the table of the options --weighting, --for and --samples. `of_viewers` is the help text for --for.
  [[nodiscard]] std::vector<Option> table(const std::string& of_viewers);
  /// Sets to_weighting and to_viewers to the values that the user gave. A parameter stays as it is if its option was
  /// not given. Errors: kUsage for unknown names. Prints a warning in the name of `command` if the old name of an
  /// option was used.
  [[nodiscard]] Status read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Viewer>& to_viewers) const;
};

/// Returns a check that refuses an empty list of viewers.
[[nodiscard]] Check check_viewers_given();

/// Checks that viewers are named only if the input is a glTF file. Errors: kUsage.
[[nodiscard]] Status check_viewers(const std::vector<Viewer>& viewers, const Input& input);

/// Returns the last component of a path.
[[nodiscard]] std::string short_name(std::string path);

/// Returns an error of kUsage; `place` is the option or the file to blame.
[[nodiscard]] Error misuse(std::string place, std::string message);

[[nodiscard]] Command audit_command();
[[nodiscard]] Command bake_command();
[[nodiscard]] Command compare_command();
[[nodiscard]] Command convert_command();
[[nodiscard]] Command inspect_command();
[[nodiscard]] Command merge_command();
[[nodiscard]] Command query_command();
[[nodiscard]] Command report_command();
[[nodiscard]] Command sample_command();

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_COMMAND_H_
