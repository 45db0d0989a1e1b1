// chronormal_paper FOLDER: writes FOLDER/paper.md and FOLDER/pictures/*.svg (tools/make_paper).

#include <fmt/core.h>

#include <cstdio>
#include <exception>

#include "paper/morphs.h"
#include "paper/sections.h"
#include "support/page.h"

namespace chronormal::paper {
namespace {

void write_head(Page& page, const std::vector<std::vector<std::string>>& statements) {
  page.line("# The paper, measured again\n");
  page.text(
      "What *Temporal Face Normal Interpolation* states, measured on meshes of our own, beside what it prints; "
      "where the two disagree, why. Every figure here that is not the paper's own is computed by the command that "
      "writes this page and its pictures, and a test runs that command and compares:");
  page.line("    tools/make_paper\n");
  page.text(
      "Nothing but the block of times in section 2 changes from run to run. Equations are those of "
      "[theory.md](theory.md).");
  page.line("Contents: [1 Table 1](#1-table-1-quality) · [2 Table 2](#2-table-2-cost) ·");
  page.line("[3 Sequential access](#3-sequential-access) · [4 Figure 2](#4-figure-2-between-the-nodes) ·");
  page.line("[5 Random frames](#5-random-frames-and-the-best-ones) · [6 Slips](#6-slips-the-papers-and-ours)\n");
  page.heading("In short");
  page.table({"the paper states", "we find", "section"}, statements, 0);
  page.text("The morphs (`./run compare --sample NAME`):");
  std::vector<std::vector<std::string>> rows;
  for (const BuiltinMorph& builtin : builtin_morphs())
    rows.push_back({fmt::format("{}", builtin.name), std::string(builtin.summary)});
  page.table({"name", "what moves"}, rows, 0);
}

void write_page(const std::string& folder) {
  Page body(folder), page(folder);
  write_table1(body);
  write_table2(body);
  write_drift(body);
  write_figure2(body);
  write_frames(body);
  write_slips(body);
  write_head(page, body.statements());
  page.append(body);
  std::string markdown = page.markdown();
  while (markdown.ends_with("\n\n")) markdown.pop_back();
  const Status written = write_output(folder + "/paper.md", markdown, true);
  if (!written) throw std::runtime_error(written.error().text());
}

}  // namespace
}  // namespace chronormal::paper

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: chronormal_paper FOLDER\n");
    return 2;
  }
  try {
    chronormal::paper::write_page(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chronormal_paper: %s\n", error.what());
    return 1;
  }
  return 0;
}
