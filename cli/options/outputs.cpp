#include "cli/options/outputs.h"

#include <map>
#include <utility>

#include "cli/options/command.h"
#include "cli/terminal/format.h"
#include "cli/terminal/text.h"
#include "io/input/sequence.h"
#include "io/system/files.h"

namespace chronormal::cli {

std::vector<NamedFile> input_files(const InputOptions& input) {
  std::vector<std::string> paths = input.files;
  const Result<std::vector<std::string>> gltf = find_gltf_files(input.files);
  if (gltf && !gltf.value().empty()) {
    paths = gltf.value();
  } else if (const Result<std::vector<std::string>> frames = find_frames(input)) {
    paths.insert(paths.end(), frames.value().begin(), frames.value().end());
  }
  if (!input.base.empty()) paths.push_back(input.base);
  std::vector<NamedFile> files;
  for (std::string& path : paths)
    if (path != "-") files.push_back({"INPUT", std::move(path)});
  return files;
}

Status check_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& read) {
  std::map<FileKey, const NamedFile*> files_read, written;
  for (const NamedFile& file : read)
    if (const auto key = key_of_file(file.path)) files_read.emplace(*key, &file);
  for (const NamedFile& output : outputs) {
    const auto key = key_of_file(output.path);
    if (!key) continue;
    if (const auto found = files_read.find(*key); found != files_read.end())
      return misuse(output.option,
                    formatted("this file would overwrite a file that is read ({}, {}); choose another name",
                              found->second->option, printable(found->second->path)));
    if (const auto [found, is_new] = written.emplace(*key, &output); !is_new)
      return misuse(output.option,
                    formatted("this file is named twice, also for {}; choose another name", found->second->option));
  }
  return Success{};
}

}  // namespace chronormal::cli
