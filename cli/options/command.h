/// The parts that all commands share: their common options, exit codes, and output.
///
/// Each command is one file, NAME_command.cpp, with one function that describes it. The contract that scripts depend on
/// (stdout, stderr, exit codes) is in docs/cli.md.
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

/// The output of a command and its verbosity. Every command has these options.
struct CommonOptions {
  std::string output = "-";
  bool force = false;
  bool quiet = false;

  [[nodiscard]] std::vector<Option> table(bool output_required);
};

/// Returns the table of options that choose the input, as in io/input.h, except those that the command refuses. The
/// options set the members of `input`.
[[nodiscard]] std::vector<Option> input_table(InputOptions& input, const std::vector<RefusedOption>& refused = {});

/// Opens the input that the options name, with a progress bar. Prints, in the name of the command, notes on how it was
/// read (Input::notes()) and on how curves were cut.
[[nodiscard]] Result<Input> open_input(const char* command, InputOptions options, Progress& progress);

/// Prints a message about a written file, unless --quiet: "-> walk.npz: 5 keyframes".
void say_written(const CommonOptions& common, const std::string& what);

/// The options that choose the normals: --elements, --crease, --no-weld.
struct ElementArguments {
  std::string usual;  ///< the default kind
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
  std::string weighting;               ///< empty: as the stored base normals suggest
  std::string viewers;                 ///< empty: only the specification
  std::string viewers_by_old_name;     ///< given by --host, which causes a warning
  std::optional<std::size_t> samples;  ///< samples per segment

  /// Returns the options. `of_viewers` is the help text for the viewers.
  [[nodiscard]] std::vector<Option> table(const std::string& of_viewers);
  /// Writes the requested values to the parameters, and leaves a parameter as it is if its value was not requested.
  /// Errors: kUsage for unknown names. Warns about the old name of an option, in the name of the command.
  [[nodiscard]] Status read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Viewer>& to_viewers) const;
};

/// Checks that viewers are only named for a glTF file. Errors: kUsage.
[[nodiscard]] Status check_viewers(const std::vector<Viewer>& viewers, const Input& input);

/// Returns the last component of a path.
[[nodiscard]] std::string short_name(std::string path);

/// Makes an error of kUsage.
[[nodiscard]] Error misuse(std::string place, std::string message);

// Functions that describe the commands.
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
