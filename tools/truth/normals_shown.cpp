// Writes what schemes show of a sequence, as numbers for tools/truth/shading.py: the schemes of the program itself, so
// that the page does not measure copies of them.
//
//     chronormal_shown SEQUENCE SCHEME,SCHEME,... T,T,...  >  unit normals of vertices, float32
//
// Vertices are not welded, as they are not in shading.py. The order is segment, scheme, t, vertex, coordinate. Besides
// schemes, the names of curved paths stand for the exact normals on them.

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "chronormal/chronormal_io.h"
#include "chronormal/io/input.h"

namespace {

using namespace chronormal;

template <class T>
T value_of(Result<T> result) {
  if (result) return std::move(result).value();
  std::fprintf(stderr, "%s\n", result.error().text().c_str());
  std::exit(1);
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s SEQUENCE SCHEMES TIMES\n", argv[0]);
    return 2;
  }
  InputOptions options;
  options.files = {argv[1]};
  Input input = value_of(open_input(options));
  const Motion& motion = *value_of(input.motion());
  const NormalGroups groups = value_of(make_groups(motion, {.kind = ElementKind::kVertices, .weld = false}));
  std::vector<float> of_elements(3 * groups.size()), of_vertices(3 * motion.topology.vertex_count());
  const auto elements = VectorView<float>::packed(of_elements.data(), groups.size());
  const auto vertices = VectorView<float>::packed(of_vertices.data(), motion.topology.vertex_count());
  const auto write = [&] {
    groups.copy_to_outputs(elements, vertices);
    std::fwrite(of_vertices.data(), sizeof(float), of_vertices.size(), stdout);
  };
  const std::vector<std::string> times = split_at_commas(argv[3]);
  std::vector<const Motion::Keyframe*> keys;
  for (const Motion::Keyframe& keyframe : motion.keyframes) keys.push_back(&keyframe);
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const Segment segment = motion.segment(s);
    const std::vector<ControlNormals> normals = all_group_control_normals(segment, groups);
    for (const std::string& name : split_at_commas(argv[2])) {
      if (const Result<Path> path = make_path(name); path && path.value().is_curved()) {
        const CubicSegment curve = cubic_segment(keys, s, path.value().kind);
        for (const std::string& t : times) {
          const Motion::Keyframe pose{curve.positions(std::atof(t.c_str())), 0, {}};
          (void)NormalRecompute(still_segment(motion.topology, pose), groups).unit_normals(0, elements);
          write();
        }
        continue;
      }
      const auto scheme = value_of(make_scheme(name));
      scheme->prepare({&segment, {0, groups.size()}, normals, false});
      for (const std::string& t : times) {
        (void)scheme->evaluate(std::atof(t.c_str()), elements);
        write();
      }
    }
  }
  return 0;
}
