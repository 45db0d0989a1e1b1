// Counts the elements that float32 cannot represent accurately, for several kinds of triangles, and compares the
// normals with those computed in double. docs/theory.md shows the output.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "chronormal/chronormal.h"

namespace {

using namespace chronormal;

struct Family {
  const char* name;
  double size;    // length of the edges
  double motion;  // largest displacement of the vertices, as a multiple of `size`; negative if the ends are independent
  double needle;  // height of the triangle, as a multiple of `size`
  double offset;  // distance of the triangle from the origin, as a multiple of `size`
};

constexpr Family kFamilies[] = {
    {"motion 0.05 of the size", 1, 0.05, 1, 0},
    {"motion 0.2", 1, 0.2, 1, 0},
    {"motion 1", 1, 1, 1, 0},
    {"independent ends", 1, -1, 1, 0},
    {"needles 1 : 1e-4, motion 0.2", 1, 0.2, 1e-4, 0},
    {"edges of 1e-6, motion 0.2", 1e-6, 0.2, 1, 0},
    {"edges of 1e6, motion 0.2", 1e6, 0.2, 1, 0},
    {"1e4 off the origin, motion 0.2", 1, 0.2, 1, 1e4},
};

Motion make(const Family& family, std::size_t faces) {
  std::mt19937_64 random(1);
  const auto uniform = [&random] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1; };  // [-1, 1)
  std::vector<std::uint32_t> corners(3 * faces);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);

  Motion motion{Topology::triangles(3 * faces, corners).value(), std::vector<Motion::Keyframe>(2), {}};
  motion.keyframes[1].time = 1;
  for (std::size_t i = 0; i < 9 * faces; ++i) {
    // Only the y coordinates are scaled, which turns triangles into needles.
    const double shape = i % 3 == 1 ? family.needle : 1;
    const double from = shape * uniform();
    const double to = family.motion < 0 ? uniform() : from + family.motion * shape * uniform();
    for (const auto& [keyframe, value] : {std::pair{0, from}, std::pair{1, to}})
      motion.keyframes[static_cast<std::size_t>(keyframe)].positions.push_back(
          static_cast<float>(family.size * (value + family.offset)));
  }
  motion.connect_as_sequence();
  return motion;
}

}  // namespace

int main() {
  constexpr std::size_t kFaces = 20000;
  std::printf("%-32s  %9s  %s\n%-32s  %9s  %s\n", "triangles", "flagged", "largest error", "", "%", "rad");
  for (const Family& family : kFamilies) {
    const Motion motion = make(family, kFaces);
    std::vector<ControlNormals> exact(kFaces);
    face_control_normals(motion.segment(0), {0, kFaces}, exact);
    const NormalCurves curves(exact);

    std::vector<float> packed(3 * kFaces);
    const auto normals = VectorView<float>::packed(packed.data(), kFaces);
    double largest = 0;
    for (int i = 0; i <= 20; ++i) {
      const double t = i / 20.0;
      (void)curves.unit_normals(t, normals);
      for (std::size_t f = 0; f < kFaces; ++f)
        largest = std::max(largest, angle_between(to_double(normals[f]), unit_normal_at(exact[f], t).vector));
    }
    std::printf("%-32s  %9.2f  %.1e\n", family.name, 100.0 * static_cast<double>(curves.flagged_count()) / kFaces,
                largest);
  }
}
