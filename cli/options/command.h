/// What all commands of the program share: the options that every one has, exit codes, and where output goes.
///
/// One command is one file, NAME_command.cpp, with one function that describes it. The contract that scripts
/// depend on (stdout, stderr, exit codes) is in docs/cli.md.
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

/// Where the result goes, and how much is said on the way. Every command has these options.
struct CommonOptions {
  std::string output = "-";
  bool force = false;
  bool quiet = false;

  [[nodiscard]] std::vector<Option> table(bool output_required);
};

/// The options that choose what to read, as io/input.h has them, without those that the command refuses. The table
/// refers to input.
[[nodiscard]] std::vector<Option> input_table(InputOptions& input, const std::vector<RefusedOption>& refused = {});

/// Opens the input that the options name, with a progress bar, and says in the name of the command what a person should
/// know of how it was read (Input::notes()), and what became of curves, which are cut at once.
[[nodiscard]] Result<Input> open_input(const char* command, InputOptions options, Progress& progress);

/// Says what was written to a file, unless --quiet: "-> walk.npz: 5 keyframes".
void say_written(const CommonOptions& common, const std::string& what);

/// The options that choose which normals: --elements, --crease, --no-weld.
struct ElementArguments {
  std::string usual;  ///< the kind where none was asked for
  std::optional<std::string> asked = {};
  double crease_angle = 180;  ///< degrees
  bool no_weld = false;

  [[nodiscard]] std::vector<Option> table();
  [[nodiscard]] std::string kind() const { return asked.value_or(usual); }
  /// What was asked for. Errors: kUsage for a kind that does not exist, and for options that do not go with it.
  [[nodiscard]] Result<ElementOptions> options() const;
};

/// The options of commands that judge stored normals: --weighting, --for, --samples.
struct JudgeArguments {
  std::string weighting;               ///< empty: what the stored base normals follow
  std::string viewers;                 ///< empty: the specification alone
  std::string viewers_by_old_name;     ///< the same by --host, which warns
  std::optional<std::size_t> samples;  ///< of each segment

  /// of_viewers is what the command does with the viewers that are named, for the help.
  [[nodiscard]] std::vector<Option> table(const std::string& of_viewers);
  /// Writes what was asked for; what was not asked for stays. Errors: kUsage for names that do not exist.
  /// Warns in the name of the command where an option has its old name.
  [[nodiscard]] Status read(const char* command, std::optional<Weighting>& to_weighting,
                            std::vector<Viewer>& to_viewers) const;
};

/// Errors: kUsage where viewers are named and the input is no glTF file.
[[nodiscard]] Status check_viewers(const std::vector<Viewer>& viewers, const Input& input);

/// The last part of a path: what a person calls it.
[[nodiscard]] std::string short_name(std::string path);

/// An error of kUsage.
[[nodiscard]] Error misuse(std::string place, std::string message);

// The commands.
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
