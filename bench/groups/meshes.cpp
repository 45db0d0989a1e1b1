// Times our unit normals and plain loops on meshes other than the torus: meshes with thin triangles, with varied
// valence, with a collapse, and meshes by other people.

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "groups/groups.h"
#include "paths/rivals.h"

namespace chronormal::bench {
namespace {

constexpr std::size_t kFaces = 45000;
// The limit in radians for the error of normals of very thin triangles (needles), and of vertices whose face normals
// nearly cancel. The limit reveals gross mistakes only.
constexpr double kFloatLimit = 3.2;

// Returns the torus, stretched along one axis so that half of its triangles have an aspect ratio of at least 10.
Mesh thin() {
  const Mesh torus(Elements::kFaces, kFaces, false);
  std::vector<float> from(torus.from().begin(), torus.from().end()), to(torus.to().begin(), torus.to().end());
  for (std::size_t i = 0; i < from.size(); i += 3) from[i] *= 30, to[i] *= 30;
  return {torus.topology(), from, to};
}

// Returns the torus with the diagonal of every third quad turned, so that the number of faces around a vertex varies
// from 4 to 8 and more.
Mesh varied() {
  const Mesh torus(Elements::kFaces, kFaces, false);
  std::vector<std::uint32_t> corners(torus.topology().corners().begin(), torus.topology().corners().end());
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i + 6 <= corners.size(); i += 6) {
    // The two triangles a b c and a c d of the quad become a b d and b c d.
    if (random() % 3 != 0) continue;
    corners[i + 2] = corners[i + 5];
    corners[i + 3] = corners[i + 1];
    corners[i + 4] = torus.topology().corners()[i + 2];
  }
  return {Topology::triangles(torus.topology().vertex_count(), std::move(corners)).value(), torus.from(), torus.to()};
}

// Returns the middle segment of a motion as a mesh of triangles.
Mesh middle_of(const Motion& motion) {
  if (!motion.topology.all_triangles()) throw std::runtime_error("a mesh of the bench is not of triangles");
  const Motion::SegmentKeys keys = motion.segments[motion.segments.size() / 2];
  return {motion.topology, motion.keyframes[keys.from].positions, motion.keyframes[keys.to].positions};
}

Mesh of_file(const std::string& path) {
  InputOptions options;
  options.files = {path};
  if (path.ends_with(".glb")) options.animation = std::string(1, '0');
  Result<Input> input = open_input(options);
  if (!input) throw std::runtime_error(fmt::format("{}: {}", path, input.error().message));
  const Result<const Motion*> motion = input.value().motion();
  if (!motion) throw std::runtime_error(fmt::format("{}: {}", path, motion.error().message));
  return middle_of(*motion.value());
}

void run_mesh(Suite& suite, const std::string& name, const std::function<Mesh()>& make) {
  std::optional<Mesh> mesh;
  for (const Elements elements : {Elements::kFaces, Elements::kVertices}) {
    const std::string group = elements == Elements::kFaces ? "faces of meshes" : "vertices of meshes";
    const Size size{name, 0, false};
    const auto is_wanted = [&](const char* path) { return suite.wants(group, size, path); };
    const auto paths = {"plain C++ loop", "recompute", "recompute in float32", "prepare exact", "exact to float3"};
    if (std::none_of(paths.begin(), paths.end(), is_wanted)) continue;
    if (!mesh) mesh = make();
    CaseList list(suite, group, size);
    const Oracle oracle(mesh->segment(), elements);
    add_loops(list, *mesh, elements, kFloatLimit);
    std::optional<NormalGroups> groups;
    if (elements == Elements::kVertices)
      groups = NormalGroups::of_vertices(mesh->topology(), separate_points(mesh->topology().vertex_count()));
    add_ours(list, mesh->segment(), groups ? &*groups : nullptr, 0, kFloatLimit);
    suite.run(group, size, mesh->count(elements), oracle, list.take());
  }
}

}  // namespace

void run_meshes(Suite& suite) {
  run_mesh(suite, "thin", thin);
  run_mesh(suite, "varied", varied);
  run_mesh(suite, "eversion", [] { return middle_of(make_builtin_morph("eversion").value()); });
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) return suite.say("CHRONORMAL_DATA names no folder: real meshes are left out");
  run_mesh(suite, "dance", [data] { return of_file(fmt::format("{}/sequences/rumba_13", data)); });
  run_mesh(suite, "face", [data] { return of_file(fmt::format("{}/rigs/ict_capture.glb", data)); });
}

}  // namespace chronormal::bench
