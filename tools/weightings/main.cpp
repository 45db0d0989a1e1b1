// chronormal_weightings [--partial] FOLDER: writes FOLDER/weightings.md
// (tools/make_weightings). With --partial it leaves out what it cannot measure here: other libraries that it was built
// without, files where CHRONORMAL_DATA does not say where they are.

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

void write_page(const std::string& folder, bool partial) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (!partial) {
#ifndef CHRONORMAL_HAVE_PEERS
    throw std::runtime_error("built without the other libraries (CHRONORMAL_PEERS)");
#endif
    if (data == nullptr) throw std::runtime_error("set CHRONORMAL_DATA to the folder of the real data");
  }
  Page page("weightings/weightings.md.in", folder);
  page.set("peers", peers_part(folder));
  page.set("golden", data == nullptr ? "" : golden_part(folder, data));
  measure_fits(page);
  measure_transforms(page);
  page.write("weightings.md");
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

std::string degrees(double value, int decimals) {
  return value < 1e-9 ? "0" : value < 1e-3 ? scientific(value, decimals) : ratio(value);
}

}  // namespace chronormal::weightings

int main(int argc, char** argv) {
  const bool partial = argc == 3 && std::string_view(argv[1]) == "--partial";
  if (argc != (partial ? 3 : 2)) {
    std::fprintf(stderr, "usage: chronormal_weightings [--partial] FOLDER\n");
    return 2;
  }
  return chronormal::pages::run("chronormal_weightings",
                                [&] { chronormal::weightings::write_page(argv[argc - 1], partial); });
}
