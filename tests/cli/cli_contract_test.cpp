// Tests the behaviour that scripts depend on: exit codes, the text on stdout and stderr, the JSON, and that files are
// written completely or not at all. The tests run the program itself.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "chronormal/io/output.h"
#include "io/cache/npz.h"
#include "tests/support/child_process.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::cli_contract_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Cli : public testing::Test {
 protected:
  Cli() {
    char name[] = "/tmp/chronormal_cli_XXXXXX";
    folder_ = mkdtemp(name);
  }
  ~Cli() override { fs::remove_all(folder_); }

  // Runs `chronormal ARGUMENTS` in the folder of this test.
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " " + arguments, folder_.string(), input);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
    return text.str();
  }
  void write_two_frames() const {
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("b.obj", "v 0 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
  }

  // Returns the names of the commands that the help of the program lists.
  [[nodiscard]] std::vector<std::string> command_names() const {
    std::vector<std::string> commands;
    bool are_listed = false;
    for (const std::string& line : lines_of(run("--help").out)) {
      are_listed = line == "Commands:" || (are_listed && !line.empty());
      if (are_listed && line.starts_with("  ") && !line.starts_with("   "))
        commands.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return commands;
  }

  // Returns the long names of the options that the help of a command lists.
  [[nodiscard]] std::vector<std::string> option_names(const std::string& command,
                                                      const std::string& help = " --help-all") const {
    std::vector<std::string> names;
    for (const std::string& line : lines_of(run(command + help).out)) {
      const std::size_t dashes = line.find("--");
      if (line.starts_with("  -") && dashes != std::string::npos)
        names.push_back(line.substr(dashes, line.find_first_of(" ", dashes) - dashes));
    }
    return names;
  }

  fs::path folder_;
};

void expect_error(const ProcessResult& result, int exit_code, const std::vector<std::string>& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.out, "");
  for (const std::string& word : words)
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
}

TEST_F(Cli, version_and_help_go_to_stdout) {
  const std::string version = std::string("chronormal ") + kVersion, printed = run("--version").out;
  EXPECT_TRUE(printed == version + "\n" || printed == version + " with MPI\n") << printed;
  EXPECT_EQ(run("--version").exit_code, 0);
  const ProcessResult help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  EXPECT_NE(help.out.find("compare"), std::string::npos);
  const ProcessResult compare_help = run("compare --help-all");
  EXPECT_EQ(compare_help.exit_code, 0);
  for (const char* word : {"--schemes", "--json", "quaternion:optimal", "eversion", "Exit codes"})
    EXPECT_NE(compare_help.out.find(word), std::string::npos) << word;
}

TEST_F(Cli, help_fits_the_width_of_the_output) {
  std::vector<std::string> asked = command_names();
  asked.push_back("");
  for (const std::string& command : asked) {
    for (const std::string& line : lines_of(run(command + " --help").out)) EXPECT_LE(line.size(), 80U) << line;
    const std::string all = std::string(kProgram) + ' ' + command + " --help-all";
    const ProcessResult wide = run_shell("COLUMNS=120 " + all, folder_.string());
    const ProcessResult narrow = run_shell("COLUMNS=60 " + all, folder_.string());
    std::size_t longest = 0;
    for (const std::string& line : lines_of(wide.out)) longest = std::max(longest, line.size());
    EXPECT_LE(longest, 120U);
    EXPECT_GT(longest, command.empty() ? 60U : 80U) << command;
    for (const std::string& line : lines_of(narrow.out)) EXPECT_LE(line.size(), 60U) << line;
  }
}

TEST_F(Cli, help_begins_with_what_only_this_command_has) {
  const std::string help = run("help audit").out;
  EXPECT_LT(help.find("--tolerance DEG"), help.find("Options for the input:\n"));
  EXPECT_LT(help.find("Options for the input:\n"), help.find("--fps N"));
  EXPECT_NE(help.find("--for VIEWER,... "), std::string::npos) << "no blank inside of a value's name";
  EXPECT_NE(help.find("-o, --output OUT"), std::string::npos);
  for (const char* const morph : {"cloth  ", "eversion  ", "bumps  "})
    EXPECT_NE(run("help convert").out.find(morph), std::string::npos) << morph;
}

TEST_F(Cli, help_has_a_line_for_what_most_people_need) {
  constexpr std::size_t kMost = 20, kColumns = 100;
  for (const std::string& command : command_names()) {
    SCOPED_TRACE(command);
    const std::vector<std::string> usual = option_names(command, " --help"), all = option_names(command);
    EXPECT_LE(usual.size(), kMost);
    EXPECT_LE(usual.size(), all.size());
    for (const std::string& name : usual) EXPECT_NE(std::find(all.begin(), all.end(), name), all.end()) << name;
    const ProcessResult help =
        run_shell("COLUMNS=" + std::to_string(kColumns) + ' ' + kProgram + ' ' + command + " --help", folder_.string());
    std::size_t rows = 0, lines = 0;
    bool are_options = false;
    for (const std::string& line : lines_of(help.out)) {
      are_options = line.starts_with("Options") || (are_options && !line.empty());
      rows += are_options && line.starts_with("  -") ? 1U : 0U;
      lines += are_options && line.starts_with("  ") ? 1U : 0U;
    }
    EXPECT_EQ(rows, usual.size());
    EXPECT_EQ(lines, rows) << help.out;
  }
}

TEST_F(Cli, help_and_version_have_short_ways) {
  EXPECT_EQ(run("-V").out, run("--version").out);
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_EQ(run("help bake").out, run("bake -h").out);
  for (const char* const option : {"--json", "-h", "--bogus"})
    EXPECT_EQ(run(std::string("help ") + option).out, run("--help").out) << option;
  expect_error(run("help bkae"), 2, {"did you mean bake?"});
}

TEST_F(Cli, a_mistyped_option_is_answered_with_the_nearest) {
  expect_error(run("compare a.obj b.obj --shcemes linear"), 2, {"'--shcemes'; did you mean --schemes?"});
  // The program suggests the nearest option also if a required option is missing, or if the mistyped option has a value
  // after "=".
  expect_error(run("bake --tolerence=3"), 2, {"'--tolerence'; did you mean --tolerance?"});
  expect_error(run("bake -z a.obj"), 2, {"there is no option '-z'"});
  expect_error(run("compare a.obj b.obj --colour-of-the-sky"), 2, {"'--colour-of-the-sky'\n"});
  // If an option takes a value, the next word is the value, even if it looks like an option.
  expect_error(run("compare a.obj b.obj --samples --sample"), 2, {"--samples"});
}

TEST_F(Cli, an_option_that_takes_one_value_is_given_once) {
  for (const char* const twice : {"bake a.glb -o a -o b", "bake a.glb -o a --output=b", "bake a.glb --fps 2 --fps=3"})
    expect_error(run(twice), 2, {": this option is given twice; give it once\n"});
  for (const char* const twice : {"audit a.glb --for three --for godot", "bake a.glb -o b --for three --for=godot"})
    expect_error(run(twice), 2, {"--for: this option is given twice; give it once, with a comma", "as in --for A,B\n"});
  expect_error(run("compare --sample twist --sample bend"), 2, {"--each"});  // a list takes a value each time
}

TEST_F(Cli, completions_and_the_manual_page_name_every_option) {
  const std::string manual = run("--manual-page").out, zsh = run("--completions zsh").out,
                    fish = run("--completions fish").out;
  write("bash", run("--completions bash").out);
  for (const std::string& command : command_names()) {
    std::string script = ". ./bash; COMP_WORDS=(chronormal " + command + " --) COMP_CWORD=2; _chronormal; ";
    const ProcessResult completed =
        run_shell("bash -c '" + script + "printf \"%s\\n\" \"${COMPREPLY[@]}\"'", folder_.string());
    EXPECT_EQ(completed.exit_code, 0) << completed.err;
    const std::vector<std::string> found = lines_of(completed.out), names = option_names(command);
    EXPECT_GE(names.size(), 4U);
    for (const std::string& name : names) {
      EXPECT_NE(std::find(found.begin(), found.end(), name), found.end()) << command << ' ' << name;
      std::string escaped;
      for (const char c : name) escaped += c == '-' ? "\\-" : std::string(1, c);
      EXPECT_NE(manual.find(escaped), std::string::npos) << name;
      if (name.starts_with("--help")) continue;
      EXPECT_NE(zsh.find("'*" + name + "["), std::string::npos) << name;
      EXPECT_NE(fish.find("from " + command + "'"), std::string::npos) << name;
      EXPECT_NE(fish.find(" -l " + name.substr(2)), std::string::npos) << name;
    }
  }
  expect_error(run("--completions powershell"), 2, {"bash, zsh or fish"});
}

TEST_F(Cli, every_command_explains_itself_and_knows_misuse) {
  const std::vector<std::string> commands = command_names();
  EXPECT_GE(commands.size(), 6u);
  for (const std::string& command : commands) {
    SCOPED_TRACE(command);
    const ProcessResult explained = run(command + " --help");
    EXPECT_EQ(explained.exit_code, 0);
    EXPECT_EQ(explained.err, "");
    const char* const input = command == "merge" ? "PART" : "INPUT";
    for (const char* word : {input, "--quiet", "Examples", "Exit codes"})
      EXPECT_NE(explained.out.find(word), std::string::npos) << word;
    expect_error(run(command), 2, {"chronormal " + command + ": ", command + " --help"});
    expect_error(run(command + " x.obj -o y --no-such-option"), 2, {"--no-such-option", command + " --help"});
  }
}

// Names for each option some arguments with which the option is valid. needs_of() adds the arguments that a command
// always needs.
const std::map<std::string, std::string> kUses = {
    {"--access", "a.obj b.obj --access sequential"},
    {"--active", "--base a.obj b.obj --blend 2 --active 1"},
    {"--allow-external", "face.glb --allow-external"},
    {"--animation", "face.glb --animation 0"},
    {"--animations-only", "face.glb --animations-only"},
    {"--base", "--base a.obj b.obj"},
    {"--blend", "--base a.obj b.obj --blend 2"},
    {"--certify", "a.obj b.obj --certify"},
    {"--crease", "a.obj b.obj --elements corners --crease 30"},
    {"bake --crease", "a.obj b.obj --crease 30"},
    {"--csv", "a.obj b.obj --csv"},
    {"--dense-zeros", "face.glb --dense-zeros"},
    {"--drivers", "face.glb --drivers drivers.json"},
    {"--each", "--each --base a.obj b.obj"},
    {"--elements", "a.obj b.obj --elements vertices"},
    {"--encode", "face.glb --encode exact"},
    {"--for", "face.glb --for three"},
    {"--force", "a.obj b.obj --force"},
    {"--format", "a.obj b.obj --format npy"},
    {"--errors", "a.obj b.obj --errors errors.npz"},
    {"--fps", "a.obj b.obj --fps 24"},
    {"--hard-edges", "a.obj b.obj --elements corners --hard-edges groups"},
    {"--help", "--help"},
    {"--help-all", "--help-all"},
    {"--host", "face.glb --host three"},
    {"audit --weights", "face.glb --weights -1:1"},
    {"--json", "a.obj b.obj --json"},
    {"--length", "a.obj b.obj --length area"},
    {"--loop", "a.obj b.obj --loop"},
    {"--max-bytes", "face.glb --max-bytes 100000"},
    {"--max-expansion", "a.obj b.obj --max-expansion 5"},
    {"--max-targets", "face.glb --max-targets 9"},
    {"--no-audit", "face.glb --no-audit"},
    {"--no-times", "a.obj b.obj --no-times"},
    {"--no-weld", "a.obj b.obj --no-weld"},
    {"compare --no-weld", "a.obj b.obj --elements vertices --no-weld"},
    {"--output", "a.obj b.obj"},
    {"--path", "a.obj b.obj --path catmull-rom"},
    {"--plan", "face.glb --plan"},
    {"--poses", "face.glb --poses poses.json"},
    {"--quiet", "a.obj b.obj --quiet"},
    {"merge --force", "part.json --force"},
    {"merge --output", "part.json"},
    {"merge --quiet", "part.json --quiet"},
    {"--strict", "a.obj b.obj --strict"},
    {"query --crease", "facing a.obj b.obj --direction 0,0,1 --elements corners --crease 30"},
    {"query --direction", "facing a.obj b.obj --direction 0,0,1"},
    {"query --elements", "shutter a.obj b.obj --elements vertices"},
    {"query --eye", "facing a.obj b.obj --eye 1,2,3"},
    {"query --points", "contain closed.obj moved.obj --points points.npy"},
    {"query --silhouettes", "facing a.obj b.obj --direction 0,0,1 --silhouettes"},
    {"--every", "a.obj b.obj --every 1"},
    {"--from", "a.obj b.obj --from 0"},
    {"query --from", "collapse a.obj b.obj --from 0.25"},
    {"query --no-weld", "shutter a.obj b.obj --elements vertices --no-weld"},
    {"query --meshlets", "cones a.obj b.obj --meshlets 8"},
    {"--to", "a.obj b.obj --to 1"},
    {"query --to", "collapse a.obj b.obj --to 0.75"},
    {"--recompute-base", "face.glb --recompute-base"},
    {"report --allow-external", "shaded.glb --allow-external"},
    {"report --animation", "shaded.glb --animation 0"},
    {"report --for", "shaded.glb --for three"},
    {"report --host", "shaded.glb --host three"},
    {"report --no-plan", "shaded.glb --no-plan"},
    {"--resume", "a.obj b.obj --resume"},
    {"--rule", "a.obj b.obj --rule slerp"},
    {"--sample", "--sample twist"},
    {"--samples", "a.obj b.obj --samples 3"},
    {"--shard", "a.obj b.obj --shard 1/1"},
    {"--scheme", "a.obj b.obj --scheme linear"},
    {"--schemes", "a.obj b.obj --schemes linear"},
    {"--seed", "--base a.obj b.obj --blend 2 --seed 7"},
    {"--smooth", "face.glb --smooth"},
    {"--step", "a.obj b.obj --scheme linear --step 4"},
    {"--table", "a.obj b.obj --table latex"},
    {"--template", "a.obj b.obj --template page.html"},
    {"--times", "a.obj b.obj --times 0.5"},
    {"--tolerance", "a.obj b.obj --tolerance 1"},
    {"--truth", "a.obj b.obj a.obj --truth 2"},
    {"compare --face", "a.obj b.obj --face 0"},
    {"--weighting", "a.obj b.obj --weighting angle"},
    {"compare --weighting", "a.obj b.obj --elements vertices --weighting inverse-edges"},
    {"--tears", "shaded.glb --tears 9"},
    {"--weights", "--base a.obj b.obj --weights 0.5"},
    {"--world", "face.glb --world"},
};

// Returns the arguments that a command needs besides its input.
std::string needs_of(const std::string& command, const std::string& use) {
  if (use.starts_with("--help")) return "";
  if (command == "bake") return " -o out.glb";
  if (command == "convert") return " -o out.npz";
  if (command == "query") return use.find("--json") != std::string::npos ? " -o out.txt" : " -o out.npz";
  if (command == "report") return use.find("--template") != std::string::npos ? " -o out.html" : " -o out.bin";
  if (command != "sample") return " -o out.txt";
  bool has_moments = false;
  for (const char* const option : {"--times", "--weights", "--step"})
    has_moments = has_moments || use.find(option) != std::string::npos;
  const bool has_weights = use.find("--base") != std::string::npos ||
                           (use.find("face.glb") != std::string::npos && use.find("--animation") == std::string::npos);
  return std::string(" -o out.npy") + (has_moments ? "" : has_weights ? " --weights 0=1" : " --times 0");
}

TEST_F(Cli, an_option_that_help_does_not_list_is_refused) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take half a minute to start so many programs";
  std::map<std::string, std::set<std::string>> listed;
  std::set<std::string> all;
  for (const std::string& command : command_names()) {
    for (const std::string& name : option_names(command)) {
      listed[command].insert(name);
      all.insert(name);
    }
  }
  for (const auto& [command, own] : listed) {
    for (const std::string& name : all) {
      if (own.contains(name)) continue;
      SCOPED_TRACE(command + " " + name);
      expect_error(run(command + " a.obj b.obj -o out " + name), 2, {"there is no option '" + name + "' here"});
    }
  }
}

TEST_F(Cli, every_option_that_help_lists_is_taken) {
  const std::string frame = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 ";
  write("a.obj", frame + "0\ns 1\nf 1 2 3\nf 2 4 3\n");
  write("b.obj", frame + "1\ns 1\nf 1 2 3\nf 2 4 3\n");
  test::GltfBuilder face = test::quad_document();
  face.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  write("face.glb", face.glb());
  test::GltfBuilder shaded = test::hinge().file();
  shaded.add_track(shaded.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  write("shaded.glb", shaded.glb());
  write("closed.obj", frame + "0\nf 1 2 3\nf 3 2 1\n");
  write("moved.obj", frame + "1\nf 1 2 3\nf 3 2 1\n");
  write("points.npy", NpyBytes({1, 3}, std::vector<double>{1, 2, 3}).bytes());
  write("poses.json", "[[1, 1]]");
  write("page.html", "<!--chronormal-data-->");
  ASSERT_EQ(run("compare a.obj b.obj --shard 1/1 -o part.json").exit_code, 0);
  for (const std::string& command : command_names()) {
    for (const std::string& name : option_names(command)) {
      SCOPED_TRACE(command + " " + name);
      const auto special = kUses.find(command + " " + name), usual = kUses.find(name);
      const auto use = special != kUses.end() ? special : usual;
      ASSERT_NE(use, kUses.end()) << "give kUses an input that takes this option";
      // If only one query has an option, the key in kUses names the command and the option, and the arguments name the
      // query: {"query --points", "contain ..."}.
      const std::string question =
          command == "query" && special == kUses.end() && !name.starts_with("--help") ? "collapse " : "";
      const ProcessResult result = run(command + " " + question + use->second + needs_of(command, use->second));
      EXPECT_TRUE(result.exit_code == 0 || (name == "--tolerance" && result.exit_code == 4)) << result.err;
      for (const char* const file :
           {"out.txt", "out.glb", "out.npz", "out.npy", "out.bin", "out.html", "drivers.json", "errors.npz"})
        fs::remove(folder_ / file);
    }
  }
}

TEST_F(Cli, options_of_other_commands_are_refused_with_the_place_to_go) {
  expect_error(run("audit a.glb --each"), 2, {"there is no option '--each' here; this option belongs to compare\n"});
  expect_error(run("bake a.glb --world -o b.glb"), 2,
               {"'--world' here; bake writes normals in the space of each mesh"});
  expect_error(run("bake --base a.obj b.obj"), 2,
               {"'--base' here; bake reads targets only from a glTF file; write the base"});
}

TEST_F(Cli, colours_are_for_terminals) {
  write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const std::string audit = std::string(kProgram) + " audit a.obj b.obj --tolerance 1";
  const auto with = [&](const std::string& environment, const std::string& command) {
    return run_shell(environment + " " + command, folder_.string());
  };
  const ProcessResult piped = with("", audit), forced = with("CLICOLOR_FORCE=1", audit);
  EXPECT_EQ((piped.out + piped.err).find('\033'), std::string::npos);
  EXPECT_NE(forced.out.find("\033[1mFaults:\033[0m\n"), std::string::npos) << forced.out;
  EXPECT_NE(forced.out.find("degrees on average, \033[1;31m90.00\033[0m at worst"), std::string::npos) << forced.out;
  EXPECT_TRUE(forced.err.starts_with("\033[1;31mchronormal audit:\033[0m the worst")) << forced.err;
  EXPECT_EQ(with("CLICOLOR_FORCE=1 NO_COLOR=1", audit).out, piped.out);
  EXPECT_EQ(with("CLICOLOR_FORCE=1", audit + " --json").out, with("", audit + " --json").out);
  EXPECT_EQ(with("CLICOLOR_FORCE=1", audit + " -o table.txt").out, "");
  EXPECT_EQ(read("table.txt"), piped.out);
  // Escape codes that emphasise text in a terminal take up no columns in a table. Names from files are printed without
  // escape codes.
  std::string plain;
  bool is_mark = false;
  for (const char c : forced.out) {
    is_mark = is_mark || c == '\033';
    if (!is_mark) plain += c;
    is_mark = is_mark && c != 'm';
  }
  EXPECT_EQ(plain, piped.out);
  EXPECT_NE(with("CLICOLOR_FORCE=1", std::string(kProgram) + " help audit").out.find("\033[1mOptions:\033[0m\n"),
            std::string::npos);
}

TEST_F(Cli, colours_show_on_a_terminal_that_has_them) {
  if (run_shell("script -qec true /dev/null", "/tmp").exit_code != 0) GTEST_SKIP() << "`script` makes no terminal here";
  write_two_frames();
  const auto shown = [&](const std::string& environment) {
    const std::string command = std::string(kProgram) + " inspect a.obj b.obj";
    return run_shell(environment + " script -qec '" + command + "' /dev/null", folder_.string()).out;
  };
  EXPECT_NE(shown("TERM=xterm").find("\033[1ma.obj ... b.obj\033[0m"), std::string::npos);
  EXPECT_EQ(shown("TERM=dumb").find("\033[1m"), std::string::npos);
  EXPECT_EQ(shown("TERM=xterm NO_COLOR=1").find("\033[1m"), std::string::npos);
}

TEST_F(Cli, tables_fit_the_width_of_the_output_and_lose_nothing) {
  write_two_frames();
  const auto lines_at = [&](const std::string& columns) {
    return lines_of(run_shell("COLUMNS=" + columns + " " + kProgram + " compare a.obj b.obj", folder_.string()).out);
  };
  for (const std::string columns : {"60", "100"})
    for (const std::string& line : lines_at(columns)) EXPECT_LE(line.size(), std::stoul(columns)) << line;
  for (const std::string& line : lines_of(run("compare a.obj b.obj").out)) EXPECT_LE(line.size(), 80U) << line;
  const auto count = [](const std::vector<std::string>& lines, const std::string& word) {
    return std::count_if(lines.begin(), lines.end(), [&](const auto& line) { return line.find(word) != line.npos; });
  };
  const auto wide = lines_at("200"), narrow = lines_at("60");
  EXPECT_EQ(count(wide, "circle:timed "), 1);
  EXPECT_EQ(count(narrow, "circle:timed "), 3) << "each part says again what a row is about";
  for (const char* const title : {"vs linear", "rms", "worst at", "evaluate"}) EXPECT_EQ(count(narrow, title), 1);
  EXPECT_EQ(count(narrow, "worst at"), count(narrow, "   t"))
      << "what has no title of its own stays beside the one before";
}

TEST_F(Cli, a_name_that_is_too_long_stands_above_its_row) {
  const std::string name(70, 'n');
  write(name + ".glb", test::quad_document().glb());
  write("b.glb", test::quad_document().glb());
  const ProcessResult narrow = run("audit " + name + ".glb b.glb"),
                      wide = run_shell("COLUMNS=200 " + std::string(kProgram) + " audit " + name + ".glb b.glb",
                                       folder_.string());
  EXPECT_NE(narrow.out.find("\n" + name + ".glb\n  "), std::string::npos) << narrow.out;
  EXPECT_NE(wide.out.find("\n" + name + ".glb  "), std::string::npos) << wide.out;
  EXPECT_NE(narrow.out.find("\nb.glb  "), std::string::npos) << narrow.out;
}

TEST_F(Cli, what_an_error_quotes_from_a_file_is_safe_to_print) {
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"extensionsUsed":["E"],"extensionsRequired":["\u001b[31mE\n"]})";
  // An unused extension is an error only with --strict. Otherwise, the program prints a note.
  for (const bool strict : {true, false}) {
    const ProcessResult result = run(strict ? "inspect --strict -" : "inspect -", gltf);
    EXPECT_EQ(result.exit_code, strict ? 3 : 0);
    EXPECT_NE(result.err.find("\\x1b[31mE"), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
    EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
  }
}

TEST_F(Cli, wrong_usage_is_exit_2_with_a_hint) {
  write_two_frames();
  expect_error(run(""), 2, {"--help"});
  expect_error(run("frobnicate"), 2, {"no command 'frobnicate'", "compare, convert", "--help"});
  expect_error(run("compare --sample twist a.obj b.obj"), 2, {"--each"});
  expect_error(run("compare"), 2, {"there is no input", "compare --help"});
  expect_error(run("compare --no-such-option"), 2, {"--no-such-option"});
  expect_error(run("inspect - --fps 0"), 2, {"--fps"});
  expect_error(run("compare a.obj b.obj --samples 1"), 2, {"--samples"});
  expect_error(run("compare a.obj b.obj --samples x"), 2, {"--samples"});
  expect_error(run("compare a.obj b.obj --samples 1000001"), 2, {"--samples", "1,000,000"});
  expect_error(run("compare a.obj b.obj --schemes linear,nlerp"), 2, {"nlerp", "quaternion:optimal"});
  expect_error(run("compare a.obj b.obj --schemes ''"), 2, {"--schemes", "empty name"});
  expect_error(run("compare a.obj b.obj --schemes linear,"), 2, {"--schemes", "empty name"});
  // If a value is empty or not a number, the message must complain about the value, not about a missing option.
  for (const char* const option :
       {"audit a.obj --tolerance", "audit a.obj --samples", "audit a.obj --fps", "compare a.obj b.obj --samples",
        "compare a.obj b.obj --blend", "compare a.obj b.obj --crease", "sample a.obj --crease",
        "bake a.obj -o o.glb --max-bytes", "bake a.obj -o o.glb --tolerance"}) {
    for (const char* const value : {"''", "x", "nan", "inf", "1e999"}) {
      const std::string name = std::string(option).substr(std::string(option).rfind("--"));
      expect_error(run(std::string(option) + ' ' + value), 2, {name, "number"});
    }
  }
  expect_error(run("compare a.obj b.obj -o ''"), 2, {"name of the output"});
  expect_error(run("compare --bogus"), 2, {"--bogus", "compare --help"});
  expect_error(run("--bogus"), 2, {"there is no option '--bogus'\n"});
  expect_error(run("-v"), 2, {"there is no option '-v'; did you mean -V?\n"});
  expect_error(run("--versoin"), 2, {"did you mean --version?\n"});
  expect_error(run("--json a.obj"), 2,
               {"the command is missing before option '--json'; write chronormal COMMAND --js"});
  for (const char* const option : {"-q", "--bogus"})
    expect_error(run(std::string(option) + " compare a.obj"), 2, {"' stands before the command; put the option after"});
  expect_error(run("face.glb"), 2, {"missing before 'face.glb'; write 'chronormal audit face.glb', or choose "});
  expect_error(run("."), 2, {"write 'chronormal audit .', or choose another of audit, bake, "});
  expect_error(run("compare a.obj b.obj --schemes lagrange:0"), 2, {"1 to 64"});
  expect_error(run("compare a.obj b.obj --elements edges"), 2, {"--elements"});
  expect_error(run("compare a.obj b.obj --json --csv"), 2, {"--csv"});
  expect_error(run("compare a.obj b.obj --fps 0"), 2, {"frame"});
  expect_error(run("compare --sample teapot"), 2, {"teapot", "twist"});
  expect_error(run("compare --sample twist --sample bend"), 2, {"--each"});
  for (const char* const command : {"convert", "report", "sample --times 0"})
    expect_error(run(std::string(command) + " --sample twist"), 2, {": the output is missing; name it with -o OUT\n"});
  expect_error(run("convert --sample twist -o twist_%d.stl"), 2, {".obj", ".ply"});
}

TEST_F(Cli, a_missing_file_is_exit_1_and_names_it) {
  write_two_frames();
  expect_error(run("compare a.obj missing.obj"), 1, {"missing.obj"});
  expect_error(run("compare 'none_*.obj'"), 1, {"none_*.obj"});
}

TEST_F(Cli, invalid_input_is_exit_3_with_file_line_and_frame) {
  write_two_frames();
  write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n");
  expect_error(run("compare a.obj bad.obj"), 3, {"frame 1", "bad.obj", "line 5", "4"});
  write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_error(run("compare a.obj nan.obj"), 3, {"nan.obj", "line 2"});
  write("other.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
  expect_error(run("compare a.obj other.obj"), 3, {"frame 1", "face 0"});
  expect_error(run("compare a.obj"), 3, {"a.obj"});
  write("text.txt", "hello\n");
  expect_error(run("compare a.obj text.txt"), 3, {"text.txt", "obj", "ply"});
}

TEST_F(Cli, compare_prints_an_aligned_table_and_nothing_else) {
  write_two_frames();
  const ProcessResult result = run("compare a.obj b.obj --no-times");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  std::istringstream lines(result.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "a.obj ... b.obj: 3 vertices, 1 face, 1 segment x 21 samples");
  std::getline(lines, line);
  std::getline(lines, line);
  const std::size_t mean = line.find("average") + 7;
  std::getline(lines, line);
  EXPECT_EQ(line.substr(mean - 7, 7), "degrees");
  int rows = 0;
  while (std::getline(lines, line) && !line.empty()) {
    ++rows;
    EXPECT_NE(line[mean - 1], ' ') << line;
    EXPECT_EQ(line[mean], ' ') << line;
  }
  EXPECT_EQ(rows, 9);
}

TEST_F(Cli, json_is_one_object_as_the_contract_has_it) {
  write_two_frames();
  const ProcessResult result = run("compare a.obj b.obj --json --samples 5");
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["chronormal"], kVersion);
  EXPECT_EQ(json["command"], "compare");
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["input"]["vertices"], 3);
  EXPECT_EQ(json["input"]["faces"], 1);
  EXPECT_EQ(json["input"]["segments"], 1);
  EXPECT_EQ(json["input"]["name"], "a.obj ... b.obj");
  EXPECT_EQ(json["elements"], "faces");
  EXPECT_EQ(json["samples"], 5);
  ASSERT_EQ(json["schemes"].size(), 9u);
  std::vector<std::string> names;
  for (const Json& row : json["schemes"]) {
    names.push_back(row["scheme"]);
    for (const char* key : {"sum_degrees", "relative_to_linear", "mean_degrees", "rms_degrees", "max_degrees",
                            "degenerate", "prepare_ns", "evaluate_ns", "bytes"})
      EXPECT_TRUE(row[key].is_number()) << key;
    for (const char* key : {"segment", "element", "t"}) EXPECT_TRUE(row["max_at"][key].is_number()) << key;
    for (const char* key : {"add", "multiply", "divide", "sqrt", "trigonometric"})
      EXPECT_TRUE(row["operations"][key].is_number_integer()) << key;
    EXPECT_NEAR(row["mean_degrees"].get<double>() * 5, row["sum_degrees"].get<double>(), 1e-9);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"linear", "quadratic", "cubic", "polynomial", "slerp", "decasteljau:4",
                                             "quaternion:matrix", "quaternion:optimal", "circle:timed"}));
  // The largest error of linear interpolation is at t = 1/2. It was computed by hand, as the angle between the
  // interpolated normal, (1, 0, 1), and the exact normal, (1, -1, 1).
  EXPECT_NEAR(json["schemes"][0]["max_degrees"].get<double>(), 35.264389683, 1e-5);
  for (const Json& row : json["schemes"]) EXPECT_EQ(row["missing"], 0);
}

TEST_F(Cli, schemes_are_selected_and_ordered) {
  const Json json = Json::parse(run("compare --sample soup --schemes slerp,linear --samples 3 --json").out);
  ASSERT_EQ(json["schemes"].size(), 2u);
  EXPECT_EQ(json["schemes"][0]["scheme"], "slerp");
  EXPECT_EQ(json["schemes"][1]["scheme"], "linear");
}

TEST_F(Cli, sequential_access_is_nearly_random_access_and_says_who_has_it) {
  const std::string arguments = "compare --sample twist --schemes slerp,circle:timed,polynomial --json --no-times";
  const Json random = Json::parse(run(arguments).out),
             played = Json::parse(run(arguments + " --access sequential").out);
  for (const Json& row : random["schemes"]) EXPECT_EQ(row["access"], "random");
  EXPECT_EQ(played["schemes"][0]["access"], "sequential");
  EXPECT_EQ(played["schemes"][1]["access"], "random");
  EXPECT_EQ(played["schemes"][0]["operations"]["trigonometric"], 0);
  EXPECT_NEAR(played["schemes"][0]["mean_degrees"], random["schemes"][0]["mean_degrees"].get<double>(), 1e-4);
  EXPECT_LT(played["schemes"][2]["max_degrees"], 5e-6 * 57.3);
  EXPECT_NE(run("compare --sample twist --access sequential").out.find("each moment from the one before: linear"),
            std::string::npos);
  expect_error(run("compare --sample twist --access reverse"), 2, {"--access"});
}

TEST_F(Cli, csv_has_a_line_per_scheme_and_as_many_fields_as_the_header) {
  write_two_frames();
  const ProcessResult result = run("compare a.obj b.obj --csv");
  std::istringstream lines(result.out);
  std::string header, line;
  std::getline(lines, header);
  const auto fields = [](const std::string& text) { return std::count(text.begin(), text.end(), ','); };
  EXPECT_TRUE(header.starts_with("input,vertices,faces,segments,elements,samples,scheme,sum_degrees"));
  int rows = 0;
  while (std::getline(lines, line)) {
    EXPECT_EQ(fields(line), fields(header)) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 9);
}

TEST_F(Cli, csv_quotes_a_name_with_a_comma) {
  fs::create_directory(folder_ / "a,b");
  write("a,b/1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("a,b/2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n");
  const std::string out = run("compare 'a,b' --csv --schemes linear").out;
  EXPECT_NE(out.find("\n\"a,b\",3,1,1,faces"), std::string::npos) << out;
}

TEST_F(Cli, each_puts_inputs_side_by_side) {
  write_two_frames();
  fs::create_directory(folder_ / "walk");
  for (const char* frame : {"1", "2", "10"})
    write(std::string("walk/") + frame + ".obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 ") + frame + "\nf 1 2 3\n");
  const ProcessResult table = run("compare --each walk --sample soup --schemes linear,slerp --samples 5");
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_NE(table.out.find("walk: 3 vertices, 1 face, 2 segments"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("soup: 15,000 vertices"), std::string::npos);
  const Json json = Json::parse(run("compare --each walk --sample soup --schemes linear,slerp --samples 5 --json").out);
  ASSERT_EQ(json["inputs"].size(), 2u);
  EXPECT_EQ(json["inputs"][0]["input"]["name"], "walk");
  EXPECT_EQ(json["inputs"][1]["schemes"][1]["scheme"], "slerp");
}

TEST_F(Cli, a_stream_can_be_a_keyframe) {
  write_two_frames();
  const Json files = Json::parse(run("compare a.obj b.obj --json --no-times").out);
  const Json stream = Json::parse(run("compare - b.obj --json --no-times", read("a.obj")).out);
  EXPECT_EQ(files["schemes"], stream["schemes"]);
}

TEST_F(Cli, output_without_times_is_the_same_on_every_run) {
  EXPECT_EQ(run("compare --sample twist --no-times").out, run("compare --sample twist --no-times").out);
  EXPECT_EQ(run("compare --sample twist --no-times --csv").out, run("compare --sample twist --no-times --csv").out);
}

TEST_F(Cli, an_existing_file_is_kept_without_force) {
  write_two_frames();
  write("table.txt", "precious\n");
  expect_error(run("compare a.obj b.obj -o table.txt"), 1, {"table.txt", "--force"});
  EXPECT_EQ(read("table.txt"), "precious\n");
  EXPECT_EQ(run("compare a.obj b.obj -o table.txt --force").exit_code, 0);
  EXPECT_TRUE(read("table.txt").starts_with("a.obj ... b.obj"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 3) << "a temporary file was left behind";
}

TEST_F(Cli, a_full_device_is_an_error) {
  write_two_frames();
  for (const char* arguments : {"compare a.obj b.obj -o /dev/full", "compare a.obj b.obj >/dev/full"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments;
    EXPECT_NE(result.err.find("space"), std::string::npos) << result.err;
  }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Cli, a_folder_that_does_not_exist_is_an_error_before_the_work) {
  expect_error(run("compare --sample soup -o no/such/folder/table.txt"), 1, {"no/such/folder"});
}

TEST_F(Cli, an_error_leaves_no_output_file) {
  write("bad.obj", "v 0 0 0\nf 1 2 3\n");
  EXPECT_EQ(run("compare bad.obj bad.obj -o table.txt").exit_code, 3);
  EXPECT_FALSE(fs::exists(folder_ / "table.txt"));
}

TEST_F(Cli, convert_writes_keyframes_that_compare_reads_back) {
  ASSERT_EQ(run("convert --sample twist -o twist_%d.obj").exit_code, 0);
  ASSERT_EQ(run("convert --sample twist -o twist_%02d.ply").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "twist_1.obj"));
  EXPECT_TRUE(fs::exists(folder_ / "twist_01.ply"));
  const Json direct = Json::parse(run("compare --sample twist --json --no-times").out);
  EXPECT_EQ(direct["schemes"], Json::parse(run("compare 'twist_*.obj' --json --no-times").out)["schemes"]);
  EXPECT_EQ(direct["schemes"], Json::parse(run("compare 'twist_*.ply' --json --no-times").out)["schemes"]);
}

TEST_F(Cli, convert_never_replaces_its_input) {
  for (int k = 0; k < 3; ++k)
    write("f_" + std::to_string(k) + ".obj", "v 0 0 0\nv 1 0 0\nv 0 1 " + std::to_string(k) + "\nf 1 2 3\n");
  ASSERT_EQ(run("convert f_0.obj f_1.obj f_2.obj -o all.npz").exit_code, 0);
  for (const char* arguments : {"f_0.obj f_1.obj f_2.obj --from 1 -o f_%d.obj", ". --from 1 -o f_%d.obj",
                                "all.npz --from 1 -o ./all.npz", "--base f_0.obj f_1.obj -o f_0.obj"}) {
    const std::string mesh = read("f_1.obj"), array = read("all.npz");
    const ProcessResult result = run("convert --force " + std::string(arguments));
    EXPECT_EQ(result.exit_code, 2) << arguments << result.err;
    EXPECT_NE(result.err.find("would overwrite a file that is read (INPUT"), std::string::npos) << result.err;
    EXPECT_EQ(read("f_1.obj"), mesh);
    EXPECT_EQ(read("all.npz"), array);
  }
  EXPECT_EQ(run("convert all.npz --from 1 -o part.npz").exit_code, 0);
}

TEST_F(Cli, options_that_an_input_has_no_use_for_are_refused) {
  write_two_frames();
  ASSERT_EQ(run("convert --base a.obj b.obj -o moving.glb").exit_code, 0);
  for (const char* arguments :
       {"audit moving.glb --fps 24", "inspect moving.glb --fps 24", "bake moving.glb --fps 24 -o o.glb",
        "sample a.obj b.obj --world --times 0 -o n.npy", "compare a.obj b.obj --world",
        "compare --sample twist --world", "bake a.obj b.obj --poses random -o p.glb", "audit moving.glb --tears -1",
        "audit moving.glb --tears 99999999999999999999", "query facing a.obj b.obj --direction 0,0,1 --eye 1,2,3"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "") << arguments;
  }
}

TEST_F(Cli, caches_and_arrays_are_motions_too) {
  ASSERT_EQ(run("convert --sample cloth -o cloth_%d.obj").exit_code, 0);
  const Json direct = Json::parse(run("compare --sample cloth --samples 5 --json --no-times").out);
  for (const char* cache : {"cloth.pc2", "cloth.mdd"}) {
    ASSERT_EQ(run(std::string("convert --sample cloth -o ") + cache).exit_code, 0) << cache;
    const ProcessResult read = run(std::string("compare cloth_0.obj --samples 5 --json --no-times ") + cache);
    ASSERT_EQ(read.exit_code, 0) << read.err;
    EXPECT_EQ(direct["schemes"], Json::parse(read.out)["schemes"]) << cache;
  }
  ASSERT_EQ(run("convert cloth_0.obj cloth.pc2 -o cloth.npz").exit_code, 0);
  EXPECT_EQ(direct["schemes"], Json::parse(run("compare cloth.npz --samples 5 --json --no-times").out)["schemes"]);
  expect_error(run("compare cloth.pc2"), 2, {"cloth.pc2", "mesh"});
  write_two_frames();
  expect_error(run("compare a.obj cloth.pc2"), 3, {"17,822", "3"});
}

TEST_F(Cli, convert_warns_of_times_and_velocities_that_the_format_cannot_store) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto warning_of = [&](const std::string& arguments) {
    const ProcessResult result = run("convert --force " + arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << result.err;
    return result.err.substr(0, result.err.find("-> "));
  };
  for (const char* const name : {"t_0.obj", "t_0.3.obj", "t_1.obj", "e_0.obj", "e_0.25.obj", "e_0.5.obj"})
    write(name, mesh);
  const std::string uneven = warning_of("t_0.obj t_0.3.obj t_1.obj -o out_%d.ply");
  EXPECT_NE(uneven.find("these files hold no times"), std::string::npos) << uneven;
  EXPECT_NE(uneven.find("write .npz to keep their times"), std::string::npos) << uneven;
  EXPECT_EQ(warning_of("t_0.obj t_0.3.obj t_1.obj -o out.npz"), "");
  EXPECT_EQ(warning_of("t_0.obj t_0.3.obj t_1.obj -o out.mdd"), "");
  const std::string even = warning_of("e_0.obj e_0.25.obj e_0.5.obj -o out_%d.obj");
  EXPECT_NE(even.find("read them with --fps 4, or write .npz"), std::string::npos) << even;
  EXPECT_EQ(warning_of("'out_*.obj' -o again_%d.obj"), "") << "the keyframes are 1 s apart";
  EXPECT_EQ(warning_of("--base t_0.obj t_1.obj -o targets_%d.obj"), "") << "targets have no times";

  const int seed = 20261128;
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  for (int i = 0; i < 10; ++i) {
    const std::size_t rate = std::uniform_int_distribution<std::size_t>(2, 240)(random);
    const std::string fps = "--fps " + std::to_string(rate);
    const std::string warned = warning_of(fps + " 'out_*.obj' -o rate_%d.obj");
    EXPECT_NE(warned.find("read them with " + fps + ","), std::string::npos) << warned;
  }

  Motion jumping;
  jumping.topology = Topology::triangles(3, {0, 1, 2}).value();
  for (const double time : {0.0, 0.0, 1.0}) jumping.keyframes.push_back({{0, 0, 0, 1, 0, 0, 0, 1, 0}, time, ""});
  jumping.connect(MotionKind::kAnimation);
  ASSERT_TRUE(write_motion(jumping, (folder_ / "jump.npz").string(), false));
  const std::string jump = warning_of("jump.npz -o out_%d.obj");
  EXPECT_NE(jump.find("write .npz to keep the jumps"), std::string::npos) << jump;
  EXPECT_EQ(warning_of("jump.npz -o again.npz"), "");

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty float vx\nproperty float vy\nproperty float vz\nelement face 1\nproperty list "
      "uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";
  fs::create_directory(folder_ / "moving");
  for (const char* const name : {"moving/m_0.ply", "moving/m_1.ply"}) write(name, ply);
  EXPECT_EQ(warning_of("moving -o moving.npz"), "");
  for (const char* const output : {"out_%d.ply", "out.pc2", "out.mdd"}) {
    const std::string lost = warning_of(std::string("moving.npz -o ") + output);
    EXPECT_NE(lost.find("this format holds no velocities"), std::string::npos) << output << lost;
  }
}

TEST_F(Cli, a_missing_buffer_is_reported_once) {
  test::GltfBuilder face = test::quad_document();
  face.add_track(face.add_animation("wave"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  Json document = Json::parse(face.gltf());
  document["buffers"][0]["uri"] = "none.bin";
  write("face.gltf", document.dump());
  for (const char* const command : {"audit", "inspect", "compare", "bake -o o.glb", "query collapse"}) {
    const ProcessResult result = run(std::string(command) + " face.gltf");
    EXPECT_EQ(result.exit_code, 3) << command;
    EXPECT_EQ(lines_of(result.err).size(), 1U) << result.err;
    EXPECT_NE(result.err.find("this file is missing"), std::string::npos) << result.err;
  }
}

TEST_F(Cli, convert_takes_a_single_mesh) {
  write_two_frames();
  ASSERT_EQ(run("convert a.obj -o a.ply").exit_code, 0);
  ASSERT_EQ(run("convert a.ply -o again.obj").exit_code, 0);
  EXPECT_EQ(read("again.obj"), read("a.obj"));
  expect_error(run("convert missing.obj -o x.ply"), 1, {"missing.obj"});
  for (const char* const format : {".npz", ".pc2", ".mdd"})
    expect_error(run(std::string("convert a.obj -o x") + format), 2, {format, "; write .obj or .ply instead\n"});
}

TEST_F(Cli, a_face_that_shrinks_is_right_in_sequence_too) {
  write("n0.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("n1.obj", "v 0 0 0\nv 0.0001220703125 0 0\nv 0 0.0001220703125 0\nf 1 2 3\n");
  const Json json =
      Json::parse(run("compare n0.obj n1.obj --schemes linear,polynomial --access sequential --samples 33 --json").out);
  for (const Json& row : json["schemes"]) {
    EXPECT_LT(row["max_degrees"].get<double>(), 1e-4);
    EXPECT_EQ(row["missing"], 0);
    EXPECT_TRUE(row["relative_to_linear"].is_null());  // the error of "linear" itself is only rounding error
  }
}

TEST_F(Cli, each_keeps_the_notes_and_names_the_motion_that_failed) {
  const ProcessResult notes = run("compare --each --sample soup --sample twist --schemes polynomial --samples 3");
  EXPECT_NE(notes.out.find("soup: polynomial: "), std::string::npos) << notes.out;
  write_two_frames();
  fs::create_directory(folder_ / "walk");
  write("walk/1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("walk/2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  expect_error(run("compare --each walk/ --sample twist"), 3, {"walk/", "frame 1", "2.obj", "line 4"});
}

// A command that takes longer than the delay after which a progress bar is shown.
constexpr const char* kSecondOfWork = "compare --sample eversion --schemes linear:scaled --samples 31";

TEST_F(Cli, progress_stays_off_when_stderr_is_no_terminal) { EXPECT_EQ(run(kSecondOfWork).err, ""); }

TEST_F(Cli, progress_shows_on_a_terminal_and_goes_away) {
  if (run_shell("script -qec true /dev/null", "/tmp").exit_code != 0) GTEST_SKIP() << "`script` makes no terminal here";
  const std::string command = std::string(kProgram) + " " + kSecondOfWork;
  const ProcessResult shown = run_shell("script -qec '" + command + "' /dev/null", folder_.string());
  EXPECT_NE(shown.out.find("comparing ["), std::string::npos);
  EXPECT_NE(shown.out.find("\033[K"), std::string::npos);
  const ProcessResult quiet = run_shell("script -qec '" + command + " --quiet' /dev/null", folder_.string());
  EXPECT_EQ(quiet.out.find("comparing ["), std::string::npos);
}

TEST_F(Cli, long_work_shows_on_a_terminal_its_pace_and_the_time_that_is_left) {
  if (run_shell("script -qec true /dev/null", "/tmp").exit_code != 0) GTEST_SKIP() << "`script` makes no terminal here";
  const std::string command = "timeout -s INT 3 " + std::string(kProgram) +
                              " sample --sample twist --times 0:0.000002:1 --format npy -o /dev/null";
  const std::string shown = run_shell("script -qec '" + command + "' /dev/null", folder_.string()).out;
  const std::size_t pace = shown.find(" times/s, ");
  ASSERT_NE(pace, std::string::npos) << shown;
  const std::size_t begin = shown.rfind('\r', pace), end = shown.find("\033[K", pace);
  const std::string line = shown.substr(begin + 1, end - begin - 1);
  EXPECT_TRUE(line.starts_with("sampling [") && line.ends_with(" left")) << line;
  EXPECT_LE(line.size(), 80U) << line;
  // At the printed rate, the remaining samples take the printed time. The difference must be no larger than the
  // rounding of both printed numbers allows.
  const double rate = std::stod(line.substr(line.find("%, ") + 3));
  double seconds = 0;
  for (std::size_t at = line.find("/s, ") + 4; line.compare(at, 4, "left") != 0;) {
    const std::size_t blank = line.find(' ', at), next = line.find(' ', blank + 1);
    const std::string unit = line.substr(blank + 1, next - blank - 1);
    seconds += std::stod(line.substr(at)) * (unit == "h" ? 3600 : unit == "min" ? 60 : 1);
    at = next + 1;
  }
  EXPECT_GT(rate, 0);
  EXPECT_NEAR(rate * seconds, 5e5, 0.5e5) << line;
}

}  // namespace
}  // namespace chronormal::cli_contract_test
