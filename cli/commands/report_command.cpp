#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/viewers.h"
#include "cli/commands/built_in_page.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/reports/report_report.h"
#include "cli/terminal/print.h"
#include "io/bytes/extension.h"
#include "io/bytes/file.h"
#include "io/system/names.h"
#include "workflow/report/report.h"

namespace chronormal::cli {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  InputOptions input;
  CommonOptions common;
  JudgeArguments judge;
  std::optional<std::string> page_template;
  bool no_plan = false;
  bool json = false;
};

bool is_container(const ReportArguments& options) { return lower_extension(options.common.output) == ".bin"; }

// Returns the path at which the template of the page is installed with the program: PREFIX/share/chronormal/report.html
// for PREFIX/bin/chronormal. Returns nothing if the system does not know where the program is.
std::optional<std::string> usual_template() {
  const std::optional<std::string> program = file_of_program();
  if (!program) return std::nullopt;
  return utf8_of(path_of(*program).parent_path().parent_path() / "share" / "chronormal" / "report.html");
}

// Reads the template of the page: the file that --template names, or else the built-in template, or else the template
// that is installed with the program. Runs before any computation, so that no work is lost if the template cannot be
// read.
Result<std::string> read_template(const ReportArguments& options) {
  if (!options.page_template && !built_in_page().empty()) return std::string(built_in_page());
  const std::optional<std::string> path = options.page_template ? options.page_template : usual_template();
  std::error_code failed;
  if (!options.page_template && (!path || !fs::exists(path_of(*path), failed)))
    return Error{ErrorCode::kFailed, path.value_or("report.html"),
                 "the template of the page is missing; make it with ./run report in the source folder of chronormal, "
                 "or name another template with --template"};
  const Result<FileBytes> file = FileBytes::open(*path);
  if (!file) return file.error();
  if (const Status status = check_report_template(file.value().bytes()); !status)
    return invalid_input(*path, status.error().message);
  return std::string(file.value().bytes());
}

Result<ReportOptions> understand(const ReportArguments& options, Progress& progress) {
  ReportOptions how;
  if (const Status named = options.judge.read("report", how.weighting, how.viewers); !named) return named.error();
  if (const Status status = check_input(options.input); !status) return status.error();
  if (!is_container(options) && lower_extension(options.common.output) != ".html")
    return misuse(options.common.output, "the name of the output must end in .html, or in .bin for the data alone");
  if (is_container(options) && options.page_template)
    return misuse("--template", "--template is only for pages, and OUT.bin is data; leave --template out");
  how.samples = options.judge.samples;
  how.animation = options.input.animation;
  how.plan = !options.no_plan;
  how.progress = [&progress](std::string_view what, std::size_t done, std::size_t total) {
    if (const auto tell = progress.callback(std::string(what))) tell(done, total);
  };
  return how;
}

Result<int> run(const ReportArguments& options) {
  Progress progress(options.common.quiet);
  Result<ReportOptions> how = understand(options, progress);
  if (!how) return how.error();
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  std::vector<NamedFile> files_read = input_files(options.input);
  if (options.page_template) files_read.push_back({"--template", *options.page_template});
  const Status distinct = check_distinct({{"OUT", options.common.output}, {"standard output", "-"}}, files_read);
  if (!distinct) return distinct.error();
  std::string page_template;
  if (!is_container(options)) {
    Result<std::string> read = read_template(options);
    if (!read) return read.error();
    page_template = std::move(read).value();
    how.value().template_bytes = page_template.size();
  }
  InputOptions wanted = options.input;
  wanted.shading = KeepShading::kAll;
  Result<Input> input = open_input("report", std::move(wanted), progress);
  if (!input) return input.error();
  if (const Status known = check_viewers(how.value().viewers, input.value()); !known) return known.error();
  const Result<Report> found = report(input.value(), how.value());
  progress.clear();
  if (!found) return found.error();
  std::string page;
  if (!is_container(options)) {
    Result<std::string> filled = report_page(found.value(), page_template);
    if (!filled) return filled.error();
    page = std::move(filled).value();
  }
  const std::string& bytes = is_container(options) ? found.value().container : page;
  if (const Status written = write_output(options.common.output, bytes, options.common.force); !written)
    return written.error();
  const std::string text = options.json ? report_json(found.value(), options.common.output, bytes.size())
                                        : report_text(found.value(), options.common.output, bytes.size());
  if (const Status printed = print(text); !printed) return printed.error();
  return kExitDone;
}

}  // namespace

Command report_command() {
  auto options = std::make_shared<ReportArguments>();
  const std::vector<RefusedOption> refused = {{"--world",
                                               "errors do not depend on where nodes put a mesh, so report shows each "
                                               "mesh in its own space; leave --world out"}};
  return {
      "report",
      "Make a web page that compares your model with correct shading",
      {input_table(options->input, refused),
       options->judge.table("also show the normals that these viewers render"),
       {{"--no-plan", &options->no_plan,
         "do not compute what bake could do, to save time\nThis only has an effect on a glTF file"},
        {"--template FILE",
         &options->page_template,
         "use this page as the template of the report\nThe default is the template that comes with the program",
         {.check = check_given("the name of the template is empty; give the name of a file, or leave --template out"),
          .rare = true}},
        {"--json", &options->json, "print the result as JSON, for programs"}},
       options->common.table(true)},
      "OUT.html is a single page that needs no network: the mesh, its errors in colours, a slider over the motion, "
      "and\na list of the worst places. It stays below 30 MB, and says what was left out for that. OUT.bin has the "
      "data\nalone (docs/formats.md).\n"
      "\nExamples:\n"
      "  chronormal report face.glb -o face.html\n"
      "  chronormal report face.glb -o face.html --for three,godot --no-plan\n"
      "  chronormal report walk/ -o walk.html\n"
      "  chronormal report --base face.obj smile.obj frown.obj -o face.html\n"
      "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input",
      [options] { return run(*options); },
      refused};
}

}  // namespace chronormal::cli
