// Measures the errors of all paths (ways to compute normals) against normals that are computed in double: on a grid, on
// the same grid far from the origin, and on the built-in morphs.

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_curves.h"
#include "groups/groups.h"
#include "normals/recompute/recompute.h"

namespace chronormal::bench {
namespace {

constexpr std::size_t kSamples = 20, kQuickSamples = 3;  // number of steps of t
constexpr std::size_t kGridFaces = 20000;
constexpr float kFar = 1000;  // distance from the origin, in multiples of the radius of the ring

// The error bounds in radians that normals/normal_curves.h promises.
constexpr double kOctahedralBound = 7e-5, kRgb10A2Bound = 1.7e-3;

// A way to compute the unit normals of all elements. evaluate() computes the normals at t, where `sample` is the index
// of this t. normal_of() returns the normal of one element from the last call of evaluate().
struct Path {
  std::string name;
  double bound = 0, bytes = 0;
  std::function<void(std::size_t sample, double t)> evaluate;
  std::function<Vector(std::size_t element)> normal_of;
  std::vector<double> errors = {};
};

struct Subject {
  const Segment* segment = nullptr;
  const NormalGroups* groups = nullptr;
  std::size_t count = 0, samples = 0;

  [[nodiscard]] std::shared_ptr<NormalCurves> curves(double tolerance) const {
    const CurveOptions options{tolerance};
    return std::make_shared<NormalCurves>(groups == nullptr
                                              ? NormalCurves::of_faces(*segment, options, Threads::kAll)
                                              : NormalCurves::of_groups(*segment, *groups, options, Threads::kAll));
  }
};

// Makes a Path that writes normals to memory as three floats each.
Path float_path(const Subject& subject, std::string name, double bound, double bytes,
                std::function<void(std::size_t, double, VectorView<float>)> evaluate) {
  auto memory = std::make_shared<std::vector<float>>(3 * subject.count);
  const auto view = VectorView<float>::packed(memory->data(), subject.count);
  return {std::move(name), bound, bytes,
          [memory, view, evaluate = std::move(evaluate)](std::size_t sample, double t) { evaluate(sample, t, view); },
          [memory, view](std::size_t element) {
            const Vec3f n = view[element];
            return Vector{double{n.x}, double{n.y}, double{n.z}};
          }};
}

template <class Encoded>
Path encoded_path(const Subject& subject, std::string name, double bound, double bytes,
                  const std::shared_ptr<NormalCurves>& curves) {
  auto memory = std::make_shared<std::vector<Encoded>>(subject.count);
  return {std::move(name), bound, bytes,
          [memory, curves](std::size_t, double t) { (void)curves->unit_normals(t, std::span<Encoded>(*memory)); },
          [memory](std::size_t element) {
            const Vec3f n = decode((*memory)[element]);
            return Vector{double{n.x}, double{n.y}, double{n.z}};
          }};
}

std::vector<Path> make_paths(const Subject& subject) {
  std::vector<Path> paths;
  const auto per_element = [&subject](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(subject.count);
  };
  const auto exact = subject.curves(kExactTolerance);
  paths.push_back(
      float_path(subject, "exact to float3", kExactTolerance, per_element(exact->bytes()),
                 [exact](std::size_t, double t, VectorView<float> result) { (void)exact->unit_normals(t, result); }));
  for (const double tolerance : {1e-4, kCompactTolerance, 1e-2}) {
    const auto compact = subject.curves(tolerance);
    paths.push_back(float_path(
        subject, fmt::format("compact {:g} to float3", tolerance), tolerance, per_element(compact->bytes()),
        [compact](std::size_t, double t, VectorView<float> result) { (void)compact->unit_normals(t, result); }));
    if (tolerance == kCompactTolerance)
      paths.push_back(encoded_path<Octahedral>(subject, fmt::format("compact {:g} to octahedral", tolerance),
                                               tolerance + kOctahedralBound, per_element(compact->bytes()), compact));
  }
  const double bytes = per_element(exact->bytes());
  paths.push_back(
      encoded_path<Octahedral>(subject, "exact to octahedral", kExactTolerance + kOctahedralBound, bytes, exact));
  paths.push_back(encoded_path<Rgb10A2>(subject, "exact to rgb10a2", kExactTolerance + kRgb10A2Bound, bytes, exact));
  const auto rival = subject.groups == nullptr ? std::make_shared<NormalRecompute>(*subject.segment)
                                               : std::make_shared<NormalRecompute>(*subject.segment, *subject.groups);
  paths.push_back(
      float_path(subject, "recompute", kExactTolerance, 0,
                 [rival](std::size_t, double t, VectorView<float> result) { (void)rival->unit_normals(t, result); }));
  return paths;
}

void measure(const Suite& suite, const std::string& mesh, const Segment& segment, Elements elements,
             std::vector<Accuracy>& result) {
  const std::string kind = elements == Elements::kFaces ? "faces" : "vertices";
  if (!suite.wants("accuracy", {mesh, 0, false}, kind)) return;
  suite.say(fmt::format("accuracy, {}, {}", mesh, kind));
  std::optional<NormalGroups> groups;
  const Topology& topology = *segment.topology;
  if (elements == Elements::kVertices)
    groups = NormalGroups::of_vertices(topology, separate_points(topology.vertex_count()));
  const Subject subject{&segment, groups ? &*groups : nullptr, groups ? groups->size() : topology.face_count(),
                        suite.options().quick ? kQuickSamples : kSamples};
  const Oracle oracle(segment, elements);
  std::vector<Path> paths = make_paths(subject);
  for (std::size_t sample = 0; sample <= subject.samples; ++sample) {
    const double t = static_cast<double>(sample) / static_cast<double>(subject.samples);
    const std::vector<Vector> exact = oracle.normals(t);
    for (Path& path : paths) {
      path.evaluate(sample, t);
      const Errors errors = oracle.errors(exact, path.normal_of);
      path.errors.insert(path.errors.end(), errors.sorted.begin(), errors.sorted.end());
    }
  }
  for (Path& path : paths) {
    std::sort(path.errors.begin(), path.errors.end());
    const Errors errors{std::move(path.errors)};
    if (!(errors.max() <= path.bound))
      throw std::runtime_error(fmt::format("accuracy, {}, {}: '{}' is off by {:.3g} rad, and promises {:.3g}", mesh,
                                           kind, path.name, errors.max(), path.bound));
    result.push_back({path.name, mesh, kind, path.bound, errors.mean(), errors.quantile(0.9999), errors.max(),
                      errors.sorted.size(), path.bytes});
  }
}

}  // namespace

std::vector<Accuracy> measure_accuracy(const Suite& suite) {
  std::vector<Accuracy> result;
  const auto both = [&](const std::string& name, const Segment& segment) {
    measure(suite, name, segment, Elements::kFaces, result);
    measure(suite, name, segment, Elements::kVertices, result);
  };
  const Mesh grid(Elements::kFaces, kGridFaces, false);
  both("grid", grid.segment());
  std::vector<float> from(grid.from().begin(), grid.from().end()), to(grid.to().begin(), grid.to().end());
  for (std::vector<float>* const positions : {&from, &to}) {
    for (float& value : *positions) value += kFar;
  }
  Segment far = grid.segment();
  far.from = VectorView<const float>::packed(from.data(), from.size() / 3);
  far.to = VectorView<const float>::packed(to.data(), to.size() / 3);
  both("grid, far away", far);
  for (const BuiltinMorph& morph : builtin_morphs()) {
    const Motion motion = make_builtin_morph(morph.name).value();
    both(std::string(morph.name), motion.segment(0));
  }
  return result;
}

}  // namespace chronormal::bench
