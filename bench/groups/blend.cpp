// Times unit normals of vertices under blend shapes. A few of many targets are active at once, and each target moves a
// part of the mesh.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <utility>

#include "chronormal/normals/float_recompute.h"
#include "chronormal/normals/normal_groups.h"
#include "groups/groups.h"
#include "normals/blend/blend_normals.h"
#include "normals/recompute/recompute.h"

namespace chronormal::bench {
namespace {

constexpr std::size_t kTargets = 100, kDenseTargets = 5;
constexpr double kMoved = 0.025;       // share of vertices that a target moves, as in a human face of 102 targets
constexpr double kDisplacement = 0.1;  // displacement as a multiple of the radius of the ring
constexpr double kExactError = 1e-6, kFloatError = 1e-3;
// The limit in radians for the error of normals that are the base normals plus weighted deltas. Such a sum is inexact
// by design, so the limit reveals gross mistakes only.
constexpr double kLinearError = 3.2;

// Makes targets that each move the region around one vertex, less and less towards the border of the region. A target
// lists its vertices in the order of the mesh.
BlendSet make_sparse(const Mesh& mesh) {
  BlendSet set;
  set.topology = mesh.topology();
  set.base.assign(mesh.from().begin(), mesh.from().end());
  const std::size_t vertices = set.topology.vertex_count();
  std::mt19937_64 random(1);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  for (std::size_t k = 0; k < kTargets; ++k) {
    // Half of the targets have the same five vertices as centres, so that they overlap like the targets of a human
    // face.
    const std::size_t centre = k % 2 == 0 ? random() % vertices : (k % 10) * vertices / 40;
    const Vector push = {uniform() - 0.5, uniform() - 0.5, uniform() - 0.5};
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      double square = 0;
      for (std::size_t c = 0; c < 3; ++c) square += std::pow(set.base[3 * v + c] - set.base[3 * centre + c], 2);
      near.emplace_back(square, v);
    }
    const auto count = static_cast<std::size_t>(kMoved * static_cast<double>(vertices)) + 1;
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    const double reach = near[count].first;
    near.resize(count);
    std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    BlendTarget target;
    for (const auto& [square, v] : near) {
      target.vertices.push_back(v);
      const double size = kDisplacement * std::pow(1 - square / reach, 2);
      for (const double c : push) target.deltas.push_back(static_cast<float>(size * c));
    }
    set.targets.push_back(std::move(target));
  }
  return set;
}

// Makes targets that move every vertex, each target by a different wave.
BlendSet make_dense(const Mesh& mesh) {
  BlendSet set;
  set.topology = mesh.topology();
  set.base.assign(mesh.from().begin(), mesh.from().end());
  for (std::size_t k = 0; k < kDenseTargets; ++k) {
    std::vector<float> deltas(set.base.size());
    for (std::size_t i = 0; i < deltas.size(); ++i) {
      const double phase = (2 + static_cast<double>(k)) * double{set.base[i / 3 * 3 + (i + k) % 3]};
      deltas[i] = static_cast<float>(kDisplacement * std::sin(phase + static_cast<double>(i % 3)));
    }
    set.targets.push_back(BlendTarget::from_dense(deltas));
  }
  return set;
}

std::vector<double> make_weights(std::size_t active, std::size_t targets) {
  std::mt19937_64 random(active);
  std::vector<double> weights(targets);
  for (std::size_t done = 0; done < active;) {
    double& weight = weights[random() % targets];
    if (weight != 0) continue;
    weight = 0.05 + static_cast<double>(random() >> 11U) * 0x1p-53;
    ++done;
  }
  return weights;
}

// Computes the exact normals at the given weights, from positions that are blended in double.
std::vector<Vector> exact_normals(const BlendSet& set, std::span<const double> weights, const Oracle& oracle) {
  std::vector<double> p(set.base.begin(), set.base.end());
  for (std::size_t k = 0; k < weights.size(); ++k) {
    for (std::size_t n = 0; n < set.targets[k].vertices.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c)
        p[3 * std::size_t{set.targets[k].vertices[n]} + c] +=
            weights[k] * static_cast<double>(set.targets[k].deltas[3 * n + c]);
  }
  std::vector<Vector> sums(set.topology.vertex_count());
  for (std::size_t f = 0; f < set.topology.face_count(); ++f) {
    const auto face = set.topology.face(f);
    Vector e{}, g{};
    for (std::size_t c = 0; c < 3; ++c) {
      e[c] = p[3 * std::size_t{face[1]} + c] - p[3 * std::size_t{face[0]} + c];
      g[c] = p[3 * std::size_t{face[2]} + c] - p[3 * std::size_t{face[0]} + c];
    }
    const Vector n = {e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]};
    for (const std::uint32_t v : face)
      for (std::size_t c = 0; c < 3; ++c) sums[v][c] += n[c];
  }
  std::vector<Vector> result;
  for (const std::uint32_t v : oracle.elements()) result.push_back(sums[v]);
  return result;
}

// Adds the deltas of the active targets to the positions in float32, as engines do.
void blend(const BlendSet& set, std::span<const double> weights, std::span<float> positions) {
  std::memcpy(positions.data(), set.base.data(), set.base.size() * sizeof(float));
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    const auto weight = static_cast<float>(weights[k]);
    const BlendTarget& target = set.targets[k];
    for (std::size_t n = 0; n < target.vertices.size(); ++n) {
      float* const p = positions.data() + 3 * std::size_t{target.vertices[n]};
      for (std::size_t c = 0; c < 3; ++c) p[c] += weight * target.deltas[3 * n + c];
    }
  }
}

// Computes normals as engines do: adds the weighted sparse deltas of each target to the unit normals of the base, and
// normalises the sums.
class LinearSum {
 public:
  LinearSum(BlendNormals& normals, std::size_t vertices, std::size_t targets) : base_(3 * vertices) {
    std::vector<float> end(3 * vertices);
    std::vector<double> weights(targets);
    (void)normals.unit_normals(weights, VectorView<float>::packed(base_.data(), vertices));
    for (std::size_t k = 0; k < targets; ++k) {
      weights[k] = 1;
      (void)normals.unit_normals(weights, VectorView<float>::packed(end.data(), vertices));
      weights[k] = 0;
      for (std::size_t i = 0; i < end.size(); ++i) end[i] -= base_[i];
      deltas_.push_back(BlendTarget::from_dense(end));
    }
  }

  void operator()(std::span<const double> weights, float* result) const {
    std::memcpy(result, base_.data(), base_.size() * sizeof(float));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] == 0) continue;
      const auto weight = static_cast<float>(weights[k]);
      for (std::size_t n = 0; n < deltas_[k].vertices.size(); ++n) {
        float* const to = result + 3 * std::size_t{deltas_[k].vertices[n]};
        for (std::size_t c = 0; c < 3; ++c) to[c] += weight * deltas_[k].deltas[3 * n + c];
      }
    }
    for (std::size_t i = 0; i < base_.size(); i += 3) {
      float* const n = result + i;
      const float scale = 1 / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::size_t c = 0; c < 3; ++c) n[c] *= scale;
    }
  }

 private:
  std::vector<float> base_;
  std::vector<BlendTarget> deltas_;
};

// Computes face normals in float32 and adds them up for each vertex, in the most straightforward way.
void plain_loop(const BlendSet& set, const NormalGroups& groups, std::span<const float> positions,
                std::span<float> face_normals, float* result) {
  const std::uint32_t* corner = set.topology.corners().data();
  for (std::size_t f = 0; f < set.topology.face_count(); ++f, corner += 3) {
    const float *a = &positions[3 * std::size_t{corner[0]}], *b = &positions[3 * std::size_t{corner[1]}],
                *c = &positions[3 * std::size_t{corner[2]}];
    const float ex = b[0] - a[0], ey = b[1] - a[1], ez = b[2] - a[2];
    const float gx = c[0] - a[0], gy = c[1] - a[1], gz = c[2] - a[2];
    face_normals[3 * f] = ey * gz - ez * gy;
    face_normals[3 * f + 1] = ez * gx - ex * gz;
    face_normals[3 * f + 2] = ex * gy - ey * gx;
  }
  for (std::size_t v = 0; v < groups.size(); ++v) {
    float x = 0, y = 0, z = 0;
    for (const std::uint32_t f : groups.faces(v)) {
      x += face_normals[3 * std::size_t{f}];
      y += face_normals[3 * std::size_t{f} + 1];
      z += face_normals[3 * std::size_t{f} + 2];
    }
    const float scale = 1 / std::sqrt(x * x + y * y + z * z);
    result[3 * v] = scale * x, result[3 * v + 1] = scale * y, result[3 * v + 2] = scale * z;
  }
}

struct Subject {
  explicit Subject(BlendSet made)
      : set(std::move(made)),
        groups(NormalGroups::of_vertices(set.topology, separate_points(set.topology.vertex_count()))),
        vertices(set.topology.vertex_count()),
        positions(set.base),
        face_normals(3 * set.topology.face_count()),
        normals(BlendNormals::of_groups(set, groups)),
        terms(BlendNormals::of_groups(set, groups, {.forced = BlendPath::kTerms})),
        touched(BlendNormals::of_groups(set, groups, {0, BlendPath::kTouched})),
        chosen_in_float32(BlendNormals::of_groups(set, groups, {.in_float32 = true})),
        linear(normals, vertices, set.targets.size()),
        segment{&set.topology, VectorView<const float>::packed(positions.data(), vertices),
                VectorView<const float>::packed(positions.data(), vertices)},
        recompute(segment, groups),
        in_float32(set.topology, groups),
        memory(3 * vertices),
        result(VectorView<float>::packed(memory.data(), vertices)) {}

  BlendSet set;
  NormalGroups groups;
  std::size_t vertices;
  std::vector<float> positions, face_normals;
  BlendNormals normals, terms, touched, chosen_in_float32;
  LinearSum linear;
  Segment segment;
  NormalRecompute recompute;
  FloatRecompute in_float32;
  AlignedArray<float> memory;
  VectorView<float> result;
};

void run_set(Suite& suite, const Size& size, const std::string& group, BlendSet (*make)(const Mesh&),
             std::size_t targets, const std::vector<std::size_t>& actives) {
  CaseList list(suite, group, size);
  const Mesh mesh(Elements::kVertices, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kVertices);
  std::unique_ptr<Subject> made;
  const auto subject = [&]() -> Subject& {
    if (made == nullptr) made = std::make_unique<Subject>(make(mesh));
    return *made;
  };
  for (const std::size_t active : actives) {
    const std::vector<double> weights = make_weights(active, targets);
    const auto add = [&](const std::string& name, double limit, const std::string& note,
                         const std::function<void(Subject&)>& run) {
      list.add(fmt::format("{} of {}: {}", active, targets, name), [&] {
        Case one;
        one.note = note;
        one.run = [&on = subject(), run] { run(on); };
        one.checks = {packed_check(0, subject().memory.data())};
        one.checks[0].expected = [&on = subject(), weights](const Oracle& of) {
          return exact_normals(on.set, weights, of);
        };
        one.limit = limit;
        return one;
      });
    };
    add("chosen", kExactError, "", [weights](Subject& on) { (void)on.normals.unit_normals(weights, on.result); });
    add("terms", kExactError, "", [weights](Subject& on) { (void)on.terms.unit_normals(weights, on.result); });
    add("touched part", kExactError, "", [weights](Subject& on) { (void)on.touched.unit_normals(weights, on.result); });
    // Blending in float32 rounds positions. The rounding error is large relative to the length of an edge, so the cases
    // below get a larger limit.
    add("chosen in float32", kFloatError, "",
        [weights](Subject& on) { (void)on.chosen_in_float32.unit_normals(weights, on.result); });
    add("recompute", kFloatError, "the whole mesh, positions in float32", [weights](Subject& on) {
      blend(on.set, weights, on.positions);
      (void)on.recompute.unit_normals(0, on.result);
    });
    add("recompute in float32", kFloatError, "the whole mesh", [weights](Subject& on) {
      blend(on.set, weights, on.positions);
      (void)on.in_float32.unit_normals(on.segment.from, on.result);
    });
    add("plain C++ loop", kFloatError, "the whole mesh, positions in float32", [weights](Subject& on) {
      blend(on.set, weights, on.positions);
      plain_loop(on.set, on.groups, on.positions, on.face_normals, on.memory.data());
    });
    add("linear sum", kLinearError, "deltas of unit normals, as engines do: not exact",
        [weights](Subject& on) { on.linear(weights, on.memory.data()); });
  }
  suite.run(group, size, mesh.topology().vertex_count(), oracle, list.take());
}

}  // namespace

void run_blend(Suite& suite, const Size& size) {
  run_set(suite, size, "blend", make_sparse, kTargets, {1, 2, 4, 8, 16, 52, 100});
  run_set(suite, size, "dense blend", make_dense, kDenseTargets, {1, 2, 5});
}

}  // namespace chronormal::bench
