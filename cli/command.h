/// What all commands of the program share: the options that every one has, exit codes, and where output goes.
///
/// One command is one file, NAME_command.cpp, with one function that adds it to the program. The contract that scripts
/// depend on (stdout, stderr, exit codes) is in docs/cli.md.
#ifndef CLI_COMMAND_H_
#define CLI_COMMAND_H_

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "cli/progress.h"

namespace chronormal::cli {

inline constexpr int kExitDone = 0;

/// Where the result goes, and how much is said on the way. Every command has these options.
struct CommonOptions {
  std::string output = "-";
  bool force = false;
  bool quiet = false;

  void add_to(CLI::App& command, bool output_required);
};

/// The options that choose what to read.
struct InputOptions {
  std::vector<std::string> files;    ///< files, patterns, folders or "-": one sequence
  std::vector<std::string> samples;  ///< built-in morphs
  double frames_per_second = 1;

  void add_to(CLI::App& command);
};

struct NamedMotion {
  std::string name;
  Motion motion;
};

/// The last part of a path: what a person calls it.
[[nodiscard]] std::string short_name(std::string path);

/// Reads one sequence of files. The name is that of the only input, or "first ... last".
[[nodiscard]] Result<NamedMotion> read_files(const std::vector<std::string>& files, double frames_per_second,
                                             Progress& progress);

/// Reads what the options name, which must be one input: files or one built-in morph.
[[nodiscard]] Result<NamedMotion> read_input(const InputOptions& options, Progress& progress);

/// Prints an error to stderr, as "chronormal COMMAND: place: message", and returns its exit code.
int report(const std::string& command, const Error& error);

// The commands. Each adds itself to the program and writes its exit code there when it has run.
void add_compare_command(CLI::App& program, int& exit_code);
void add_convert_command(CLI::App& program, int& exit_code);

}  // namespace chronormal::cli

#endif  // CLI_COMMAND_H_
