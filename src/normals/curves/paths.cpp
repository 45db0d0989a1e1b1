// Computes velocities at keyframes, cubics through them, and the control normals of faces on them.
#include "chronormal/normals/paths.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "core/rounding.h"
#include "core/vector_area.h"
#include "normals/control/local_time.h"
#include "normals/curves/path_stream.h"
#include "normals/curves/path_sums.h"

namespace chronormal {
namespace {

// The error of de Casteljau's algorithm in degree up to 6, and of the control normals.
constexpr double kError = 32 * kUnitRoundoff;

template <std::size_t K>
PolynomialSegment<K> empty_segment(const Topology& topology, double start_time, double end_time) {
  PolynomialSegment<K> segment;
  segment.topology = &topology;
  segment.start_time = start_time;
  segment.end_time = end_time;
  for (auto& control : segment.control) control.resize(topology.vertex_count());
  return segment;
}

template <std::size_t K>
Bernstein<Vec3d, K> edge(const PolynomialSegment<K>& segment, std::uint32_t from, std::uint32_t to) {
  Bernstein<Vec3d, K> result;
  for (std::size_t k = 0; k <= K; ++k) result[k] = segment.control[k][to] - segment.control[k][from];
  return result;
}

VectorView<const float> packed(const std::vector<float>& numbers) {
  return VectorView<const float>::packed(std::span(numbers));
}

// The velocities of all vertices at key i, as Catmull and Rom have them.
std::vector<float> curve_velocities(std::span<const Motion::Keyframe* const> keys, std::size_t i) {
  std::vector<double> times;
  for (const Motion::Keyframe* key : keys) times.push_back(key->time);
  const VelocityShares velocity = velocity_shares(times, i);
  std::vector<std::span<const float>> positions;
  for (std::size_t k = 0; k < velocity.share.size(); ++k) positions.emplace_back(keys[velocity.first + k]->positions);
  return velocities_of(velocity, positions);
}

std::vector<const Motion::Keyframe*> pointers_to(const std::vector<Motion::Keyframe>& keyframes) {
  std::vector<const Motion::Keyframe*> keys;
  keys.reserve(keyframes.size());
  for (const Motion::Keyframe& keyframe : keyframes) keys.push_back(&keyframe);
  return keys;
}

// The first of the control normals, from the end that is asked for, that is not rounding; zero if there is none.
template <class Iterator>
Vec3d first_direction(Iterator begin, Iterator end, double error) {
  const auto found = std::find_if(begin, end, [error](const Vec3d& n) { return max_abs(n) > error; });
  return found == end ? Vec3d{} : unit(*found);
}

}  // namespace

PolynomialSegment<2> accelerated_segment(const Topology& topology, VectorView<const float> positions,
                                         VectorView<const float> velocities, VectorView<const float> accelerations,
                                         double start_time, double end_time) {
  const std::size_t count = topology.vertex_count();
  assert(positions.count == count && velocities.count == count && accelerations.count == count);
  PolynomialSegment<2> segment = empty_segment<2>(topology, start_time, end_time);
  const double duration = end_time - start_time;
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3d p = to_double(positions[v]), step = duration * to_double(velocities[v]);
    segment.control[0][v] = p;
    segment.control[1][v] = p + 0.5 * step;
    segment.control[2][v] = p + step + (0.5 * duration * duration) * to_double(accelerations[v]);
  }
  return segment;
}

PolynomialSegment<3> hermite_segment(const Topology& topology, VectorView<const float> from,
                                     VectorView<const float> from_velocities, VectorView<const float> to,
                                     VectorView<const float> to_velocities, double start_time, double end_time) {
  const std::size_t count = topology.vertex_count();
  assert(from.count == count && from_velocities.count == count && to.count == count && to_velocities.count == count);
  PolynomialSegment<3> segment = empty_segment<3>(topology, start_time, end_time);
  const double third = (end_time - start_time) / 3;
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3d p0 = to_double(from[v]), p1 = to_double(to[v]);
    segment.control[0][v] = p0;
    segment.control[1][v] = p0 + third * to_double(from_velocities[v]);
    segment.control[2][v] = p1 - third * to_double(to_velocities[v]);
    segment.control[3][v] = p1;
  }
  return segment;
}

std::string_view path_name(PathKind kind) noexcept {
  return kind == PathKind::kLinear ? "linear" : kind == PathKind::kCatmullRom ? "catmull-rom" : "hermite";
}

Result<PathKind> make_path(std::string_view name) {
  for (const PathKind kind : {PathKind::kLinear, PathKind::kCatmullRom, PathKind::kHermite})
    if (name == path_name(kind)) return kind;
  return Error{ErrorCode::kUsage, "",
               std::string("there is no path '").append(name).append("'; there are linear, catmull-rom, hermite")};
}

const std::vector<float>& given_velocities(const Motion::Keyframe& keyframe, PathKind kind) noexcept {
  static const std::vector<float> kNone;
  if (kind == PathKind::kLinear) return kNone;
  return kind == PathKind::kHermite && !keyframe.velocities.empty() ? keyframe.velocities : keyframe.end_velocities;
}

std::vector<float> internal::velocities_of(const VelocityShares& velocity,
                                           std::span<const std::span<const float>> positions) {
  std::vector<float> result(positions[0].size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    double sum = 0;
    for (std::size_t k = 0; k < velocity.share.size(); ++k)
      sum += velocity.share[k] * static_cast<double>(positions[k][c]);
    result[c] = static_cast<float>(sum);
  }
  return result;
}

Status check_path(const Motion& motion, PathKind kind) {
  if (kind == PathKind::kLinear) return Success{};
  const auto refuse = [](const char* message) { return Error{ErrorCode::kUsage, "", message}; };
  if (motion.kind != MotionKind::kSequence)
    return refuse(
        "only the keyframes of a sequence have curved paths between them: weights of targets move vertices straight");
  const bool has_velocities =
      std::any_of(motion.keyframes.begin(), motion.keyframes.end(),
                  [](const Motion::Keyframe& keyframe) { return !keyframe.velocities.empty(); });
  if (kind == PathKind::kHermite && !has_velocities)
    return refuse("no keyframe has velocities, which hermite paths need: catmull-rom takes them from the positions");
  return Success{};
}

// The derivative at a key of the polynomial through it and its neighbours, in Lagrange form.
VelocityShares velocity_shares(std::span<const double> times, std::size_t at) {
  const bool is_end = at == 0 || at + 1 == times.size();
  const std::size_t used = std::min<std::size_t>(is_end ? 4 : 3, times.size());
  const std::size_t first = at == 0 ? 0 : is_end ? times.size() - used : at - 1;
  const std::span<const double> nodes = times.subspan(first, used);
  const std::size_t here = at - first;
  VelocityShares result{first, std::vector<double>(used, 0.0)};
  for (std::size_t i = 0; i < used; ++i) {
    if (i == here) continue;
    const double apart = nodes[here] - nodes[i];
    result.share[here] += 1 / apart;
    result.share[i] = -1 / apart;
    for (std::size_t k = 0; k < used; ++k)
      if (k != i && k != here) result.share[i] *= (nodes[here] - nodes[k]) / (nodes[i] - nodes[k]);
  }
  return result;
}

PolynomialSegment<3> catmull_rom_segment(const Topology& topology, std::span<const Motion::Keyframe* const> keys,
                                         std::size_t i) {
  return path_segment(topology, keys, i, PathKind::kCatmullRom);
}

PolynomialSegment<3> path_segment(const Topology& topology, std::span<const Motion::Keyframe* const> keys,
                                  std::size_t i, PathKind kind) {
  assert(i + 1 < keys.size());
  const Motion::Keyframe &from = *keys[i], &to = *keys[i + 1];
  if (kind == PathKind::kLinear) {
    PolynomialSegment<3> segment = empty_segment<3>(topology, from.time, to.time);
    const auto start = packed(from.positions), end = packed(to.positions);
    const std::size_t count = std::min(start.count, end.count);
    for (std::size_t k = 0; k <= 3; ++k)
      for (std::size_t v = 0; v < count; ++v)
        segment.control[k][v] = lerp(to_double(start[v]), to_double(end[v]), static_cast<double>(k) / 3);
    return segment;
  }
  const auto velocities = [&](std::size_t at) {
    const std::vector<float>& given = given_velocities(*keys[at], kind);
    return given.empty() ? curve_velocities(keys, at) : given;
  };
  const std::vector<float> start = velocities(i), end = velocities(i + 1);
  return hermite_segment(topology, packed(from.positions), packed(start), packed(to.positions), packed(end), from.time,
                         to.time);
}

PolynomialSegment<3> path_segment(const Motion& motion, std::size_t i, PathKind kind) {
  return path_segment(motion.topology, pointers_to(motion.keyframes), i, kind);
}

template <std::size_t K>
std::vector<Vec3d> positions_at(const PolynomialSegment<K>& segment, double t) {
  std::vector<Vec3d> result(segment.topology->vertex_count());
  for (std::size_t v = 0; v < result.size(); ++v) {
    Bernstein<Vec3d, K> curve;
    for (std::size_t k = 0; k <= K; ++k) curve[k] = segment.control[k][v];
    result[v] = evaluate(curve, t);
  }
  return result;
}

template <std::size_t K>
void polynomial_face_normals(const PolynomialSegment<K>& segment, IndexRange faces,
                             std::span<PolynomialNormals<K>> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  for (std::size_t i = 0; i < faces.count; ++i) {
    const auto face = segment.topology->face(faces.first + i);
    PolynomialNormals<K> sum{}, size{};
    const auto edge_to = [&](std::size_t c) { return edge(segment, face[0], face[c]); };
    for_fan(face.size(), edge_to, [&](const Bernstein<Vec3d, K>& e, const Bernstein<Vec3d, K>& f) {
      const auto normal = multiply(e, f, cross<double>);
      const auto products = multiply(e, f, [](const Vec3d& a, const Vec3d& b) {
        const double largest = max_abs(a) * max_abs(b);
        return Vec3d{largest, largest, largest};
      });
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k] = sum[k] + normal[k];
        size[k] = size[k] + products[k];
      }
    });
    for (std::size_t k = 0; k < sum.size(); ++k)
      result[i][k] = without_rounding(sum[k], kError * static_cast<double>(face.size()) * size[k].x);
  }
}

template <std::size_t K>
void polynomial_face_normals_at(const PolynomialSegment<K>& segment, double t, IndexRange faces,
                                std::span<Vec3d> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  for (std::size_t i = 0; i < faces.count; ++i) {
    const auto face = segment.topology->face(faces.first + i);
    Vec3d sum;
    double size = 0;
    const auto edge_to = [&](std::size_t c) {
      const Bernstein<Vec3d, K> e = edge(segment, face[0], face[c]);
      Bernstein<double, K> sizes;
      for (std::size_t k = 0; k <= K; ++k) sizes[k] = max_abs(e[k]);
      return std::pair{evaluate(e, t), evaluate(sizes, t)};
    };
    using Edge = std::pair<Vec3d, double>;
    for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& f) {
      sum = sum + cross(e.first, f.first);
      size += e.second * f.second;
    });
    result[i] = without_rounding(sum, kError * static_cast<double>(face.size()) * size);
  }
}

template <std::size_t K>
void polynomial_group_normals(const NormalGroups& groups, std::span<const PolynomialNormals<K>> of_faces,
                              IndexRange elements, std::span<PolynomialNormals<K>> result) noexcept {
  assert(result.size() == elements.count && elements.end() <= groups.size());
  const auto of_face = [of_faces](std::uint32_t f) -> const PolynomialNormals<K>& {
    assert(f < of_faces.size());
    return of_faces[f];
  };
  sum_path_normals<K>(groups, elements, of_face, result, [](std::size_t) {});
}

template <std::size_t N>
UnitNormal unit_normal_at(const std::array<Vec3d, N>& normals, double time) noexcept {
  const double t = local_time(time);
  if (std::isnan(t)) return {{}, Direction::kNone};
  const auto [before, after] = split(normals, t);
  Bernstein<double, N - 1> sizes;
  for (std::size_t k = 0; k < N; ++k) sizes[k] = max_abs(normals[k]);
  const Vec3d n = after[0];
  if (max_abs(n) > kError * evaluate(sizes, t)) return {unit(n), Direction::kRegular};

  // n(t) = 0: near t the curve leaves along the first control normal of either part that is not zero.
  const double error = kError * *std::max_element(sizes.begin(), sizes.end());
  const Vec3d next = first_direction(after.begin() + 1, after.end(), error);
  const Vec3d last = first_direction(before.rbegin() + 1, before.rend(), error);
  const Vec3d given = t <= 0 || last == Vec3d{} ? next : last;
  if (given == Vec3d{}) return {{}, Direction::kNone};
  const bool inside = t > 0 && t < 1 && next != Vec3d{} && last != Vec3d{};
  return {given, inside && dot(next, last) < 0 ? Direction::kDiscontinuous : Direction::kLimit};
}

template <std::size_t K>
Result<Motion> cut_into_segments(const PolynomialSegment<K>& segment, double distance, std::size_t most_pieces) {
  if (!(distance > 0)) return Error{ErrorCode::kUsage, "", "the distance of a cut motion must be positive"};

  // A chord over a piece of length h is within h^2 / 8 of the largest second derivative.
  double second_derivative = 0;
  for (std::size_t k = 0; k + 2 <= K; ++k) {
    for (std::size_t v = 0; v < segment.topology->vertex_count(); ++v) {
      const auto& c = segment.control;
      const Vec3d bend = (c[k][v] - c[k + 1][v]) + (c[k + 2][v] - c[k + 1][v]);
      second_derivative = std::max(second_derivative, static_cast<double>(K * (K - 1)) * length(bend));
    }
  }
  const double pieces = std::fmax(1.0, std::ceil(std::sqrt(second_derivative / (8 * distance)) * (1 + 1e-12)));
  if (!(pieces <= static_cast<double>(most_pieces)))
    return Error{ErrorCode::kUsage, "",
                 "a motion this curved needs more than " + std::to_string(most_pieces) + " straight pieces"};

  Motion motion;
  motion.topology = *segment.topology;
  const auto piece_count = static_cast<std::size_t>(pieces);
  for (std::size_t piece = 0; piece <= piece_count; ++piece) {
    const double t = static_cast<double>(piece) / pieces;
    Motion::Keyframe keyframe;
    keyframe.time = segment.start_time + t * (segment.end_time - segment.start_time);
    keyframe.positions.reserve(3 * segment.topology->vertex_count());
    for (const Vec3d& position : positions_at(segment, t)) {
      const Vec3f p = to_float(position);
      keyframe.positions.insert(keyframe.positions.end(), {p.x, p.y, p.z});
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

#define CHRONORMAL_INSTANTIATE(K)                                                                           \
  template void polynomial_face_normals<(K)>(const PolynomialSegment<(K)>&, IndexRange,                     \
                                             std::span<PolynomialNormals<(K)>>) noexcept;                   \
  template void polynomial_face_normals_at<(K)>(const PolynomialSegment<(K)>&, double, IndexRange,          \
                                                std::span<Vec3d>) noexcept;                                 \
  template void polynomial_group_normals<(K)>(const NormalGroups&, std::span<const PolynomialNormals<(K)>>, \
                                              IndexRange, std::span<PolynomialNormals<(K)>>) noexcept;      \
  template std::vector<Vec3d> positions_at(const PolynomialSegment<(K)>&, double);                          \
  template UnitNormal unit_normal_at(const std::array<Vec3d, 2 * (K) + 1>&, double) noexcept;               \
  template Result<Motion> cut_into_segments<(K)>(const PolynomialSegment<(K)>&, double, std::size_t)

CHRONORMAL_INSTANTIATE(1);
CHRONORMAL_INSTANTIATE(2);
CHRONORMAL_INSTANTIATE(3);

}  // namespace chronormal
