// chronormal_weightings [--partial] FOLDER: writes FOLDER/weightings.md and FOLDER/pictures/weightings_*.svg
// (tools/make_weightings). With --partial it leaves out what it cannot measure here: other libraries that it was built
// without, files where CHRONORMAL_DATA does not say where they are.

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string_view>

#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

void write_head(Page& page) {
  page.line("# Weightings, fits and other motions, measured\n");
  page.text(
      "Which rule makes which normals, what it costs to keep a rule that is no polynomial in time, and what there is "
      "for motion that is not straight. Every figure here is computed by the command that writes this page and its "
      "picture, and a test runs that command and compares:");
  page.line("    tools/make_weightings\n");
  page.text(
      "Nothing but the blocks of times changes from run to run. Why things are as they are is in "
      "[theory.md](theory.md), "
      "sections 8 to 11.");
  page.line("Contents: [1 Rules](#1-rules) · [2 Files](#2-normals-in-files) · [3 Fits](#3-fits) ·");
  page.line("[4 Curved motion](#4-curved-motion) · [5 Rigid and affine motion](#5-rigid-and-affine-motion)\n");
}

void write_page(const std::string& folder, bool partial) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (!partial) {
#ifndef CHRONORMAL_HAVE_PEERS
    throw std::runtime_error("built without the other libraries (CHRONORMAL_PEERS)");
#endif
    if (data == nullptr) throw std::runtime_error("set CHRONORMAL_DATA to the folder of the real data");
  }
  Page page(folder);
  write_head(page);
  write_rules(page);
  write_files(page, data == nullptr ? "" : data);
  write_fits(page);
  write_curves(page);
  write_transforms(page);
  std::string markdown = page.markdown();
  while (markdown.ends_with("\n\n")) markdown.pop_back();
  const Status written = write_output(folder + "/weightings.md", markdown, true);
  if (!written) throw std::runtime_error(written.error().text());
}

}  // namespace

Motion posed(const Motion& motion, std::size_t segment, double t) {
  const Segment from = motion.segment(segment);
  Motion result{motion.topology, std::vector<Motion::Keyframe>(1), {}};
  for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) {
    const Vec3f p = to_float(lerp(to_double(from.from[v]), to_double(from.to[v]), t));
    result.keyframes[0].positions.insert(result.keyframes[0].positions.end(), {p.x, p.y, p.z});
  }
  result.keyframes.push_back(result.keyframes[0]);
  result.keyframes[1].time = 1;
  result.connect_as_sequence();
  return result;
}

void begin_block(Page& page, std::string_view name) { page.line(fmt::format("<!-- {} -->", name)); }
void end_block(Page& page, std::string_view name) { page.line(fmt::format("<!-- end of {} -->\n", name)); }

}  // namespace chronormal::weightings

int main(int argc, char** argv) {
  const bool partial = argc == 3 && std::string_view(argv[1]) == "--partial";
  if (argc != (partial ? 3 : 2)) {
    std::fprintf(stderr, "usage: chronormal_weightings [--partial] FOLDER\n");
    return 2;
  }
  try {
    chronormal::weightings::write_page(argv[argc - 1], partial);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chronormal_weightings: %s\n", error.what());
    return 1;
  }
  return 0;
}
