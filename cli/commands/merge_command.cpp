// Defines the command `merge`, which joins the parts that shards have written.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/io/output.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/terminal/print.h"
#include "io/bytes/file.h"
#include "io/cache/npy.h"
#include "workflow/json/parts.h"

namespace chronormal::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  CommonOptions common;
};

Result<int> run(const MergeArguments& options) {
  if (options.parts.empty()) return misuse("", "the shards are missing; name the files that runs with --shard wrote");
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  std::vector<NamedFile> read;
  for (const std::string& path : options.parts)
    if (path != "-") read.push_back({"PART", path});
  if (const Status distinct = check_distinct({{"OUT", options.common.output}}, read); !distinct)
    return distinct.error();
  std::vector<Part> parts;
  for (const std::string& path : options.parts) {
    const Result<FileBytes> file = FileBytes::open(path);
    if (!file) return file.error();
    if (path != "-" && file.value().bytes().starts_with(npy::kFirstWord)) {
      const Status written = merge_arrays(options.parts, options.common.output, options.common.force);
      if (!written) return written.error();
      return kExitDone;
    }
    parts.push_back({short_name(path), std::string(file.value().bytes())});
  }
  const Result<MergedParts> merged = merge_parts(parts);
  if (!merged) return merged.error();
  if (const Status written = print_to(options.common.output, merged.value().json, options.common.force); !written)
    return written.error();
  if (merged.value().is_within) return kExitDone;
  say("merge", "the result is not within the --tolerance with which the shards were made; its JSON has the errors",
      Tone::kError);
  return kExitBeyond;
}

}  // namespace

Command merge_command() {
  auto options = std::make_shared<MergeArguments>();
  return {"merge",
          "Put the shards of compare, audit or sample together",
          {{{"PART", &options->parts, "read these shards, which compare, audit or sample wrote, in any order"}},
           options->common.table(false)},
          "The result has the bytes that a single run would have written: the JSON of compare --json --no-times "
          "or\naudit --json, or the array of sample.\n"
          "\nExamples:\n"
          "  for i in 1 2 3; do chronormal compare walk/ --shard $i/3 -o part_$i.json; done\n"
          "  chronormal merge part_1.json part_2.json part_3.json -o walk.json\n"
          "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input, 4 the tolerance of the shards was exceeded",
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
