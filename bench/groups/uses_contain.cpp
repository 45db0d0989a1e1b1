// Finds all crossings of moving points through a closed mesh that deforms, over a whole segment. Also times common
// practice: a test for single instants, called at many instants. Times are given for each element, which is a point
// here.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "chronormal/analysis/containment.h"
#include "chronormal/core/parallel.h"
#include "groups/groups.h"
#ifdef CHRONORMAL_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace chronormal::bench {
namespace {

constexpr std::size_t kPoints = 10000, kSamples = 65;

using Floats = std::vector<float>;
using Windings = std::vector<std::int32_t>;

VectorView<const float> view(const Floats& xyz) { return VectorView<const float>::packed(xyz); }

// A mesh that deforms, and points that move on straight lines between random places in the bounding box of the mesh.
struct Scene {
  Segment segment;
  Containment containment;
  Floats from, to;
  std::vector<Crossing> crossings;

  explicit Scene(const Segment& of)
      : segment(of),
        containment(Containment::make(*of.topology, separate_points(of.topology->vertex_count()), of.from).value()) {
    Vec3f low = segment.from[0], high = low;
    for (const VectorView<const float>& end : {segment.from, segment.to}) {
      for (std::size_t v = 0; v < end.count; ++v) {
        low = {std::min(low.x, end[v].x), std::min(low.y, end[v].y), std::min(low.z, end[v].z)};
        high = {std::max(high.x, end[v].x), std::max(high.y, end[v].y), std::max(high.z, end[v].z)};
      }
    }
    std::mt19937 random(23);
    const auto between = [&random](float a, float b) {
      return a + (b - a) * static_cast<float>(random() >> 8U) * 0x1p-24F;
    };
    for (Floats* const places : {&from, &to}) {
      for (std::size_t p = 0; p < kPoints; ++p) {
        for (const auto& [a, b] : {std::pair{low.x, high.x}, {low.y, high.y}, {low.z, high.z}})
          places->push_back(between(a, b));
      }
    }
  }

  [[nodiscard]] Windings windings(double t) const {
    return containment.winding_numbers(segment, t, view(from), view(to));
  }
};

// Computes the winding number of a point at t from the solid angles of all faces, in double (van Oosterom and Strackee,
// 1983).
int winding_by_angles(const Scene& scene, std::size_t p, double t) {
  const auto at = [t](const Vec3f& a, const Vec3f& b) { return lerp(to_double(a), to_double(b), t); };
  const Vec3d origin = at(view(scene.from)[p], view(scene.to)[p]);
  double sum = 0;
  for (std::size_t f = 0; f < scene.segment.topology->face_count(); ++f) {
    const auto face = scene.segment.topology->face(f);
    const auto corner = [&](std::size_t k) {
      return at(scene.segment.from[face[k]], scene.segment.to[face[k]]) - origin;
    };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    const double x = length(a), y = length(b), z = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return static_cast<int>(std::lround(sum / (4 * 3.14159265358979323846)));
}

// Checks, for some points at several t, that the winding number at t = 0 plus the crossings before t equals the winding
// number that is computed from solid angles.
void verify(const Scene& scene) {
  const Windings start = scene.windings(0);
  const std::size_t step = 1 + scene.segment.topology->face_count() / 200;
  for (std::size_t p = 0; p < kPoints; p += step) {
    for (const double t : {0.0, 0.3, 0.8, 1.0}) {
      int winding = start[p];
      for (const Crossing& crossing : scene.crossings) {
        if (crossing.point == p && crossing.t < t) winding += crossing.inward ? 1 : -1;
      }
      if (winding != winding_by_angles(scene, p, t))
        throw std::runtime_error(fmt::format("uses: point {} has another winding number at t = {}", p, t));
    }
  }
}

// Counts the crossings that are noticed by a program that finds the points inside the mesh only at kSamples instants.
std::size_t noticed(const Scene& scene) {
  std::size_t count = 0;
  Windings before = scene.windings(0);
  for (std::size_t i = 1; i < kSamples; ++i) {
    Windings after = scene.windings(static_cast<double>(i) / (kSamples - 1));
    for (std::size_t p = 0; p < kPoints; ++p) count += static_cast<std::size_t>(std::abs(after[p] - before[p]));
    before = std::move(after);
  }
  return count;
}

#ifdef CHRONORMAL_HAVE_PEERS
// The mesh and the points at kTime, which are the input of a test for single instants.
struct Still {
  Floats mesh, points;

  explicit Still(const Scene& scene) {
    const auto add = [](Floats& places, const VectorView<const float>& from, const VectorView<const float>& to) {
      for (std::size_t i = 0; i < from.count; ++i) {
        const Vec3f p = lerp(from[i], to[i], kTime);
        places.insert(places.end(), {p.x, p.y, p.z});
      }
    };
    add(mesh, scene.segment.from, scene.segment.to);
    add(points, view(scene.from), view(scene.to));
  }
};
#endif

}  // namespace

void run_containment(Suite& suite, const Size& size) {
  const std::string group = "uses";
  if (!suite.wants(group, size, "containment")) return;
  suite.say(fmt::format("{}, {}, {}: containment", group, size.name, size.order()));
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kFaces);
  const auto scene = std::make_shared<Scene>(mesh.segment());
  const auto find_all = [scene] {
    scene->crossings = scene->containment.crossings(scene->segment, view(scene->from), view(scene->to));
  };
  find_all();
  verify(*scene);

  std::vector<Case> cases;
  const auto add = [&cases](const std::string& name, const std::string& note, std::function<void()> run) -> Case& {
    Case one;
    one.name = name;
    one.note = note;
    one.run = std::move(run);
    cases.push_back(std::move(one));
    return cases.back();
  };
  const std::size_t count = scene->crossings.size();
  add("containment, all crossings", fmt::format("{} crossings", count), [find_all] {
    const ThreadLimit one_thread(1);
    find_all();
  });
  add("containment, all crossings, all threads", "", find_all).threads = suite.options().threads;
  add("containment, single instant", "winding numbers at one t", [scene] {
    const ThreadLimit one_thread(1);
    (void)scene->windings(kTime);
  });
  const std::size_t seen = noticed(*scene);
  add(fmt::format("containment, {} samples", kSamples),
      fmt::format("misses {:.2f} % of the crossings, times to 1/{}",
                  100 * (1 - static_cast<double>(seen) / static_cast<double>(count)), kSamples - 1),
      [scene] {
        const ThreadLimit one_thread(1);
        (void)noticed(*scene);
      });
#ifdef CHRONORMAL_HAVE_PEERS
  const auto still = std::make_shared<Still>(*scene);
  const peers::TriangleMesh peer{still->mesh, mesh.topology().corners()};
  const Windings ours = scene->windings(kTime);
  const std::vector<bool> theirs = peers::vtk_enclosed(peer, still->points);
  std::size_t different = 0;
  for (std::size_t p = 0; p < kPoints; ++p) different += theirs[p] != (ours[p] != 0);
  Case& vtk = add("containment, VTK vtkSelectEnclosedPoints",
                  fmt::format("at one t, interpolation left out; {} of {} differ from ours", different, kPoints),
                  [still, peer] { (void)peers::vtk_enclosed(peer, still->points); });
  vtk.library = "VTK " + peers::vtk_library().version;
#endif
  suite.run(group, size, kPoints, oracle, std::move(cases));
}

}  // namespace chronormal::bench
