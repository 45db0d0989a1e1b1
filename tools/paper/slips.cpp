// Section 6: what the paper has wrong or leaves open, each with a check, and what we have not got right.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

// Section 2.5 of the paper a second time, as it is printed: a 4 x 4 inverse, two quaternions, slerp, the last column.
// It shares nothing with the library's quaternion:matrix, which has neither a matrix nor a quaternion in it.
struct Quaternion {
  double w = 0, x = 0, y = 0, z = 0;
};

struct Frame {
  Vec3d tangent, binormal, normal;  // the columns of a matrix
  [[nodiscard]] double determinant() const { return dot(tangent, cross(binormal, normal)); }
};

// By the largest of the four squares. For a matrix that is no rotation it gives what such code gives.
Quaternion quaternion_of(const Frame& f) {
  const Vec3d &a = f.tangent, &b = f.binormal, &c = f.normal;
  const std::array<double, 4> squares = {1 + a.x + b.y + c.z, 1 + a.x - b.y - c.z, 1 - a.x + b.y - c.z,
                                         1 - a.x - b.y + c.z};
  Quaternion q;
  switch (std::max_element(squares.begin(), squares.end()) - squares.begin()) {
    case 0:
      q = {squares[0], b.z - c.y, c.x - a.z, a.y - b.x};
      break;
    case 1:
      q = {b.z - c.y, squares[1], b.x + a.y, c.x + a.z};
      break;
    case 2:
      q = {c.x - a.z, b.x + a.y, squares[2], c.y + b.z};
      break;
    default:
      q = {a.y - b.x, c.x + a.z, c.y + b.z, squares[3]};
      break;
  }
  const double size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / size, q.x / size, q.y / size, q.z / size};
}

Vec3d last_column(const Quaternion& q) {
  return {2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), q.w * q.w - q.x * q.x - q.y * q.y + q.z * q.z};
}

Quaternion slerp(const Quaternion& a, Quaternion b, double t) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) {
    cosine = -cosine;
    b = {-b.w, -b.x, -b.y, -b.z};
  }
  const double angle = std::acos(std::min(cosine, 1.0)), sine = std::sin(angle);
  const double wa = sine > 1e-9 ? std::sin((1 - t) * angle) / sine : 1 - t,
               wb = sine > 1e-9 ? std::sin(t * angle) / sine : t;
  return {wa * a.w + wb * b.w, wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z};
}

using Column = std::array<double, 4>;
using Matrix = std::array<Column, 4>;  // four columns

Column homogeneous(const Vec3d& v, double w) { return {v.x, v.y, v.z, w}; }

// M v for the M with M from = to (the paper's Eq. 7): v in terms of the columns of `from`, by elimination.
Vec3d mapped(const Matrix& from, const Matrix& to, Column v) {
  Matrix m = from;
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t pivot = k;
    for (std::size_t r = k + 1; r < 4; ++r) {
      if (std::fabs(m[k][r]) > std::fabs(m[k][pivot])) pivot = r;
    }
    for (Column& column : m) std::swap(column[k], column[pivot]);
    std::swap(v[k], v[pivot]);
    for (std::size_t r = k + 1; r < 4; ++r) {
      const double factor = m[k][r] / m[k][k];
      for (std::size_t c = k; c < 4; ++c) m[c][r] -= factor * m[c][k];
      v[r] -= factor * v[k];
    }
  }
  Vec3d result;
  for (std::size_t k = 4; k-- > 0;) {
    v[k] /= m[k][k];
    for (std::size_t r = 0; r < k; ++r) v[r] -= m[k][r] * v[k];
    result = result + v[k] * Vec3d{to[k][0], to[k][1], to[k][2]};
  }
  return result;
}

enum class Reading {
  kCorrect,        // t1 = b1 x n1
  kLiteral,        // t1 = n1 x b1, as printed
  kOtherBinormal,  // t1 = n1 x b1, and b1 turned round to make it a rotation
  kNormalAsPoint,  // the normal with fourth component 1
};

struct Frames {
  Frame start, end;
};

Frames frames_of(const Segment& segment, std::size_t face, const ControlNormals& normals, Reading reading) {
  const auto corners = segment.topology->face(face);
  const auto corner = [&](VectorView<const float> positions, std::size_t i) {
    return to_double(positions[corners[i]]);
  };
  const Vec3d n0 = unit(normals.n0), n1 = unit(normals.n1);
  const double w = reading == Reading::kNormalAsPoint ? 1 : 0;
  const auto matrix = [&](VectorView<const float> positions, const Vec3d& n) {
    return Matrix{homogeneous(corner(positions, 0), 1), homogeneous(corner(positions, 1), 1),
                  homogeneous(corner(positions, 2), 1), homogeneous(n, w)};
  };
  const Vec3d t0 = unit(corner(segment.from, 1) - corner(segment.from, 0)), b0 = cross(n0, t0);
  Vec3d b1 = unit(mapped(matrix(segment.from, n0), matrix(segment.to, n1), homogeneous(b0, 0)));
  Vec3d t1 = cross(b1, n1);
  if (reading == Reading::kLiteral || reading == Reading::kOtherBinormal) t1 = cross(n1, b1);
  if (reading == Reading::kOtherBinormal) b1 = -b1;
  return {{t0, b0, n0}, {t1, b1, n1}};
}

struct LiteralResult {
  double sum = 0;           // of the angles, degrees
  double worst_at_end = 0;  // at t = 1, where it should meet n1
  double mean_at_end = 0;
  double from_library = 0;  // largest angle to quaternion:matrix
};

LiteralResult interpolate(const Motion& motion, Reading reading) {
  LiteralResult result;
  double ends = 0;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const Segment segment = motion.segment(s);
    const std::vector<ControlNormals> normals = all_face_control_normals(segment);
    const PreparedScheme library("quaternion:matrix", segment, {0, normals.size()});
    std::vector<std::vector<Vec3d>> library_normals;
    for (int i = 0; i <= 20; ++i) library_normals.push_back(library.at(i / 20.0));
    for (std::size_t f = 0; f < normals.size(); ++f) {
      const Frames frames = frames_of(segment, f, normals[f], reading);
      const Quaternion q0 = quaternion_of(frames.start), q1 = quaternion_of(frames.end);
      for (std::size_t i = 0; i <= 20; ++i) {
        const double t = static_cast<double>(i) / 20;
        const Vec3d u = unit(last_column(slerp(q0, q1, t)));
        const double error = degrees_between(u, unit_normal_at(normals[f], t).vector);
        result.sum += error;
        result.from_library = std::max(result.from_library, degrees_between(u, library_normals[i][f]));
        if (i == 20) result.worst_at_end = std::max(result.worst_at_end, error), result.mean_at_end += error, ++ends;
      }
    }
  }
  result.mean_at_end /= ends;
  return result;
}

// The share of faces whose plane is at distance 1 from the origin at t = 0, on the side of the normal.
double share_at_distance_one(const Motion& motion) {
  const Segment segment = motion.segment(0);
  const std::vector<ControlNormals> normals = all_face_control_normals(segment);
  double count = 0;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const Vec3d corner = to_double(segment.from[segment.topology->face(f)[0]]);
    if (std::fabs(dot(unit(normals[f].n0), corner) - 1) < 1e-6) ++count;
  }
  return count / static_cast<double>(normals.size());
}

// Section 2.5 in all its readings, on 2,000 faces.
void check_frames(Page& page) {
  const Motion twist = some_pairs(morph("twist"), 2000), bend = some_pairs(morph("bend"), 2000);
  const double linear = sum(PairErrors(twist, 21).sums("linear"));
  std::array<LiteralResult, 4> results;
  parallel_for(results.size(), [&](std::size_t i) {
    const Reading reading = static_cast<Reading>(i);
    results[i] = interpolate(reading == Reading::kNormalAsPoint ? bend : twist, reading);
  });
  const auto& [correct, literal, other, as_point] = results;
  const Segment segment = twist.segment(0);
  const ControlNormals normals = all_face_control_normals(segment)[0];
  const double printed = frames_of(segment, 0, normals, Reading::kLiteral).end.determinant();
  const double repaired = frames_of(segment, 0, normals, Reading::kCorrect).end.determinant();
  const double singular = share_at_distance_one(morph("twist"));
  require(std::fabs(printed + 1) < 1e-12 && std::fabs(repaired - 1) < 1e-12, "the printed frame is left-handed");
  require(correct.from_library < 1e-3, "the second implementation agrees with the library");
  require(literal.sum > 2 * correct.sum && other.sum > 2 * correct.sum, "the printed tangent is far off");
  require(as_point.from_library < 1e-3, "the fourth component of the normal does not change the frames");
  require(singular == 1, "M is singular on all of twist");
  const Vec3d half = normal_at(normals, 0.5);
  page.set({{"correct_from_library", scientific(correct.from_library)},
            {"printed_determinant", fmt::format("{:.0f}", printed)},
            {"repaired_determinant", fmt::format("{:.0f}", repaired)},
            {"literal_ratio", ratio(literal.sum / linear)},
            {"correct_ratio", ratio(correct.sum / linear)},
            {"other_ratio", ratio(other.sum / linear)},
            {"literal_at_end", grouped(literal.mean_at_end, 1)},
            {"as_point_from_library", scientific(as_point.from_library)},
            {"singular_share", percent(singular)},
            {"half_length", fmt::format("{:.4f}", length(half))},
            {"half_unit_length", fmt::format("{:.0f}", length(unit(half)))}});
}

// The normal of the plane x = 0 under the shear (x + y, y, z).
void check_shear(Page& page) {
  const auto shear = [](const Vec3d& v) { return Vec3d{v.x + v.y, v.y, v.z}; };
  const Vec3d along_y{0, 1, 0}, along_z{0, 0, 1}, normal = cross(along_y, along_z);
  const Vec3d right = unit(cross(shear(along_y), shear(along_z)));
  const Vec3d inverse_transpose = unit(Vec3d{normal.x, normal.y - normal.x, normal.z});
  require(degrees_between(right, inverse_transpose) < 1e-10, "the inverse transpose is right");
  page.set({{"shear_wrong", fmt::format("{:.0f}", degrees_between(right, unit(shear(normal))))},
            {"shear_right", fmt::format("{:.0f}", std::fabs(degrees_between(right, inverse_transpose)))}});
}

// The largest relative difference between |n(t)| and twice the area by Heron's formula, which knows no normal.
double error_of_areas(const Motion& motion, double t) {
  const Segment segment = motion.segment(0);
  std::vector<Vec3d> exact(motion.topology.face_count());
  reference_normals(segment, {0, exact.size()}, t, exact);
  double worst = 0;
  for (std::size_t f = 0; f < exact.size(); ++f) {
    const auto face = motion.topology.face(f);
    const auto p = [&](std::size_t i) {
      return lerp(to_double(segment.from[face[i]]), to_double(segment.to[face[i]]), t);
    };
    const double a = length(p(1) - p(0)), b = length(p(2) - p(1)), c = length(p(0) - p(2)), h = (a + b + c) / 2;
    const double area = std::sqrt(h * (h - a) * (h - b) * (h - c));
    worst = std::max(worst, std::fabs(length(exact[f]) / (2 * area) - 1));
  }
  return worst;
}

// Degree of n(t) when so many vertices of a triangle move alike.
int degree_when(int alike) {
  const std::array<Vec3d, 3> start = {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}};
  const std::array<Vec3d, 3> moves = {Vec3d{0.25, 0.5, 0.5}, Vec3d{-0.5, 0.125, 0.75}, Vec3d{0.25, -0.5, 0.125}};
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes.resize(2);
  motion.keyframes[1].time = 1;
  for (int v = 0; v < 3; ++v) {
    const std::size_t i = static_cast<std::size_t>(v);
    const Vec3d end = start[i] + moves[v < alike ? 0 : i];
    for (const auto& [keyframe, p] : {std::pair{0u, start[i]}, {1u, end}}) {
      const Vec3f q = to_float(p);
      motion.keyframes[keyframe].positions.insert(motion.keyframes[keyframe].positions.end(), {q.x, q.y, q.z});
    }
  }
  motion.connect_as_sequence();
  return degree(all_face_control_normals(motion.segment(0))[0]);
}

// Bytes per face of `polynomial` where no face is flagged.
double mild_bytes() {
  return compare(morph("bend"), {{"polynomial"}, 2, Access::kRandom, {}}).value().schemes[0].bytes;
}

// The share of (face, segment) pairs on which one scheme has the larger sum of errors than another.
double share_of_losses(const Motion& motion, std::string_view scheme, std::string_view other) {
  const PairErrors errors(motion, 21);
  const std::vector<double> its = errors.sums(scheme), others = errors.sums(other);
  double losses = 0;
  for (std::size_t i = 0; i < its.size(); ++i) losses += its[i] > others[i] ? 1 : 0;
  return losses / static_cast<double>(its.size());
}

void measure_ours(Page& page) {
  const auto compared = [](std::string_view name, std::vector<std::string> schemes) {
    CompareOptions options;
    options.schemes = std::move(schemes);
    return compare(morph(name), options).value();
  };
  const Comparison eversion = compared("eversion", {"polynomial", "rational"});
  const Comparison soup = compared("soup", {"polynomial", "circle:timed", "quadratic", "quaternion:optimal", "circle"});
  const SchemeComparison &exact = eversion.schemes[0], &rational = eversion.schemes[1];
  const auto on_soup = [&soup](std::size_t scheme) { return soup.schemes[scheme].relative_to_linear.value(); };
  const double timed = on_soup(1), quadratic = on_soup(2), optimal = on_soup(3), circle = on_soup(4);
  const auto flagged = [](const Comparison& comparison) {
    return percent(static_cast<double>(comparison.schemes[0].flagged) / static_cast<double>(comparison.faces));
  };
  require(rational.quality.mean() > 3 * exact.quality.mean(), "rational is less accurate on eversion");
  require(timed > quadratic, "circle:timed is not the best on soup");
  require(circle < optimal, "circle beats quaternion:optimal on soup");
  require(degree_when(3) == 0 && degree_when(2) == 1 && degree_when(0) == 2, "degrees are as the paper says");
  const auto degrees = [](double radians) { return scientific(kDegreesPerRadian * radians, 1); };
  const double timed_loses = share_of_losses(some_pairs(morph("eversion"), 2000), "circle:timed", "linear");
  page.set({{"exact_mean_eversion", degrees(exact.quality.mean())},
            {"exact_max_eversion", degrees(exact.quality.max)},
            {"flagged_eversion", flagged(eversion)},
            {"flagged_soup", flagged(soup)},
            {"bytes_eversion", grouped(exact.bytes)},
            {"bytes_soup", grouped(soup.schemes[0].bytes)},
            {"bytes_mild", grouped(mild_bytes())},
            {"rational_mean_eversion", degrees(rational.quality.mean())},
            {"rational_max_eversion", degrees(rational.quality.max)},
            {"timed_loses", percent(timed_loses)},
            {"soup_timed", ratio(timed)},
            {"soup_quadratic", ratio(quadratic)},
            {"soup_optimal", ratio(optimal)},
            {"soup_circle", ratio(circle)},
            {"degree_none_alike", fmt::format("{}", degree_when(0))},
            {"degree_two_alike", fmt::format("{}", degree_when(2))},
            {"degree_three_alike", fmt::format("{}", degree_when(3))}});
}

}  // namespace

void measure_slips(Page& page) {
  check_frames(page);
  check_shear(page);
  const double area_error = error_of_areas(some_pairs(morph("bend"), 2000), 0.3);
  page.set("area_error", scientific(area_error));
  measure_ours(page);
}

}  // namespace chronormal::paper
