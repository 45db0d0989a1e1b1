/// What all commands of the program share: the options that every one has, exit codes, and where output goes.
///
/// One command is one file, NAME_command.cpp, with one function that describes it. The contract that scripts
/// depend on (stdout, stderr, exit codes) is in docs/cli.md.
#ifndef CLI_COMMAND_H_
#define CLI_COMMAND_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/motion_files.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/elements.h"
#include "cli/options.h"
#include "cli/progress.h"

namespace chronormal::cli {

inline constexpr int kExitDone = 0;

/// Where the result goes, and how much is said on the way. Every command has these options.
struct CommonOptions {
  std::string output = "-";
  bool force = false;
  bool quiet = false;

  [[nodiscard]] std::vector<Option> table(bool output_required);
};

/// The options that choose what to read.
struct InputOptions {
  std::vector<std::string> files;    ///< files, patterns, folders or "-": one sequence, or the targets of a base
  std::vector<std::string> samples;  ///< built-in morphs
  double frames_per_second = 1;
  std::string base;       ///< the mesh of which files are morph targets; empty where there is none
  std::string animation;  ///< of a glTF file; empty: its morph targets
  bool allow_external = false;
  bool world = false;  ///< vertices of a glTF file are where its nodes put them

  [[nodiscard]] MotionOptions motion_options() const { return {frames_per_second, animation, allow_external, world}; }

  [[nodiscard]] std::vector<Option> table();
};

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

struct NamedMotion {
  std::string name;
  Motion motion;
};

/// The last part of a path: what a person calls it.
[[nodiscard]] std::string short_name(std::string path);

/// What to call the files: the name of the only one, or "first ... last".
[[nodiscard]] std::string name_of_files(const std::vector<std::string>& files);

/// Whether the options go together, before anything is opened. Errors: kUsage.
[[nodiscard]] Status check_input(const InputOptions& options);

/// Reads what the options name, which must be one input: files or one built-in morph. Checks them first.
/// A base with its targets has the name of the base.
[[nodiscard]] Result<NamedMotion> read_input(const InputOptions& options, Progress& progress);

/// The same, but a mesh that does not move is taken as well: a keyframe without segments.
[[nodiscard]] Result<NamedMotion> read_input_or_mesh(const InputOptions& options, Progress& progress);

/// An error of kUsage.
[[nodiscard]] Error misuse(std::string place, std::string message);

// The commands.
[[nodiscard]] Command audit_command();
[[nodiscard]] Command bake_command();
[[nodiscard]] Command compare_command();
[[nodiscard]] Command convert_command();
[[nodiscard]] Command inspect_command();
[[nodiscard]] Command sample_command();

}  // namespace chronormal::cli

#endif  // CLI_COMMAND_H_
