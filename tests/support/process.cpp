#include "tests/support/process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace chronormal {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

ProcessResult run_shell(const std::string& command, const std::string& folder, const std::string& input) {
  // Redirects the streams of the process to files, since a process could wait forever to write to a full pipe.
  char name[] = "/tmp/chronormal_process_XXXXXX";
  const std::filesystem::path scratch = mkdtemp(name);
  std::ofstream(scratch / "in", std::ios::binary) << input;
  // Unsets variables of a user's terminal, which must not change the results of tests.
  const std::string line = "unset COLUMNS NO_COLOR CLICOLOR_FORCE; cd '" + folder + "' && ( " + command + " ) <'" +
                           (scratch / "in").string() + "' >'" + (scratch / "out").string() + "' 2>'" +
                           (scratch / "err").string() + "'";
  const int status = std::system(line.c_str());
  ProcessResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = contents(scratch / "out");
  result.err = contents(scratch / "err");
  std::filesystem::remove_all(scratch);
  return result;
}

}  // namespace chronormal
