// chronormal_rigs [--partial | --quick] FOLDER: writes FOLDER/rigs.md (tools/make_rigs). With --quick it leaves out the
// captured face, which takes minutes; with --partial that and the other files, where CHRONORMAL_DATA does not say where
// they are.

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/chronormal.h"
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
constexpr std::size_t kExtraTargets[] = {0, 4, 16, 32, 55};

// 0 for what is only rounding.
std::string degrees(double value) { return value < 0.0005 ? "0" : fmt::format("{:.3f}", value); }

std::string three_degrees(double mean, double most, double worst) {
  return fmt::format("{}, {}, {}", degrees(mean), degrees(most), degrees(worst));
}

// A file, what a bake made of it, and what that took.
struct Baked {
  GltfBake report;
  std::string bytes;
  double seconds = 0;  // of all threads
};

Baked baked(const GltfDocument& document, const BakeOptions& options) {
  const std::clock_t start = std::clock();
  GltfEdit edit(document);
  Baked result;
  result.report = value_of(bake(document, options, edit));
  result.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  result.bytes = value_of(edit.bytes("baked.glb"));
  return result;
}

struct Rows {
  std::vector<Cells> sizes, errors;
};

std::vector<HostAudit> judged(const GltfDocument& document) {
  AuditOptions options;
  options.samples = kSamples;
  options.hosts = {kHosts.begin(), kHosts.end()};
  return value_of(audit(document, options)).hosts;
}

void add_rows(const std::string& path, Rows& rows) {
  const std::string name = fmt::format("`{}`", fs::path(path).filename().string());
  const GltfDocument document = value_of(GltfDocument::open(path));
  const Baked after = baked(document, {});
  std::size_t targets = 0;
  std::string forms;
  for (const BakedMesh& mesh : after.report.meshes) {
    targets += document.meshes()[mesh.mesh].target_count;
    for (const BakeChoice& choice : mesh.choices)
      if (choice.chosen) forms.append(forms.empty() ? "" : ", ").append(choice.form);
  }
  rows.sizes.push_back({name, forms, std::to_string(targets), std::to_string(after.report.added_targets),
                        std::to_string(after.report.added_bytes), fmt::format("{:.1f}", after.seconds)});
  const auto add_errors = [&](const char* state, const std::vector<HostAudit>& hosts) {
    Cells& line = rows.errors.emplace_back(Cells{name, state});
    for (const HostAudit& host : hosts)
      line.push_back(three_degrees(host.error.mean(), host.error.percentile(0.999), host.error.worst));
  };
  add_errors("as it is", judged(document));
  add_errors("baked", judged(value_of(GltfDocument::read(std::string_view(after.bytes), path))));
}

// The captured face with so many extra targets, for hosts that add up deltas as they are stored.
Cells row_of_curve(const GltfDocument& document, std::size_t extras) {
  BakeOptions options;
  options.hosts = {kHosts[0]};
  options.most_targets = document.meshes()[0].target_count + extras;
  const Baked after = baked(document, options);
  for (const BakeChoice& choice : after.report.meshes.at(0).choices)
    if (choice.chosen)
      return {std::to_string(extras),      std::to_string(choice.bytes), degrees(choice.played.mean),
              degrees(choice.played.most), degrees(choice.played.worst), fmt::format("{:.0f}", after.seconds)};
  throw std::runtime_error("no form was chosen");
}

// What --encode exact takes for the captured face, which was the default once.
std::string seconds_of_exact(const GltfDocument& document) {
  BakeOptions options;
  options.encoding = BakeEncoding::kExact;
  return fmt::format("{:.0f}", baked(document, options).seconds);
}

enum class Extent { kPartial, kQuick, kAll };

std::string files_part(const fs::path& data, Extent extent, const std::string& folder) {
  Rows rows;
  for (const char* const file : kOtherFiles) add_rows((data / file).string(), rows);
  if (extent == Extent::kAll) add_rows((data / kCapture).string(), rows);
  Page files("rigs/files.md.in", folder);
  files.set("samples", std::to_string(kSamples));
  files.table("sizes", {"file", "form", "targets", "extra targets", "bytes added", "seconds"}, rows.sizes, 2);
  Cells header = {"file", ""};
  for (const Host& host : kHosts) header.emplace_back(host.title);
  files.table("errors", header, rows.errors, 2);
  return files.markdown();
}

std::string capture_part(const fs::path& data, const std::string& folder) {
  const GltfDocument face = value_of(GltfDocument::open((data / kCapture).string()));
  std::vector<Cells> curve;
  for (const std::size_t extras : kExtraTargets) curve.push_back(row_of_curve(face, extras));
  Page capture("rigs/capture.md.in", folder);
  capture.set("seconds_for_three", curve.back().back());
  capture.set("seconds_of_exact", seconds_of_exact(face));
  capture.table("curve", {"extra targets", "bytes", "mean", "99.9 %", "worst", "seconds"}, curve, 0);
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
