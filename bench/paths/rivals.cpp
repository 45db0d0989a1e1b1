// Makes the cases of the plain loops and of the libraries that serve as baselines.
#include "paths/rivals.h"

#include <cmath>
#include <memory>

#include "paths/loops.h"
#include "paths/ours.h"
#ifdef CHRONORMAL_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace chronormal::bench {
namespace {

struct LoopMemory {
  AlignedArray<float> positions, normals;
  LoopMesh mesh;
};

std::shared_ptr<LoopMemory> loop_memory(const Mesh& mesh, Elements elements) {
  auto memory = std::make_shared<LoopMemory>();
  memory->positions = AlignedArray<float>(mesh.from().size());
  memory->normals = AlignedArray<float>(3 * mesh.count(elements));
  memory->mesh = {mesh.from(), mesh.to(), mesh.topology().corners(), {memory->positions.data(), mesh.from().size()}};
  return memory;
}

using Loop = void (*)(const LoopMesh&, float, std::span<float>);

Case loop_case(const std::shared_ptr<LoopMemory>& memory, Loop loop, double limit) {
  Case one;
  one.run = [memory, loop] { loop(memory->mesh, kTime, {memory->normals.data(), memory->normals.size()}); };
  one.checks = {packed_check(double{kTime}, memory->normals.data())};
  one.limit = limit;
  one.note = "interpolation included";
  return one;
}

#ifdef CHRONORMAL_HAVE_PEERS

// The limit for the error of CGAL in radians. The limit is large because CGAL does not define the normal of a vertex as
// a sum.
constexpr double kOtherRule = 0.3;

constexpr std::size_t kManyElements = 5000000;

void add_library(CaseList& list, const Mesh& mesh, Elements elements, const std::shared_ptr<LoopMemory>& memory,
                 const peers::Library& library) {
  std::shared_ptr<peers::LibraryMesh> built;
  for (const peers::Call& call : library.calls) {
    if (call.of_vertices != (elements == Elements::kVertices)) continue;
    if (call.slow_in_random_order && list.size().shuffled && mesh.count(elements) > kManyElements) continue;
    list.add(library.name + " " + call.name, [&] {
      if (!built) {
        interpolate(memory->mesh, kTime);
        built = library.make_mesh({memory->mesh.positions, memory->mesh.corners});
      }
      Case one;
      one.library = library.name + " " + library.version;
      one.note = call.note;
      one.run = [built, compute = call.compute] { compute(*built); };
      one.checks = {{double{kTime},
                     [built, normal = call.normal](std::size_t element) {
                       const Vec3d n = normal(*built, element);
                       return Vector{n.x, n.y, n.z};
                     },
                     {}}};
      one.rule = call.rule == peers::Rule::kUniform ? Rule::kUniform : Rule::kArea;
      one.limit = call.rule == peers::Rule::kOther ? kOtherRule : float_limit(mesh.count(elements));
      return one;
    });
  }
}

std::vector<peers::Library> libraries() {
  return {peers::cgal_library(), peers::openmesh_library(), peers::vtk_library()};
}

#endif

}  // namespace

// Returns the limit for the error of normals from float32 positions, in radians. Float32 rounds positions relative to
// the size of the whole mesh. In a mesh of more elements the edges are shorter, so the limit grows.
double float_limit(std::size_t elements) { return 2e-6 * std::sqrt(static_cast<double>(elements)) + 1e-5; }

void add_loops(CaseList& list, const Mesh& mesh, Elements elements, double limit) {
  const bool of_faces = elements == Elements::kFaces;
  const std::shared_ptr<LoopMemory> memory = loop_memory(mesh, elements);
  list.add("interpolate positions", [&] {
    Case one;
    one.run = [memory] { interpolate(memory->mesh, kTime); };
    one.note = "what libraries need before they begin; per element, not per position";
    return one;
  });
  list.add("plain C++ loop", [&] { return loop_case(memory, of_faces ? plain_faces : plain_vertices, limit); });
#ifdef CHRONORMAL_HAVE_EIGEN
  list.add("Eigen loop", [&] {
    Case one = loop_case(memory, of_faces ? eigen_faces : eigen_vertices, limit);
    one.library = "Eigen " + eigen_version();
    return one;
  });
#endif
}

void add_libraries([[maybe_unused]] CaseList& list, [[maybe_unused]] const Mesh& mesh,
                   [[maybe_unused]] Elements elements) {
#ifdef CHRONORMAL_HAVE_PEERS
  const std::shared_ptr<LoopMemory> memory = loop_memory(mesh, elements);
  for (const peers::Library& library : libraries()) add_library(list, mesh, elements, memory, library);
#endif
}

std::map<std::string, std::string> rival_versions() {
  std::map<std::string, std::string> versions;
#ifdef CHRONORMAL_HAVE_EIGEN
  versions["Eigen"] = eigen_version();
#endif
#ifdef CHRONORMAL_HAVE_PEERS
  for (const peers::Library& library : libraries()) versions[library.name] = library.version;
#endif
  return versions;
}

}  // namespace chronormal::bench
