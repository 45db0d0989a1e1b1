// chronormal_rigs [--partial | --quick] FOLDER: writes FOLDER/rigs.md (tools/make_rigs). With --quick it leaves out the
// captured face, which takes minutes; with --partial that and the other files, where CHRONORMAL_DATA does not say where
// they are.

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/chronormal_io.h"
#include "made_up_rig.h"
#include "support/other_files.h"
#include "support/page.h"

namespace chronormal::rigs_page {
namespace {

namespace fs = std::filesystem;
using pages::Cells;
using pages::kOtherFiles;
using pages::Page;
using pages::value_of;

// The captured face stands beside the other files.
constexpr const char* kCapture = "rigs/ict_capture.glb";
constexpr std::size_t kSamples = 3;  // of each segment
constexpr std::size_t kExtraTargets[] = {0, 4, 8, 16, 32, 55};

// 0 for what is only rounding.
std::string degrees(double value) { return value < 0.0005 ? "0" : fmt::format("{:.3f}", value); }

std::string three_degrees(double mean, double most, double worst) {
  return fmt::format("{}, {}, {}", degrees(mean), degrees(most), degrees(worst));
}

// A file, what a bake made of it, and what that took.
struct Baked {
  GltfBake report;
  std::string bytes;
  double seconds = 0;  // that passed
  double processor_seconds = 0;
};

Baked baked(const GltfDocument& document, const BakeOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processors_start = std::clock();
  GltfEdit edit(document);
  Baked result;
  result.report = value_of(bake(document, options, edit));
  result.processor_seconds = static_cast<double>(std::clock() - processors_start) / CLOCKS_PER_SEC;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.bytes = value_of(edit.bytes("baked.glb"));
  return result;
}

struct Rows {
  std::vector<Cells> sizes, errors;
};

std::vector<ViewerAudit> judged(const GltfDocument& document) {
  AuditOptions options;
  options.samples = kSamples;
  options.viewers = {kViewers.begin(), kViewers.end()};
  return value_of(audit(document, options)).viewers;
}

void add_rows(const std::string& path, Rows& rows) {
  const std::string name = fmt::format("`{}`", fs::path(path).filename().string());
  const GltfDocument document = value_of(GltfDocument::open(path));
  const Baked after = baked(document, {});
  std::size_t targets = 0;
  std::string chosen;
  for (const BakedMesh& mesh : after.report.meshes) {
    targets += document.meshes()[mesh.mesh].target_count;
    for (const BakedCandidate& choice : mesh.candidates)
      if (choice.chosen) chosen.append(chosen.empty() ? "" : ", ").append(choice.name);
  }
  rows.sizes.push_back({name, chosen, std::to_string(targets), std::to_string(after.report.added_targets),
                        std::to_string(after.report.added_bytes), fmt::format("{:.1f}", after.processor_seconds)});
  const auto add_errors = [&](const char* state, const std::vector<ViewerAudit>& viewers) {
    Cells& line = rows.errors.emplace_back(Cells{name, state});
    for (const ViewerAudit& viewer : viewers)
      line.push_back(three_degrees(viewer.error.mean(), viewer.error.percentile(0.999), viewer.error.worst));
  };
  add_errors("as it is", judged(document));
  add_errors("baked", judged(value_of(GltfDocument::read(std::string_view(after.bytes), path))));
}

// The captured face with so many extra targets, for viewers that add up deltas as they are stored: as it is baked, and
// where nothing but its animation will ever be played.
Cells row_of_curve(const GltfDocument& document, std::size_t extras) {
  Cells row = {std::to_string(extras)};
  for (const bool animations_only : {false, true}) {
    BakeOptions options;
    options.viewers = {kViewers[0]};
    options.most_targets = document.meshes()[0].target_count + extras;
    options.animations_only = animations_only;
    const Baked after = baked(document, options);
    const std::vector<BakedCandidate>& candidates = after.report.meshes.at(0).candidates;
    const auto chosen =
        std::find_if(candidates.begin(), candidates.end(), [](const auto& choice) { return choice.chosen; });
    if (chosen == candidates.end()) throw std::runtime_error("no candidate was chosen");
    const ShownErrors& played = chosen->played;
    row.insert(row.end(), {std::to_string(chosen->bytes), three_degrees(played.mean, played.most, played.worst),
                           fmt::format("{:.0f}", after.seconds)});
  }
  return row;
}

// A row of the table of speed: a file, the options in the words of the command line, what that took before there was a
// choice of candidates, and what it takes now.
Cells row_of_speed(const std::string& file, const std::string& words, const std::string& before,
                   const GltfDocument& document, const BakeOptions& options) {
  const Baked after = baked(document, options);
  return {file,
          words,
          std::to_string(after.report.added_targets),
          before,
          fmt::format("{:.1f}", after.seconds),
          fmt::format("{:.1f}", after.processor_seconds)};
}

std::vector<Cells> rows_of_speed(const GltfDocument& face) {
  BakeOptions exact, for_three;
  exact.encoding = BakeEncoding::kExact;
  for_three.viewers = {kViewers[0]};
  for_three.most_targets = 112;
  std::vector<Cells> rows = {
      row_of_speed("the captured face", "`--encode exact`", "over 300", face, exact),
      row_of_speed("the captured face", "`--for three --max-targets 112`", "", face, for_three),
      row_of_speed("the captured face", "", "", face, {}),
  };
  struct Size {
    MadeUpRig rig;
    const char* before;
  };
  for (const auto& [rig, before] : {Size{{45, 67, 1.4}, "12"}, Size{{45, 124, 1.4}, "46"}, Size{{71, 50, 3}, "10"}}) {
    const std::string file = fmt::format("{} targets of {} vertices", rig.targets, rig.side * rig.side);
    const std::string bytes = made_up_rig_glb(rig);
    const GltfDocument document = value_of(GltfDocument::read(std::string_view(bytes), file));
    rows.push_back(row_of_speed(file, "`--encode exact`", before, document, exact));
    rows.push_back(row_of_speed(file, "", "", document, {}));
  }
  return rows;
}

enum class Extent { kPartial, kQuick, kAll };

std::string files_part(const fs::path& data, Extent extent, const std::string& folder) {
  Rows rows;
  for (const char* const file : kOtherFiles) add_rows((data / file).string(), rows);
  if (extent == Extent::kAll) add_rows((data / kCapture).string(), rows);
  Page files("rigs/files.md.in", folder);
  files.set("samples", std::to_string(kSamples));
  files.table("sizes", {"file", "candidate", "targets", "extra targets", "bytes added", "seconds"}, rows.sizes, 2);
  Cells header = {"file", ""};
  for (const Viewer& viewer : kViewers) header.emplace_back(viewer.title);
  files.table("errors", header, rows.errors, 2);
  return files.markdown();
}

std::string capture_part(const fs::path& data, const std::string& folder) {
  const GltfDocument face = value_of(GltfDocument::open((data / kCapture).string()));
  std::vector<Cells> curve;
  for (const std::size_t extras : kExtraTargets) curve.push_back(row_of_curve(face, extras));
  Page capture("rigs/capture.md.in", folder);
  capture.table(
      "curve",
      {"extra targets", "bytes", "mean, 99.9 %, worst", "s", "bytes, `--animations-only`", "mean, 99.9 %, worst", "s"},
      curve, 0);
  capture.table("speed", {"file", "options", "extra targets", "before, s", "now, s", "now, s of processors"},
                rows_of_speed(face), 0);
  return capture.markdown();
}

void write_page(const std::string& folder, Extent extent) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (extent != Extent::kPartial && data == nullptr)
    throw std::runtime_error("set CHRONORMAL_DATA to the folder of the real data");
  Page page("rigs/rigs.md.in", folder);
  page.set("files", extent == Extent::kPartial ? "" : files_part(data, extent, folder));
  page.set("capture", extent == Extent::kAll ? capture_part(data, folder) : "");
  page.write("rigs.md");
}

}  // namespace
}  // namespace chronormal::rigs_page

int main(int argc, char** argv) {
  using chronormal::rigs_page::Extent;
  const std::string_view option = argc == 3 ? argv[1] : "";
  if (argc != 2 && option != "--partial" && option != "--quick") {
    std::fprintf(stderr, "usage: chronormal_rigs [--partial | --quick] FOLDER\n");
    return 2;
  }
  const Extent extent = argc == 2 ? Extent::kAll : option == "--quick" ? Extent::kQuick : Extent::kPartial;
  return chronormal::pages::run("chronormal_rigs", [&] { chronormal::rigs_page::write_page(argv[argc - 1], extent); });
}
