// Containment and crossings against winding numbers in whole numbers and roots in rationals: 100,000 cases from a fixed
// seed, and as many as the variable CHRONORMAL_FULL_CASES asks for. A case is one point that moves through one mesh.

#include "chronormal/analysis/containment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/io/builtin_morphs.h"
#include "tests/support/fixtures.h"
#include "tests/support/read_input.h"
#include "tests/support/winding_oracle.h"

namespace chronormal::containment_test {
namespace {

using exact::Corners;
using fixtures::Random;

constexpr std::uint64_t kSeed = 20230;

std::size_t wanted_cases() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  return full == nullptr ? 100000 : static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
}

// The outsides of a tetrahedron, a double pyramid and a cube, whatever their vertices make of them.
const std::array<std::vector<Corners>, 3> kMeshes{{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
    {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
    {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6},
     {1, 3, 5}, {3, 7, 5}},
}};
const std::array<std::vector<Vec3f>, 3> kShapes{{
    {{-8, -8, -8}, {8, -8, -8}, {0, 8, -8}, {0, 0, 8}},
    {{8, 0, 0}, {-8, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 8}, {0, 0, -8}},
    {{-8, -8, -8}, {8, -8, -8}, {-8, 8, -8}, {8, 8, -8}, {-8, -8, 8}, {8, -8, 8}, {-8, 8, 8}, {8, 8, 8}},
}};

std::vector<float> flat(const std::vector<Vec3f>& points) {
  std::vector<float> result;
  for (const Vec3f& p : points) result.insert(result.end(), {p.x, p.y, p.z});
  return result;
}
VectorView<const float> view(const std::vector<float>& xyz) { return VectorView<const float>::packed(xyz); }

// A closed mesh, in one segment, and points in it.
struct Scene {
  std::vector<Corners> faces;
  Topology topology;
  std::vector<float> mesh_from, mesh_to;
  std::vector<Vec3f> from, to;

  Scene(std::vector<Corners> corners, const std::vector<Vec3f>& at_start, const std::vector<Vec3f>& at_end)
      : faces(std::move(corners)), mesh_from(flat(at_start)), mesh_to(flat(at_end)) {
    std::vector<std::uint32_t> all;
    for (const Corners& face : faces) all.insert(all.end(), face.begin(), face.end());
    topology = fixtures::make_triangles(at_start.size(), std::move(all));
  }

  [[nodiscard]] Segment segment() const { return {&topology, view(mesh_from), view(mesh_to)}; }
  [[nodiscard]] Containment containment() const {
    return Containment::make(topology, separate_points(topology.vertex_count()), view(mesh_from)).value();
  }
  [[nodiscard]] std::vector<Crossing> crossings() const {
    const std::vector<float> a = flat(from), b = flat(to);
    return containment().crossings(segment(), view(a), view(b));
  }
  [[nodiscard]] std::vector<std::int32_t> windings(double t) const {
    const std::vector<float> at = flat(t == 0 ? from : to);
    return containment().winding_numbers(segment(), t, view(at));
  }
  [[nodiscard]] int expected_winding(std::size_t p, double t) const {
    return exact::winding_number(segment(), faces, from[p], to[p], t);
  }
};

// The winding number behind all crossings before t; the crossings are of one point.
int winding_before(int start, std::span<const Crossing> crossings, double t) {
  for (const Crossing& crossing : crossings) start += crossing.t < t ? (crossing.inward ? 1 : -1) : 0;
  return start;
}

std::span<const Crossing> of_point(const std::vector<Crossing>& crossings, std::size_t p) {
  const auto is_before = [](const Crossing& crossing, std::size_t point) { return crossing.point < point; };
  return {std::lower_bound(crossings.begin(), crossings.end(), p, is_before),
          std::lower_bound(crossings.begin(), crossings.end(), p + 1, is_before)};
}

Vec3f lattice_point(Random& random, std::size_t half) {
  const auto coordinate = [&] {
    return static_cast<float>(static_cast<int>(random.below(2 * half + 1)) - static_cast<int>(half));
  };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

// Vertices on a lattice, many of them where they have been, or moved alike.
std::vector<Vec3f> moved_on_lattice(const std::vector<Vec3f>& points, Random& random) {
  const std::size_t kind = random.below(4);
  const Vec3f shift = lattice_point(random, 4);
  std::vector<Vec3f> result = points;
  for (Vec3f& p : result) {
    if (kind == 1) p = p + shift;
    if (kind == 2 && random.below(2) == 0) p = p + lattice_point(random, 4);
    if (kind == 3) p = lattice_point(random, 8);
  }
  return result;
}

// A place at t = 1/2, in halves, that is often on a vertex, an edge or a face; as twice itself.
Vec3f twice_a_place(const Scene& scene, Random& random) {
  const auto twice = [&](std::uint32_t v) { return scene.segment().from[v] + scene.segment().to[v]; };
  const Corners& face = scene.faces[random.below(scene.faces.size())];
  const Vec3f a = twice(face[0]), b = twice(face[1]), c = twice(face[2]);
  switch (random.below(4)) {
    case 0:
      return a;
    case 1:
      return 0.5F * (a + b);
    case 2:
      return 0.25F * (a + a + b + c);
    default:
      return 2.0F * lattice_point(random, 6);
  }
}

void add_lattice_points(Scene& scene, std::size_t count, Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f twice = twice_a_place(scene, random);
    Vec3f from = lattice_point(random, 10), to = twice - from;
    switch (random.below(6)) {
      case 0:  // at rest
        from = to = 0.5F * twice;
        break;
      case 1:  // from a vertex to a vertex: along edges, too
        from = scene.segment().from[random.below(scene.segment().from.count)];
        to = scene.segment().to[random.below(scene.segment().to.count)];
        break;
      case 2:  // begins in the place
        from = 0.5F * twice;
        break;
      default:;
    }
    scene.from.push_back(from);
    scene.to.push_back(to);
  }
}

// Holds the winding numbers at both ends and between, as crossings say they are, against the oracle.
void judge_windings(const Scene& scene, Random& random, const std::string& what) {
  const std::vector<Crossing> all = scene.crossings();
  const std::vector<std::int32_t> starts = scene.windings(0), ends = scene.windings(1);
  for (std::size_t p = 0; p < scene.from.size(); ++p) {
    const std::span<const Crossing> crossings = of_point(all, p);
    ASSERT_EQ(starts[p], scene.expected_winding(p, 0)) << what << ", point " << p;
    if (ends[p]!= winding_before(starts[p], crossings, 2)) { auto S=scene.segment(); for (size_t v=0;v<S.from.count;++v) std::printf("v %g %g %g -> %g %g %g\n",S.from[v].x,S.from[v].y,S.from[v].z,S.to[v].x,S.to[v].y,S.to[v].z);
      for (auto f: scene.faces) std::printf("f %u %u %u\n",f[0],f[1],f[2]);
      std::printf("p %g %g %g -> %g %g %g start %d end %d oracle end %d\n",scene.from[p].x,scene.from[p].y,scene.from[p].z,scene.to[p].x,scene.to[p].y,scene.to[p].z,starts[p],ends[p],scene.expected_winding(p,1));
      for (auto c: crossings) std::printf("c %.17g face %u %d\n",c.t,c.face,c.inward);}
    ASSERT_EQ(ends[p], winding_before(starts[p], crossings, 2)) << what << ", point " << p;
    const double t = static_cast<double>(random.below(15) * 2 + 1) / 32;
    const bool is_clear =
        std::none_of(crossings.begin(), crossings.end(), [t](const Crossing& c) { return std::fabs(c.t - t) < 1e-12; });
    if (is_clear) {
      ASSERT_EQ(scene.expected_winding(p, t), winding_before(starts[p], crossings, t)) << what << ", point " << p;
    }
  }
}

TEST(ExactContainment, windings_between_crossings_are_those_of_whole_numbers) {
  Random random(kSeed);
  const std::size_t wanted = wanted_cases();
  std::size_t cases = 0;
  for (std::size_t i = 0; cases < wanted; ++i) {
    const std::size_t shape = i % kMeshes.size();
    const std::vector<Vec3f> start = moved_on_lattice(kShapes[shape], random);
    Scene scene(kMeshes[shape], start, moved_on_lattice(start, random));
    add_lattice_points(scene, 50, random);
    judge_windings(scene, random, "seed " + std::to_string(kSeed) + ", mesh " + std::to_string(i));
    if (HasFatalFailure()) return;
    cases += scene.from.size();
  }
  std::cout << "seed " << kSeed << ": " << cases << " cases\n";
}

}  // namespace
}  // namespace chronormal::containment_test
