// Section 4: motion that is not straight, exact and cut into straight pieces.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

constexpr std::array<std::size_t, 4> kPieces = {2, 4, 8, 16};
constexpr std::size_t kSamples = 64;  // steps in which the error is sampled

// A motion of degree K over one mesh.
template <std::size_t K>
struct Curved {
  const char* name;
  Topology topology;
  PolynomialSegment<K> segment;
  NormalGroups groups;
};

VectorView<const float> view(const std::vector<float>& packed) {
  return VectorView<const float>::packed(packed.data(), packed.size() / 3);
}

// a times the one, plus b times the other, and so on.
std::vector<float> combined(const std::vector<std::pair<double, const std::vector<float>*>>& terms) {
  std::vector<float> result;
  for (std::size_t i = 0; i < terms[0].second->size(); ++i) {
    double sum = 0;
    for (const auto& [factor, values] : terms) sum += factor * static_cast<double>((*values)[i]);
    result.push_back(static_cast<float>(sum));
  }
  return result;
}

// Positions of twist as it would turn, not as its vertices move straight, with their first and second derivative: each
// height z (of 3) turns about the axis by its share of 120 degrees.
struct Turning {
  std::vector<float> positions, velocities, accelerations;
};
Turning turning(const std::vector<float>& at_rest, double t) {
  Turning result;
  for (std::size_t i = 0; i < at_rest.size(); i += 3) {
    const double x = at_rest[i], y = at_rest[i + 1], z = at_rest[i + 2];
    const double speed = 2.0943951023931953 * z / 3, c = std::cos(speed * t), s = std::sin(speed * t);
    const Vec3d p{c * x - s * y, s * x + c * y, z}, turned{-p.y, p.x, 0}, inwards{-p.x, -p.y, 0};
    for (auto& [to, value] : {std::pair{&result.positions, p}, std::pair{&result.velocities, speed * turned},
                              std::pair{&result.accelerations, speed * speed * inwards}})
      to->insert(to->end(), {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z)});
  }
  return result;
}

template <std::size_t K>
void finish(Curved<K>& curved) {
  curved.groups = NormalGroups::of_vertices(curved.topology, separate_points(curved.topology.vertex_count()));
  curved.segment.topology = &curved.topology;
}

// Velocity and acceleration of a keyframe of cloth by its neighbours; those of twist as it turns.
std::array<Curved<2>, 2> accelerated() {
  const Motion cloth = make_builtin_morph("cloth").value(), twist = make_builtin_morph("twist").value();
  const auto& k = cloth.keyframes;
  const auto velocities = combined({{0.5, &k[2].positions}, {-0.5, &k[0].positions}});
  const auto accelerations = combined({{1, &k[2].positions}, {-2, &k[1].positions}, {1, &k[0].positions}});
  const Turning start = turning(twist.keyframes[0].positions, 0);
  return {
      Curved<2>{"cloth",
                cloth.topology,
                accelerated_segment(cloth.topology, view(k[1].positions), view(velocities), view(accelerations), 0, 1),
                {}},
      Curved<2>{"twist",
                twist.topology,
                accelerated_segment(twist.topology, view(start.positions), view(start.velocities),
                                    view(start.accelerations), 0, 0.5),
                {}}};
}

std::array<Curved<3>, 2> hermite() {
  const Motion cloth = make_builtin_morph("cloth").value(), twist = make_builtin_morph("twist").value();
  const auto& k = cloth.keyframes;
  const auto first = combined({{0.5, &k[2].positions}, {-0.5, &k[0].positions}});
  const auto second = combined({{0.5, &k[3].positions}, {-0.5, &k[1].positions}});
  const Turning start = turning(twist.keyframes[0].positions, 0), end = turning(twist.keyframes[0].positions, 1);
  return {Curved<3>{"cloth",
                    cloth.topology,
                    hermite_segment(cloth.topology, view(k[1].positions), view(first), view(k[2].positions),
                                    view(second), 0, 1),
                    {}},
          Curved<3>{"twist",
                    twist.topology,
                    hermite_segment(twist.topology, view(start.positions), view(start.velocities), view(end.positions),
                                    view(end.velocities), 0, 1),
                    {}}};
}

template <std::size_t K>
std::vector<Vec3d> vertices_at(const PolynomialSegment<K>& segment, double t) {
  std::vector<Vec3d> result;
  for (std::size_t v = 0; v < segment.control[0].size(); ++v) {
    Bernstein<Vec3d, K> curve;
    for (std::size_t k = 0; k <= K; ++k) curve[k] = segment.control[k][v];
    result.push_back(evaluate(curve, t));
  }
  return result;
}

// The truth: area-weighted normals from the positions at t, in double.
template <std::size_t K>
std::vector<Vec3d> recomputed(const Curved<K>& curved, double t) {
  const std::vector<Vec3d> p = vertices_at(curved.segment, t);
  std::vector<Vec3d> result(p.size());
  for (std::size_t f = 0; f < curved.topology.face_count(); ++f) {
    const auto face = curved.topology.face(f);
    const Vec3d n = cross(p[face[1]] - p[face[0]], p[face[2]] - p[face[0]]);
    for (const std::uint32_t v : face) result[v] = result[v] + n;
  }
  return result;
}

template <std::size_t K>
Motion cut(const Curved<K>& curved, std::size_t pieces) {
  Motion motion;
  motion.topology = curved.topology;
  for (std::size_t i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(pieces);
    Motion::Keyframe keyframe{{}, t, {}};
    for (const Vec3d& p : vertices_at(curved.segment, t)) {
      const Vec3f rounded = to_float(p);
      keyframe.positions.insert(keyframe.positions.end(), {rounded.x, rounded.y, rounded.z});
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

struct Result {
  double mean = 0, largest = 0;                      // degrees
  double bytes = 0;                                  // per vertex
  double prepare = 0, evaluate = 0;                  // nanoseconds per vertex
  std::vector<std::pair<double, double>> over_time;  // t, largest error
};

double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

// Holds normals at every sample against the truth. at(t, result) writes unit normals of all vertices.
template <std::size_t K, class At>
void compare(const Curved<K>& curved, const std::vector<std::vector<Vec3d>>& truth, At at, Result& result) {
  const std::size_t count = curved.groups.size();
  std::vector<Vec3d> normals(count);
  for (std::size_t i = 0; i <= kSamples; ++i) {
    const double t = static_cast<double>(i) / kSamples;
    const auto start = std::chrono::steady_clock::now();
    at(t, normals);
    result.evaluate += since(start) / static_cast<double>(count * (kSamples + 1));
    double worst = 0;
    for (std::size_t v = 0; v < count; ++v) {
      const double angle = angle_between(normals[v], truth[i][v]) * kDegreesPerRadian;
      result.mean += angle / static_cast<double>(count * (kSamples + 1));
      worst = std::max(worst, angle);
    }
    result.largest = std::max(result.largest, worst);
    result.over_time.emplace_back(t, worst);
  }
}

template <std::size_t K>
Result exact(const Curved<K>& curved, const std::vector<std::vector<Vec3d>>& truth) {
  Result result;
  const std::size_t faces = curved.topology.face_count(), count = curved.groups.size();
  const auto start = std::chrono::steady_clock::now();
  std::vector<PolynomialNormals<K>> of_faces(faces), of_vertices(count);
  polynomial_face_normals<K>(curved.segment, {0, faces}, of_faces);
  polynomial_group_normals<K>(curved.groups, of_faces, {0, count}, of_vertices);
  result.prepare = since(start) / static_cast<double>(count);
  result.bytes = sizeof(PolynomialNormals<K>);
  compare(
      curved, truth,
      [&](double t, std::vector<Vec3d>& normals) {
        for (std::size_t v = 0; v < count; ++v) normals[v] = unit_normal_at(of_vertices[v], t).vector;
      },
      result);
  return result;
}

template <std::size_t K>
Result in_pieces(const Curved<K>& curved, std::size_t pieces, const std::vector<std::vector<Vec3d>>& truth) {
  Result result;
  const Motion motion = cut(curved, pieces);
  const std::size_t faces = curved.topology.face_count(), count = curved.groups.size();
  const auto start = std::chrono::steady_clock::now();
  std::vector<NormalCurves> curves;
  std::size_t bytes = 0;
  for (std::size_t s = 0; s < pieces; ++s) {
    std::vector<ControlNormals> of_faces(faces), of_vertices(count);
    face_control_normals(motion.segment(s), {0, faces}, of_faces);
    group_control_normals(curved.groups, of_faces, {0, count}, of_vertices);
    curves.emplace_back(of_vertices);
    bytes += curves.back().bytes();
  }
  result.prepare = since(start) / static_cast<double>(count);
  result.bytes = static_cast<double>(bytes) / static_cast<double>(count);

  std::vector<float> packed(3 * count);
  const auto planes = VectorView<float>::planes(packed.data(), packed.data() + count, packed.data() + 2 * count, count);
  double evaluate = 0;
  compare(
      curved, truth,
      [&](double t, std::vector<Vec3d>& normals) {
        const std::size_t piece = std::min(static_cast<std::size_t>(t * static_cast<double>(pieces)), pieces - 1);
        const auto begin = std::chrono::steady_clock::now();
        (void)curves[piece].unit_normals(t * static_cast<double>(pieces) - static_cast<double>(piece), planes);
        evaluate += since(begin) / static_cast<double>(count * (kSamples + 1));
        for (std::size_t v = 0; v < count; ++v) normals[v] = to_double(planes[v]);
      },
      result);
  result.evaluate = evaluate;  // without the copy into doubles
  return result;
}

struct Tables {
  std::vector<Cells> errors, times;
  std::vector<Panel> panels;
  double exact_largest = 0;
  std::vector<double> gains;   // of twice as many pieces
  double least_bytes = 1e300;  // of pieces, relative to the exact curve
};

template <std::size_t K>
void add_rows(Curved<K>& curved, Tables& tables) {
  finish(curved);
  std::vector<std::vector<Vec3d>> truth;
  for (std::size_t i = 0; i <= kSamples; ++i) truth.push_back(recomputed(curved, static_cast<double>(i) / kSamples));

  const std::string motion = fmt::format("{}, {}", curved.name, K == 2 ? "accelerated" : "Hermite");
  const auto add = [&](const std::string& way, const Result& result) {
    tables.errors.push_back({fmt::format("{}: {}", motion, way), degrees(result.mean, 1), degrees(result.largest, 1),
                             grouped(result.bytes)});
    tables.times.push_back({fmt::format("{}: {}", motion, way), grouped(result.prepare), grouped(result.evaluate)});
  };
  const Result curve = exact(curved, truth);
  add(fmt::format("exact, degree {}", 2 * K), curve);
  tables.exact_largest = std::max(tables.exact_largest, curve.largest);

  constexpr std::array kColours = {Colour::kRed, Colour::kOrange, Colour::kGreen, Colour::kBlue};
  Panel panel;
  panel.title = motion;
  panel.x = {"t", 0, 1.3, false, {{0, "0"}, {0.25, "0.25"}, {0.5, "0.5"}, {0.75, "0.75"}, {1, "1"}}};
  panel.y = {"largest error, degrees", 1e-3, 10, true, {}};
  double before = 0;
  for (std::size_t p = 0; p < kPieces.size(); ++p) {
    const Result pieces = in_pieces(curved, kPieces[p], truth);
    add(fmt::format("{} pieces", kPieces[p]), pieces);
    if (p > 0) tables.gains.push_back(before / pieces.largest);
    before = pieces.largest;
    if (kPieces[p] >= 8) tables.least_bytes = std::min(tables.least_bytes, pieces.bytes / curve.bytes);
    Series series{fmt::format("{} pieces", kPieces[p]), pieces.over_time, kColours[p], 1.6, false, Mark::kNone};
    for (auto& point : series.points) point.second = std::max(point.second, 1e-3);
    const auto last = static_cast<std::ptrdiff_t>(kSamples / (2 * kPieces[p]));  // the top of the last arch
    panel.labels.push_back({series.title, 1.03, (series.points.end() - 1 - last)->second, kColours[p]});
    panel.series.push_back(std::move(series));
  }
  tables.panels.push_back(std::move(panel));
}

}  // namespace

void measure_curves(Page& page) {
  Tables tables;
  auto quadratics = accelerated();
  auto cubics = hermite();
  for (auto& curved : quadratics) add_rows(curved, tables);
  for (auto& curved : cubics) add_rows(curved, tables);
  require(tables.exact_largest < 1e-9, "the exact curve is exact");
  require(tables.least_bytes > 1, "eight pieces take more memory than the exact curve");
  page.table("pieces", {"motion", "mean", "max", "bytes"}, tables.errors);
  page.table("piece_times", {"motion", "prepare", "evaluate"}, tables.times);
  page.picture("pieces_picture", {"weightings_pieces", 900, 640, 2, tables.panels});
  page.set({{"curve_samples", grouped(kSamples + 1)},
            {"least_gain", fmt::format("{:.1f}", smallest(tables.gains))},
            {"most_gain", fmt::format("{:.1f}", largest(tables.gains))}});
}

}  // namespace chronormal::weightings
