// Prints a hash of all results of chronormal_core.h for some meshes. The hash must be the same with the two files that
// tools/two_files.py makes and with the library. The coordinates of the meshes are integers times powers of two, so
// they are the same everywhere.
#include "chronormal_core.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

namespace {

using namespace chronormal;

std::uint64_t hash = 0xCBF29CE484222325u;

void add(const void* bytes, std::size_t count) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < count; i += sizeof word) {
    std::memcpy(&word, static_cast<const char*>(bytes) + i, sizeof word);
    hash = (hash ^ word) * 0x100000001B3u;
  }
}
template <class T>
void add(const std::vector<T>& values) {
  add(values.data(), values.size() * sizeof(T));
}
void add(std::size_t count) {
  const auto word = static_cast<std::uint32_t>(count);
  add(&word, sizeof word);
}

struct Mesh {
  Topology topology;
  std::vector<float> from, to;
};

// Makes a grid with bands of rows that rest, translate, turn, shrink to a point, turn inside out, or move freely. The
// vertices of the last column coincide with those of the first column, so the two columns are welded.
Mesh grid(std::uint32_t cells, std::mt19937_64& random) {
  const auto noise = [&random](unsigned bits) {
    return static_cast<float>(static_cast<std::int64_t>(random() & ((1u << bits) - 1)) - (1 << bits) / 2) * 0x1p-12f;
  };
  Mesh mesh;
  const std::uint32_t row = cells + 1;
  for (std::uint32_t y = 0; y < row; ++y) {
    for (std::uint32_t x = 0; x < row; ++x) {
      float from[3] = {static_cast<float>(x), static_cast<float>(y) + noise(9), noise(11)}, to[3];
      std::memcpy(to, from, sizeof to);
      switch (y * 7 / row) {
        case 0:
          break;
        case 1:
          to[0] += 0.25f, to[1] -= 8;
          break;
        case 2:
          to[0] = -from[1], to[1] = from[0];
          break;
        case 3:
          to[0] = to[1] = to[2] = 7;
          break;
        case 4:
          to[0] = -from[0], to[2] = -from[2];
          break;
        case 5:
          to[0] = noise(16), to[1] = noise(16), to[2] = noise(16);
          break;
        default:
          to[0] += noise(11), to[1] += noise(11), to[2] += noise(12);
      }
      if (x == cells) {
        std::memcpy(from, mesh.from.data() + mesh.from.size() - 3 * cells, sizeof from);
        std::memcpy(to, mesh.to.data() + mesh.to.size() - 3 * cells, sizeof to);
      }
      mesh.from.insert(mesh.from.end(), from, from + 3);
      mesh.to.insert(mesh.to.end(), to, to + 3);
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = y * row + x, c = a + row;
      corners.insert(corners.end(), {a, a + 1, c + 1, a, c + 1, c});
    }
  }
  mesh.topology = Topology::triangles(row * row, corners).value();
  return mesh;
}

void add_curves(const Mesh& mesh, const MeshNormalsOptions& options) {
  const auto from = VectorView<const float>::packed(mesh.from), to = VectorView<const float>::packed(mesh.to);
  MeshNormals made = MeshNormals::make(mesh.topology, options).value();
  add(made.set_segment(from, to) ? 1 : 0);
  add(made.size());
  add(made.element_count());
  add(made.bytes());
  std::vector<float> normals(3 * made.size());
  std::vector<Octahedral> octahedral(made.size());
  std::vector<Rgb10A2> rgb(made.size());
  for (const double t : {0.0, 0.25, 1.0 / 3, 0.5, 0.8125, 1.0}) {
    add(made.unit_normals(t, VectorView<float>::packed(normals), options.threads));
    add(normals);
    add(made.unit_normals(t, std::span(octahedral)));
    add(octahedral);
    add(made.unit_normals(t, std::span(rgb)));
    add(rgb);
  }
  std::vector<std::byte> buffer(36 * made.size());
  if (made.fill_vertex_buffer(ControlFormat::kFloat32, buffer)) {
    std::vector<float> values(9 * made.size());
    std::memcpy(values.data(), buffer.data(), buffer.size());
    add(values);
  }
  add(made.begin_segment(to, from) ? 1 : 0);
  while (!made.prepare(0.3)) {
  }
  made.finish_segment();
  add(made.unit_normals(0.375, VectorView<float>::packed(normals)));
  add(normals);
}

void add_blend(const Mesh& mesh, const ElementOptions& options, std::mt19937_64& random) {
  BlendSet set{mesh.topology, mesh.from, {}};
  for (std::size_t k = 0; k < 5; ++k) {
    std::vector<float> deltas(mesh.from.size());
    for (std::size_t i = 0; i < deltas.size(); ++i) {
      const std::size_t band = i * 8 / deltas.size();
      if (band == k || band == k + 1)
        deltas[i] = (mesh.to[i] - mesh.from[i]) * 0.125f * static_cast<float>(random() % 8);
    }
    set.targets.push_back(BlendTarget::from_dense(deltas));
  }
  MeshNormals blend = MeshNormals::make(set.topology, {.elements = options}).value();
  add(blend.set_targets(std::move(set)) ? 1 : 0);
  std::vector<float> normals(3 * blend.size());
  for (int pose = 0; pose < 4; ++pose) {
    std::vector<double> weights(5);
    for (double& weight : weights) weight = static_cast<double>(random() % 33) / 16 - 0.5;
    add(blend.unit_normals(std::span<const double>(weights), VectorView<float>::packed(normals),
                           pose % 2 == 0 ? Threads::kOne : Threads::kAll));
    add(normals);
  }
}

}  // namespace

int main() {
  std::mt19937_64 random(5001);
  for (const std::uint32_t cells : {1u, 3u, 24u, 90u}) {
    const Mesh mesh = grid(cells, random);
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
      const ElementOptions elements{.kind = kind, .crease_angle = kind == ElementKind::kCorners ? 40.0 : 180.0};
      for (const double tolerance : {kExactTolerance, kCompactTolerance})
        add_curves(mesh, {.elements = elements, .tolerance = tolerance, .threads = Threads::kAll});
      if (kind == ElementKind::kVertices && cells < 10)
        add_curves(mesh, {.elements = elements, .weighting = Weighting::kAngle});
      add_blend(mesh, elements, random);
    }
    std::printf("%u cells: %016llx\n", cells, static_cast<unsigned long long>(hash));
  }
}
