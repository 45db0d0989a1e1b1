// chronormal_viewers [--partial] FOLDER: writes FOLDER/viewers.md (tools/make_viewers). With --partial it leaves out the
// files where CHRONORMAL_DATA does not say where they are.

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/chronormal_io.h"
#include "support/other_files.h"
#include "support/page.h"

namespace chronormal::viewers_page {
namespace {

namespace fs = std::filesystem;
using pages::Cells;
using pages::kOtherFiles;
using pages::Page;
using pages::value_of;

constexpr std::size_t kSamples = 5;  // of each segment

// 0 for what is only rounding, and two decimals.
std::string degrees(double value) { return value < 0.005 ? "0" : fmt::format("{:.2f}", value); }

// One file in one state: a row of each table.
struct Row {
  std::string file, state;
  std::vector<ViewerAudit> viewers;
};

Row judged(std::string file, std::string state, const GltfDocument& document) {
  AuditOptions options;
  options.samples = kSamples;
  options.viewers = {kViewers.begin(), kViewers.end()};
  return {std::move(file), std::move(state), value_of(audit(document, options)).viewers};
}

// As exported, as it is baked by default, and by each other encoding of files.
void add_rows(const std::string& path, std::vector<Row>& rows) {
  const std::string name = fmt::format("`{}`", fs::path(path).filename().string());
  const GltfDocument document = value_of(GltfDocument::open(path));
  rows.push_back(judged(name, "as it is", document));
  for (const BakeEncodingName& encoding : kBakeEncodings) {
    if (encoding.encoding == BakeEncoding::kKeys) continue;  // of sequences
    GltfEdit edit(document);
    BakeOptions options;
    options.encoding = encoding.encoding;
    value_of(bake(document, options, edit));
    const std::string bytes = value_of(edit.bytes("baked.glb"));
    const GltfDocument baked = value_of(GltfDocument::read(std::string_view(bytes), path));
    rows.push_back(judged(
        name, encoding.encoding == BakeEncoding::kSmallest ? "by default" : fmt::format("`{}`", encoding.name), baked));
  }
}

void set_tables(Page& page, const std::vector<Row>& rows) {
  struct Figure {
    const char* name;
    double (*of)(const ViewerAudit& viewer);
  };
  constexpr Figure kFigures[] = {
      {"means", [](const ViewerAudit& viewer) { return viewer.error.mean(); }},
      {"nearly_all", [](const ViewerAudit& viewer) { return viewer.error.percentile(0.999); }},
      {"displaced", [](const ViewerAudit& viewer) { return 100 * viewer.displaced; }},
  };
  Cells header = {"file", ""};
  for (const Viewer& viewer : kViewers) header.emplace_back(viewer.title);
  for (const Figure& figure : kFigures) {
    std::vector<Cells> cells;
    for (const Row& row : rows) {
      Cells& line = cells.emplace_back(Cells{row.file, row.state});
      for (const ViewerAudit& viewer : row.viewers) line.push_back(degrees(figure.of(viewer)));
    }
    page.table(figure.name, header, cells);
  }
}

// The table of kViewers.
void set_viewers(Page& page) {
  std::vector<Cells> rows;
  for (const Viewer& viewer : kViewers)
    rows.push_back({fmt::format("`{}`", viewer.name), std::string(viewer.title), std::string(viewer.source)});
  page.table("sources", {"name", "viewer", "source"}, rows, 0);
}

void write_page(const std::string& folder, bool partial) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (!partial && data == nullptr) throw std::runtime_error("set CHRONORMAL_DATA to the folder of the real data");
  Page page("viewers/viewers.md.in", folder);
  set_viewers(page);
  std::string part;
  if (data != nullptr) {
    std::vector<Row> rows;
    for (const char* const file : kOtherFiles) add_rows((fs::path(data) / file).string(), rows);
    Page files("viewers/files.md.in", folder);
    files.set("samples", std::to_string(kSamples));
    set_tables(files, rows);
    part = files.markdown();
  }
  page.set("files", part);
  page.write("viewers.md");
}

}  // namespace
}  // namespace chronormal::viewers_page

int main(int argc, char** argv) {
  const bool partial = argc == 3 && std::string_view(argv[1]) == "--partial";
  if (argc != (partial ? 3 : 2)) {
    std::fprintf(stderr, "usage: chronormal_viewers [--partial] FOLDER\n");
    return 2;
  }
  return chronormal::pages::run("chronormal_viewers",
                                [&] { chronormal::viewers_page::write_page(argv[argc - 1], partial); });
}
