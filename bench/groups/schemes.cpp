// Measures every scheme on the faces of the grid: the time of an evaluation at one t and in playback with small
// steps, and the errors of the normals.

#include "chronormal/schemes/scheme.h"

#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/compare.h"
#include "groups/groups.h"

namespace chronormal::bench {
namespace {

// Limits of errors in radians. Schemes that follow the exact curve must agree with this curve up to rounding, and
// schemes that interpolate exact normals must agree with their formula up to the rounding of float32. All other schemes
// are checked for gross mistakes only.
constexpr double kExactError = 1e-6, kFormulaError = 2e-6, kApproximationError = 0.8, kPlayedError = 5e-5;
constexpr std::size_t kSteps = 1024;

Vector unit_of(const Vector& n) {
  const double size = std::hypot(n[0], n[1], n[2]);
  return {n[0] / size, n[1] / size, n[2] / size};
}

// Evaluates the polynomial through the unit normals at `nodes` + 1 equally spaced values of t, by Neville's recursion.
std::vector<Vector> through_nodes(const Oracle& oracle, std::size_t nodes, double t) {
  std::vector<std::vector<Vector>> at(nodes + 1);
  for (std::size_t i = 0; i <= nodes; ++i) {
    at[i] = oracle.normals(static_cast<double>(i) / static_cast<double>(nodes));
    for (Vector& n : at[i]) n = unit_of(n);
  }
  const double x = t * static_cast<double>(nodes);
  for (std::size_t level = 1; level <= nodes; ++level) {
    for (std::size_t i = 0; i + level <= nodes; ++i) {
      const double first = static_cast<double>(i), width = static_cast<double>(level);
      for (std::size_t e = 0; e < at[i].size(); ++e) {
        for (std::size_t c = 0; c < 3; ++c)
          at[i][e][c] = ((first + width - x) * at[i][e][c] + (x - first) * at[i + 1][e][c]) / width;
      }
    }
  }
  return at[0];
}

std::vector<Vector> along_great_circle(const Oracle& oracle, double t) {
  std::vector<Vector> result = oracle.normals(0), end = oracle.normals(1);
  for (std::size_t e = 0; e < result.size(); ++e) {
    const Vector a = unit_of(result[e]), b = unit_of(end[e]);
    const double between = angle(a, b);
    const double from = between > 1e-9 ? std::sin((1 - t) * between) : 1 - t;
    const double to = between > 1e-9 ? std::sin(t * between) : t;
    for (std::size_t c = 0; c < 3; ++c) result[e][c] = from * a[c] + to * b[c];
  }
  return result;
}

struct Expectation {
  // A function that returns the expected normals. If the function is empty, the exact normals are expected.
  std::function<std::vector<Vector>(const Oracle&)> expected;
  double limit = kApproximationError;
  std::string note;
};

Expectation expectation(const std::string& scheme, double t) {
  if (scheme == "polynomial" || scheme == "rational" || scheme == "recompute") return {{}, kExactError, ""};
  if (scheme == "slerp")
    return {[t](const Oracle& oracle) { return along_great_circle(oracle, t); }, kFormulaError, "against its formula"};
  std::size_t nodes = scheme == "linear" ? 1 : scheme == "quadratic" ? 2 : scheme == "cubic" ? 3 : 0;
  const std::string prefix = "lagrange:";
  if (scheme.starts_with(prefix)) std::from_chars(scheme.data() + prefix.size(), scheme.data() + scheme.size(), nodes);
  if (nodes > 0)
    return {[nodes, t](const Oracle& oracle) { return through_nodes(oracle, nodes, t); }, kFormulaError,
            "against its formula"};
  return {{}, kApproximationError, "an approximation"};
}

struct Prepared {
  std::unique_ptr<Scheme> scheme;
  std::unique_ptr<SchemePlayback> playback;
  std::size_t step = kSteps;
};

}  // namespace

std::vector<std::string> benchmark_schemes() {
  return {"linear",        "quadratic",         "cubic",
          "lagrange:4",    "linear:scaled",     "slerp",
          "decasteljau:4", "quaternion:matrix", "quaternion:optimal",
          "circle",        "circle:timed",      "rational",
          "polynomial",    "recompute"};
}

void run_schemes(Suite& suite, const Size& size) {
  const std::string group = "schemes";
  CaseList list(suite, group, size);
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Segment segment = mesh.segment();
  const Oracle oracle(segment, Elements::kFaces);
  const std::size_t count = mesh.count(Elements::kFaces);
  const std::vector<ControlNormals> normals = all_face_control_normals(segment);
  AlignedArray<float> memory(3 * count);
  const VectorView<float> result = VectorView<float>::packed(memory.data(), count);
  const double t = double{kTime};

  for (const std::string& name : benchmark_schemes()) {
    std::shared_ptr<Prepared> prepared;
    const auto prepare_once = [&] {
      if (prepared) return;
      prepared = std::make_shared<Prepared>();
      prepared->scheme = make_scheme(name).value();
      prepared->scheme->prepare({&segment, {0, count}, normals});
    };
    list.add(name, [&] {
      prepare_once();
      Expectation expected = expectation(name, t);
      Case one;
      one.run = [prepared, result, t] { (void)prepared->scheme->evaluate(t, result); };
      one.checks = {packed_check(t, memory.data())};
      one.checks[0].expected = std::move(expected.expected);
      one.limit = expected.limit, one.note = expected.note;
      one.bytes_read = prepared->scheme->bytes(), one.bytes_written = 12 * count;
      return one;
    });
    if (!list.wants(name + ", played")) continue;
    prepare_once();
    if (prepared->scheme->play(0, 1.0 / kSteps, kDefaultAnchorInterval) == nullptr) continue;
    list.add(name + ", played", [&] {
      const auto step = [prepared, result] {
        if (prepared->step == kSteps) {
          prepared->playback = prepared->scheme->play(0, 1.0 / kSteps, kDefaultAnchorInterval);
          prepared->step = 0;
        }
        (void)prepared->playback->next(result);
        ++prepared->step;
      };
      const double at = static_cast<double>(kDefaultAnchorInterval - 1) / kSteps;
      Expectation expected = expectation(name, at);
      Case one;
      one.evaluations = kDefaultAnchorInterval;
      one.run = [step] {
        for (std::size_t i = 0; i < kDefaultAnchorInterval; ++i) step();
      };
      one.checks = {packed_check(at, memory.data())};
      one.checks[0].expected = std::move(expected.expected);
      one.limit = std::max(expected.limit, kPlayedError), one.note = expected.note;
      return one;
    });
  }
  suite.run(group, size, count, oracle, list.take());
}

std::vector<SchemeQuality> scheme_qualities() {
  std::vector<SchemeQuality> qualities;
  const auto add = [&qualities](const std::string& name, const Motion& motion) {
    CompareOptions options;
    options.schemes = benchmark_schemes();
    const Result<Comparison> compared = compare(motion, options);
    if (!compared) throw std::runtime_error(compared.error().text());
    for (const SchemeComparison& one : compared.value().schemes)
      qualities.push_back(
          {one.scheme, name, one.quality.mean() * kDegreesPerRadian, one.quality.max * kDegreesPerRadian, one.bytes});
  };
  add("twist", make_builtin_morph("twist").value());
  const Mesh mesh(Elements::kFaces, 15000, false);
  Motion grid{mesh.topology(), std::vector<Motion::Keyframe>(2), {}};
  grid.keyframes[0].positions.assign(mesh.from().begin(), mesh.from().end());
  grid.keyframes[1].positions.assign(mesh.to().begin(), mesh.to().end());
  grid.keyframes[1].time = 1;
  grid.connect_as_sequence();
  add("grid", grid);
  return qualities;
}

}  // namespace chronormal::bench
