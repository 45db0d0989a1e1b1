// Normals of vertices on cubics, of degree 6: our curves, beside those of degree 2, beside the same control normals in
// double, and beside who has no curves and moves the vertices first.

#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <vector>

#include "chronormal/normals/float_recompute.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/path_curves.h"
#include "chronormal/normals/paths.h"
#include "chronormal/normals/recompute.h"
#include "groups/groups.h"
#include "paths/rivals.h"

namespace chronormal::bench {
namespace {

// A segment of the torus in which every vertex leaves the straight line by up to an eighth of a turn about the z axis.
struct Curved {
  const Mesh& mesh;
  Segment segment;
  NormalGroups groups;
  std::vector<float> from_velocities, to_velocities;
  PolynomialSegment<3> path;
  std::vector<PolynomialNormals<3>> normals;
  std::vector<float> result, positions;  // (V, 3), written by the cases

  explicit Curved(const Mesh& of)
      : mesh(of),
        segment(of.segment()),
        groups(NormalGroups::of_vertices(of.topology(), separate_points(of.topology().vertex_count()))) {
    const std::size_t size = of.from().size();
    from_velocities.resize(size);
    to_velocities.resize(size);
    for (std::size_t v = 0; v < size; v += 3) {
      const auto bend = [&](std::span<const float> p, float sign, std::vector<float>& velocities) {
        const float turn[3] = {-p[v + 1], p[v], 0};
        for (std::size_t c = 0; c < 3; ++c) velocities[v + c] = of.to()[v + c] - of.from()[v + c] + sign * turn[c];
      };
      bend(of.from(), 0.8F, from_velocities);
      bend(of.to(), -0.8F, to_velocities);
    }
    const auto packed = [](const std::vector<float>& values) {
      return VectorView<const float>::packed(values.data(), values.size() / 3);
    };
    path =
        hermite_segment(of.topology(), segment.from, packed(from_velocities), segment.to, packed(to_velocities), 0, 1);
    normals = all_path_normals(path, groups);
    result.resize(size);
    positions.resize(size);
  }

  [[nodiscard]] std::size_t count() const { return normals.size(); }
  [[nodiscard]] VectorView<float> packed_result() { return VectorView<float>::packed(result.data(), count()); }
  // Moves the vertices, in float32, by Hermite's polynomials.
  void move(float t) {
    const float t2 = t * t, t3 = t2 * t, a = 2 * t3 - 3 * t2 + 1, b = t3 - 2 * t2 + t, c = 3 * t2 - 2 * t3, d = t3 - t2;
    const float *const p = mesh.from().data(), *const q = mesh.to().data(), *const v = from_velocities.data(),
                       *const w = to_velocities.data();
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = a * p[i] + b * v[i] + c * q[i] + d * w[i];
  }
  [[nodiscard]] VectorView<const float> moved() const {
    return VectorView<const float>::packed(positions.data(), positions.size() / 3);
  }
};

// The normals of the vertices that the oracle knows, from positions by Hermite's polynomials in double.
std::vector<Vector> right_normals(const Curved& curved, const Oracle& oracle) {
  const double t = double{kTime},
               h[] = {(1 + 2 * t) * (1 - t) * (1 - t), t * (1 - t) * (1 - t), t * t * (3 - 2 * t), t * t * (t - 1)};
  const auto place = [&](std::size_t v) {
    Vector p;
    for (std::size_t c = 0; c < 3; ++c)
      p[c] = h[0] * double{curved.mesh.from()[3 * v + c]} + h[1] * double{curved.from_velocities[3 * v + c]} +
             h[2] * double{curved.mesh.to()[3 * v + c]} + h[3] * double{curved.to_velocities[3 * v + c]};
    return p;
  };
  std::vector<Vector> all(curved.count(), Vector{});
  const auto corners = curved.mesh.topology().corners();
  for (std::size_t f = 0; f < corners.size(); f += 3) {
    const Vector a = place(corners[f]), b = place(corners[f + 1]), c = place(corners[f + 2]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const double n = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
      for (std::size_t corner = 0; corner < 3; ++corner) all[corners[f + corner]][i] += n;
    }
  }
  std::vector<Vector> known;
  for (const std::uint32_t v : oracle.elements()) known.push_back(all[v]);
  return known;
}

}  // namespace

void run_curved(Suite& suite, const Size& size) {
  const std::string group = "curved paths";
  CaseList list(suite, group, size);
  suite.say(fmt::format("{}, {}, {}: mesh", group, size.name, size.order()));
  const Mesh mesh(Elements::kVertices, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kVertices);
  const auto curved = std::make_shared<Curved>(mesh);
  const auto on_path = [curved](const Oracle& of) { return right_normals(*curved, of); };
  const auto made = [&](const std::string& name, const std::string& note, double limit, std::function<void()> run,
                        std::size_t threads = 1) {
    list.add(name, [&] {
      Case one;
      one.note = note;
      one.threads = threads;
      one.run = std::move(run);
      one.checks = {packed_check(double{kTime}, curved->result.data())};
      one.checks[0].expected = on_path;
      one.limit = limit;
      return one;
    });
  };
  const std::size_t all = suite.options().threads;
  const double limit = 2 * float_limit(mesh.count(Elements::kVertices));

  const auto curves = std::make_shared<PathCurves>(curved->normals, Threads::kAll);
  made("degree 6 to float3", "84 bytes an element", 1.1 * kPathAngle,
       [=] { (void)curves->unit_normals(double{kTime}, curved->packed_result()); });
  made(
      "degree 6 to float3, many threads", "", 1.1 * kPathAngle,
      [=] { (void)curves->unit_normals(double{kTime}, curved->packed_result(), Threads::kAll); }, all);
  made("degree 6 in double", "unit_normal_at() of the same control normals", kPathAngle, [=] {
    for (std::size_t i = 0; i < curved->count(); ++i)
      curved->packed_result().set(i, to_float(unit_normal_at(curved->normals[i], double{kTime}).vector));
  });
  made("move, then recompute in float32", "cubics of positions, then FloatRecompute", limit,
       [=, recompute = std::make_shared<FloatRecompute>(mesh.topology(), curved->groups)] {
         curved->move(kTime);
         (void)recompute->unit_normals(curved->moved(), curved->packed_result());
       });
  made("move, then recompute", "cubics of positions in float32, then NormalRecompute", limit,
       [=, recompute = std::make_shared<NormalRecompute>(
               Segment{&mesh.topology(), curved->moved(), curved->moved(), 0, 1, 0}, curved->groups)] {
         curved->move(kTime);
         (void)recompute->unit_normals(0, curved->packed_result());
       });
  list.add("degree 2 to float3", [&] {
    const auto straight =
        std::make_shared<NormalCurves>(NormalCurves::of_groups(mesh.segment(), curved->groups, {}, Threads::kAll));
    Case one;
    one.note = "the straight path, for scale";
    one.run = [=] { (void)straight->unit_normals(double{kTime}, curved->packed_result()); };
    one.checks = {packed_check(double{kTime}, curved->result.data())};
    one.limit = kExactTolerance;
    return one;
  });
  made(
      "prepare degree 6", "on all cores: control normals and curves, from the path", 1.1 * kPathAngle,
      [=] {
        const PathCurves fresh(all_path_normals(curved->path, curved->groups));
        (void)fresh.unit_normals(double{kTime}, curved->packed_result());
      },
      all);
  suite.run(group, size, curved->count(), oracle, list.take());
}

}  // namespace chronormal::bench
