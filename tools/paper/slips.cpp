// Section 6: what the paper has wrong or leaves open, each with a check, and what we have not got right.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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
    const std::vector<ControlNormals> normals = control_normals_of(segment);
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
  const std::vector<ControlNormals> normals = control_normals_of(segment);
  double count = 0;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const Vec3d corner = to_double(segment.from[segment.topology->face(f)[0]]);
    if (std::fabs(dot(unit(normals[f].n0), corner) - 1) < 1e-6) ++count;
  }
  return count / static_cast<double>(normals.size());
}

void write_paper_slips(Page& page) {
  const Motion twist = some_pairs(morph("twist"), 2000);
  const double linear = sum(PairErrors(twist, 21).sums("linear"));
  std::array<LiteralResult, 3> results;
  parallel_for(results.size(), [&](std::size_t i) { results[i] = interpolate(twist, static_cast<Reading>(i)); });
  const auto& [correct, literal, other] = results;
  const Segment segment = twist.segment(0);
  std::vector<ControlNormals> normals = control_normals_of(segment);
  const double printed = frames_of(segment, 0, normals[0], Reading::kLiteral).end.determinant();
  const double repaired = frames_of(segment, 0, normals[0], Reading::kCorrect).end.determinant();
  require(std::fabs(printed + 1) < 1e-12 && std::fabs(repaired - 1) < 1e-12, "the printed frame is left-handed");
  require(correct.from_library < 1e-3, "the second implementation agrees with the library");
  require(literal.sum > 2 * correct.sum && other.sum > 2 * correct.sum, "the printed tangent is far off");

  page.subheading("The paper's");
  page.text(
      fmt::format("To check the first of these, section 2.5 is implemented a second time in the generator of this "
                  "page, as printed: a 4 x 4 inverse, two quaternions, slerp, the last column. With the correction "
                  "it agrees with `quaternion:matrix`, in which there is neither a matrix nor a quaternion, to {} "
                  "degrees on 2,000 faces of twist.",
                  scientific(correct.from_library)));
  page.bullet(
      fmt::format("**A tangent of the wrong sign.** Section 2.5 prints t1 = n1 x b1. With its own b = n x t that "
                  "frame is left-handed: determinant {:.0f} on face 0. The tangent is b1 x n1, determinant {:.0f}. "
                  "Taken literally, the matrix is no rotation and its quaternion is another's: the sum relative to "
                  "linear is {} instead of {}, and at t = 1 the normal misses n1 by {} degrees on average. Turning "
                  "b1 round instead makes a rotation, half a turn away from the right one: {}. The paper's figures "
                  "are not of that kind, so its program will have had it right.",
                  printed, repaired, ratio(literal.sum / linear), ratio(correct.sum / linear),
                  grouped(literal.mean_at_end, 1), ratio(other.sum / linear)));
  const Motion bend = some_pairs(morph("bend"), 2000);
  const LiteralResult as_point = interpolate(bend, Reading::kNormalAsPoint);
  require(as_point.from_library < 1e-3, "the fourth component of the normal does not change the frames");
  const double singular = share_at_distance_one(morph("twist"));
  require(singular == 1, "M is singular on all of twist");
  page.bullet(fmt::format(
      "**A fourth component.** Eq. 7 shows a0 with fourth component 1 and says \"etc.\" The normal is a direction "
      "and takes 0. With 1 the frames come out the same ({} degrees apart at most on 2,000 faces of bend), since "
      "b0 lies in the plane of the face and M b0 does not ask for the normal. But M is then singular where the "
      "plane of the face is at distance 1 from the origin: on twist that is so for {} of the faces. And M b0 has "
      "length 1 only by accident; it must be brought to it.",
      scientific(as_point.from_library), percent(singular)));

  // A shear of the plane x = 0.
  const auto shear = [](const Vec3d& v) { return Vec3d{v.x + v.y, v.y, v.z}; };
  const Vec3d along_y{0, 1, 0}, along_z{0, 0, 1}, normal = cross(along_y, along_z);
  const Vec3d right = unit(cross(shear(along_y), shear(along_z)));
  const Vec3d inverse_transpose = unit(Vec3d{normal.x, normal.y - normal.x, normal.z});
  require(degrees_between(right, inverse_transpose) < 1e-10, "the inverse transpose is right");
  page.bullet(
      fmt::format("**Normals under linear maps.** The introduction says that for a linear transformation the "
                  "inverse transpose of J is J itself. That holds for rotations. Under the shear (x + y, y, z) the "
                  "normal of the plane x = 0 comes out {:.0f} degrees wrong with J, and {:.0f} with the inverse "
                  "transpose.",
                  degrees_between(right, unit(shear(normal))), std::fabs(degrees_between(right, inverse_transpose))));
  const Vec3d half = normal_at(normals[0], 0.5);
  page.bullet(
      fmt::format("**Equation numbers.** Table 2 says of the t-variant product that Eq. 1 needs normalisation and "
                  "Eq. 2 does not. Each is one too low: on face 0 of that mesh Eq. 2 gives a vector of length "
                  "{:.4f} at t = 1/2, and Eq. 3 one of length {:.0f}.",
                  length(half), length(unit(half))));

  // A claim that holds.
  double area_error = 0;
  {
    const Segment s = bend.segment(0);
    std::vector<Vec3d> exact(bend.topology.face_count());
    reference_normals(s, {0, exact.size()}, 0.3, exact);
    for (std::size_t f = 0; f < exact.size(); ++f) {
      const auto face = bend.topology.face(f);
      const auto p = [&](std::size_t i) { return lerp(to_double(s.from[face[i]]), to_double(s.to[face[i]]), 0.3); };
      // Heron's formula, which knows no normal.
      const double a = length(p(1) - p(0)), b = length(p(2) - p(1)), c = length(p(0) - p(2)), h = (a + b + c) / 2;
      const double area = std::sqrt(h * (h - a) * (h - b) * (h - c));
      area_error = std::max(area_error, std::fabs(length(exact[f]) / (2 * area) - 1));
    }
  }
  page.bullet(
      fmt::format("**And one that is none**: \"the lengths of normals are proportional to the size of face\". "
                  "|n(t)| is twice the area, by Heron's formula to {} of it on 2,000 faces of bend.",
                  scientific(area_error)));
  page.line("");
  page.statement("t1 = n1 x b1 (section 2.5)",
                 fmt::format("a slip: determinant {:.0f}; taken literally {} relative to linear instead of {}", printed,
                             ratio(literal.sum / linear), ratio(correct.sum / linear)),
                 "6");
  page.statement("Lengths of exact normals are proportional to the size of the face",
                 fmt::format("yes, to {}", scientific(area_error)), "6");
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
  return degree(control_normals_of(motion.segment(0))[0]);
}

// Bytes per face of `polynomial` where no face is flagged.
double mild_bytes() {
  return compare(morph("bend"), {{"polynomial"}, 2, Access::kRandom, {}}).value().schemes[0].bytes;
}

void write_our_slips(Page& page) {
  const std::array<const char*, 2> dramatic = {"eversion", "soup"};
  CompareOptions options;
  options.schemes = {"polynomial", "rational", "circle:timed", "quadratic", "quaternion:optimal", "linear"};
  std::array<Comparison, 2> comparisons;
  for (std::size_t i = 0; i < 2; ++i) comparisons[i] = compare(morph(dramatic[i]), options).value();
  const auto mean = [&](std::size_t morph_index, std::size_t scheme) {
    return kDegreesPerRadian * comparisons[morph_index].schemes[scheme].quality.mean();
  };
  const auto max = [&](std::size_t morph_index, std::size_t scheme) {
    return kDegreesPerRadian * comparisons[morph_index].schemes[scheme].quality.max;
  };
  const auto flagged = [&](std::size_t morph_index) {
    return static_cast<double>(comparisons[morph_index].schemes[0].flagged) /
           static_cast<double>(comparisons[morph_index].faces);
  };
  const auto relative = [&](std::size_t morph_index, std::size_t scheme) {
    return comparisons[morph_index].schemes[scheme].relative_to_linear.value();
  };

  page.subheading("Ours");
  page.bullet(fmt::format(
      "**`polynomial` is not exactly zero.** float32 leaves {} degrees on average and {} at worst on eversion. And "
      "it is not float32 alone: faces that float32 could not carry are evaluated in double. On mild morphs there "
      "are none, on eversion {} and on soup {} of the faces: {} and {} bytes a face on average in place of {}.",
      scientific(mean(0, 0), 1), scientific(max(0, 0), 1), percent(flagged(0)), percent(flagged(1)),
      grouped(comparisons[0].schemes[0].bytes), grouped(comparisons[1].schemes[0].bytes), grouped(mild_bytes())));
  require(mean(0, 1) > 3 * mean(0, 0), "rational is less accurate on eversion");
  page.bullet(
      fmt::format("**`rational`**, the paper's Eq. 3, has no such care. Its quartic for the squared length cancels "
                  "where the face nearly collapses: {} degrees on average on eversion, {} at worst.",
                  scientific(mean(0, 1), 1), scientific(max(0, 1), 1)));
  require(relative(0, 2) > relative(0, 4) && relative(1, 2) > relative(1, 3),
          "circle:timed is not the best where faces collapse");
  const Motion eversion = some_pairs(morph("eversion"), 2000);
  const PairErrors errors(eversion, 21);
  const std::vector<double> timed = errors.sums("circle:timed"), linear = errors.sums("linear");
  double worse = 0;
  for (std::size_t i = 0; i < timed.size(); ++i) worse += timed[i] > linear[i] ? 1 : 0;
  page.bullet(
      fmt::format("**`circle:timed`** is the best of ours on mild morphs (`cubic` is better still), and loses "
                  "where faces collapse: on eversion it is at {} of linear behind `quaternion:optimal` at {}, and "
                  "worse than linear on {} of the faces; on soup it is at {} behind `quadratic` at {}. It trusts a "
                  "middle that is nothing like the rest of the way.",
                  ratio(relative(0, 2)), ratio(relative(0, 4)), percent(worse / static_cast<double>(timed.size())),
                  ratio(relative(1, 2)), ratio(relative(1, 3))));
  page.bullet(
      "**`quaternion:optimal`** is optimal among quaternion slerps on the shorter arc, for the mean error over t, "
      "to the accuracy of a search. It is not optimal among circles: longer arcs are sometimes better, which is "
      "why `circle` beats it on soup (" +
      fmt::format("{} against {}).",
                  ratio(compare(morph("soup"), {{"circle"}, 21, Access::kRandom, {}})
                            .value()
                            .schemes[0]
                            .relative_to_linear.value()),
                  ratio(relative(1, 4))));
  page.bullet(
      "**Our morphs** come from formulas. They are smooth, and all their faces move much alike; the paper's, from "
      "one shape to another, did not. Where our ratios differ from theirs, this is the first thing to suspect "
      "(section 1).");
  page.bullet("**Sections 1 (in part), 3, 4 and 5** measure some of the faces, drawn at random, and say how many.");
  page.bullet(
      "**Times** are of a machine that was not idle. Operations and bytes are exact; of the times, believe the "
      "ratios.");
  page.line("");
  require(degree_when(3) == 0 && degree_when(2) == 1 && degree_when(0) == 2, "degrees are as the paper says");
  page.statement("The exact normal has degree two; one if two vertices move alike, none if three do",
                 fmt::format("yes: {}, {}, {}; other motions lower the degree too (theory, section 2)", degree_when(0),
                             degree_when(2), degree_when(3)),
                 "6");
}

}  // namespace

void write_slips(Page& page) {
  page.heading("6 Slips, the paper's and ours");
  write_paper_slips(page);
  write_our_slips(page);
}

}  // namespace chronormal::paper
