// chronormal_paper FOLDER: writes FOLDER/paper.md and FOLDER/pictures/*.svg (tools/make_paper).

#include <cstdio>
#include <string>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

void write_page(const std::string& folder) {
  Page page("paper/paper.md.in", folder);
  std::vector<Cells> rows;
  for (const BuiltinMorph& builtin : builtin_morphs())
    rows.push_back({std::string(builtin.name), std::string(builtin.summary)});
  page.table("morphs", {"name", "what moves"}, rows, 0);
  measure_table1(page);
  measure_table2(page);
  measure_drift(page);
  measure_figure2(page);
  measure_frames(page);
  measure_slips(page);
  draw_sketches(page);
  page.write("paper.md");
}

}  // namespace
}  // namespace chronormal::paper

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: chronormal_paper FOLDER\n");
    return 2;
  }
  return chronormal::pages::run("chronormal_paper", [&] { chronormal::paper::write_page(argv[1]); });
}
