#include <cstdio>
#include <iterator>
#include <vector>

#include "chronormal/chronormal.h"

namespace {

using namespace chronormal;

// Returns a keyframe of the strip. Vertices 0 and 1 are at x = 0, the next two at x = 1, and so on. Vertices 4 and 5
// are at the same places as 2 and 3.
Motion::Keyframe strip(double time, float down) {
  constexpr float kX[] = {0, 1, 1, 2, 2.5F, 3}, kHeight[] = {0, 0.3F, 0.3F, 0, -1, -2};
  Motion::Keyframe keyframe{{}, time, {}};
  for (std::size_t i = 0; i < std::size(kX); ++i) {
    for (const float y : {0.0F, 1.0F})
      keyframe.positions.insert(keyframe.positions.end(), {kX[i], y, down * kHeight[i]});
  }
  return keyframe;
}

}  // namespace

int main() {
  // Make a strip of four quads that is folded along the edge between the second and the third quad, and opens flat over
  // one second. The edge between the first two quads is cut, like a texture seam: vertices 4 and 5 are at the places of
  // 2 and 3.
  Motion motion;
  motion.topology =
      Topology::polygons(12, {0, 4, 8, 12, 16}, {0, 2, 3, 1, 4, 6, 7, 5, 6, 8, 9, 7, 8, 10, 11, 9}).value();
  motion.keyframes = {strip(0, 1), strip(1, 0)};
  motion.connect_as_sequence();

  // Say once which vertices share a normal: vertices that coincide in all keyframes, except across edges whose angle is
  // over 40 degrees.
  const auto groups = NormalGroups::by_crease_angle(motion, weld_coincident(motion), 40);
  if (!groups.ok()) {
    std::fprintf(stderr, "%s\n", groups.error().text().c_str());
    return 1;
  }
  // Prepare each segment once. The control normals are sums over faces, and are exact for every t in the segment.
  const NormalCurves curves = NormalCurves::of_groups(motion.segment(0), groups.value());

  // Evaluate as often as needed: first write one normal for each group, then copy it to all corners of the group.
  const std::size_t corners = groups.value().element_of_output().size();
  std::vector<float> different(3 * curves.size()), normals(3 * corners);
  std::printf("%zu corners, %zu different normals\n", corners, curves.size());
  std::printf("   t      seam, left     seam, right     crease, left    crease, right\n");
  for (const double t : {0.0, 0.5, 1.0}) {
    curves.unit_normals(t, VectorView<float>::packed(different.data(), curves.size()));
    groups.value().copy_to_outputs(VectorView<const float>::packed(different.data(), curves.size()),
                                   VectorView<float>::packed(normals.data(), corners));
    std::printf("%.2f", t);
    for (const std::size_t corner : {1U, 4U, 5U, 8U})  // one corner of face 0, two of face 1, one of face 2
      std::printf("   (%5.2f, %5.2f)", normals[3 * corner], normals[3 * corner + 2]);
    std::printf("\n");
  }
}
