// Back-face culling at time t: which faces of a morph face the eye, between the keyframes.
//
// A face is seen from its front where n(t).(eye - a(t)) > 0, a being any of its corners. Two shortcuts are common and
// wrong: to interpolate the end normals, and to skip a face that is back-facing at both keyframes. With control normals
// the answer is exact, and there is more to have: n(t).d is a quadratic for a fixed direction d, and n(t).(eye - a(t))
// a cubic. Their roots are the times at which the face turns, so a face can be skipped for a whole segment safely.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "chronormal/chronormal.h"

namespace {

using namespace chronormal;

constexpr Vec3d kEye{4, -5, 2};
constexpr int kSamples = 21;
constexpr double kGrazing = 2e-6;  // rad between face and line of sight; below, float32 may not decide (it has 1e-6)

Vec3d corner_at(const Segment& segment, std::size_t face, double t) {
  const std::uint32_t v = segment.topology->face(face)[0];
  return lerp(to_double(segment.from[v]), to_double(segment.to[v]), t);
}

/// n(t).(eye - a(t)) in Bernstein form: the product of a quadratic and a line.
Bernstein<double, 3> facing(const ControlNormals& n, const Vec3d& to_eye0, const Vec3d& to_eye1) {
  return multiply(Bernstein<Vec3d, 2>{n.n0, n.m, n.n1}, Bernstein<Vec3d, 1>{to_eye0, to_eye1}, dot<double>);
}

/// Where a polynomial that is negative at both ends is largest between two of its roots; -1 if it has no roots.
template <std::size_t M>
double time_between_roots(const std::array<double, M>& p) {
  const Roots<M - 1> roots = roots_in_unit_interval(p);
  double best = -1;
  for (std::size_t i = 0; i + 1 < roots.count; ++i) {
    const double middle = (roots.t[i] + roots.t[i + 1]) / 2;
    if (evaluate(p, middle) > 0 && (best < 0 || evaluate(p, middle) > evaluate(p, best))) best = middle;
  }
  return best;
}

struct Count {
  std::size_t decisions = 0;  // (face, segment, sample) triples
  std::size_t linear_wrong = 0;
  std::size_t exact_wrong = 0;
  std::size_t hidden = 0;       // (face, segment) pairs that are back-facing at both ends
  std::size_t seen_inside = 0;  // of these, front-facing for some t between
  std::size_t refuted = 0;      // answers of the roots that the reference contradicts

  void add(const Count& c) {
    decisions += c.decisions, linear_wrong += c.linear_wrong, exact_wrong += c.exact_wrong;
    hidden += c.hidden, seen_inside += c.seen_inside, refuted += c.refuted;
  }
};

/// The sine of the angle between a face and the line of sight, positive in front; by the reference, from positions
/// alone.
double reference_facing(const Segment& segment, std::size_t face, double t) {
  Vec3d n;
  reference_normals(segment, {face, 1}, t, {&n, 1});
  return dot(unit(n), unit(kEye - corner_at(segment, face, t)));
}

Count count(const Segment& segment) {
  Count result;
  const std::size_t faces = segment.topology->face_count();
  std::vector<ControlNormals> control(faces);
  face_control_normals(segment, {0, faces}, control);
  const NormalCurves curves(control);
  std::vector<float> packed(3 * faces);
  const auto normals = VectorView<float>::packed(packed.data(), faces);

  // Decide every face at every sample, in three ways.
  std::vector<bool> ever_seen(faces, false);
  for (int i = 0; i < kSamples; ++i) {
    const double t = i / (kSamples - 1.0);
    (void)curves.unit_normals(t, normals);
    for (std::size_t f = 0; f < faces; ++f) {
      const double truth = reference_facing(segment, f, t);
      if (std::fabs(truth) < kGrazing) continue;
      const Vec3d to_eye = kEye - corner_at(segment, f, t);
      const Vec3d linear = lerp(unit(control[f].n0), unit(control[f].n1), t);
      ++result.decisions;
      result.exact_wrong += (dot(to_double(normals[f]), to_eye) > 0) != (truth > 0);
      result.linear_wrong += (dot(linear, to_eye) > 0) != (truth > 0);
      ever_seen[f] = ever_seen[f] || truth > 0;
    }
  }

  // Decide for whole segments: the roots say whether a face that is hidden at both ends comes round between.
  for (std::size_t f = 0; f < faces; ++f) {
    const auto cubic = facing(control[f], kEye - corner_at(segment, f, 0), kEye - corner_at(segment, f, 1));
    if (cubic[0] >= 0 || cubic[3] >= 0) continue;
    ++result.hidden;
    const double t = time_between_roots(cubic);
    result.seen_inside += t >= 0;
    result.refuted += t >= 0 ? reference_facing(segment, f, t) <= 0 : ever_seen[f];
  }
  return result;
}

/// Lists the first faces of a segment that turn towards a far-away eye and away again. Returns the largest sine between
/// a face and the line of sight at these times, by the reference: zero but for rounding, as the face is seen edge on.
double print_turns(const Segment& segment, const Vec3d& direction, int wanted) {
  double largest = 0;
  for (std::size_t f = 0; f < segment.topology->face_count() && wanted > 0; ++f) {
    ControlNormals n;
    face_control_normals(segment, {f, 1}, {&n, 1});
    const Bernstein<double, 2> quadratic{dot(n.n0, direction), dot(n.m, direction), dot(n.n1, direction)};
    const Roots<2> turns = roots_in_unit_interval(quadratic);
    if (turns.count != 2 || quadratic[0] > 0) continue;
    std::printf("%8zu  %13.9f  %13.9f\n", f, turns.t[0], turns.t[1]);
    --wanted;
    for (const double t : turns.t) {
      Vec3d edge_on;
      reference_normals(segment, {f, 1}, t, {&edge_on, 1});
      largest = std::max(largest, std::fabs(dot(unit(edge_on), direction)));
    }
  }
  return wanted == 0 ? largest : 1;
}

}  // namespace

int main() {
  std::printf("morph      decisions    linear     exact  hidden at  seen between\n");
  std::printf("                         wrong     wrong  both ends  all the same\n");
  Count total;
  for (const BuiltinMorph& morph : builtin_morphs()) {
    const Motion motion = make_builtin_morph(morph.name).value();
    Count c;
    for (std::size_t s = 0; s < motion.segments.size(); ++s) c.add(count(motion.segment(s)));
    std::printf("%-9s  %9zu  %8zu  %8zu  %9zu  %12zu\n", std::string(morph.name).c_str(), c.decisions, c.linear_wrong,
                c.exact_wrong, c.hidden, c.seen_inside);
    total.add(c);
  }

  const Motion motion = make_builtin_morph("cloth").value();
  std::printf("\nface of   turns to us    and away\ncloth     at local t     at local t\n");
  const double edge_on = print_turns(motion.segment(1), unit(kEye), 4);
  std::printf("\nfaces are edge on at these times to %.0e rad\n", edge_on);

  const bool holds =
      total.exact_wrong == 0 && total.refuted == 0 && edge_on < 1e-9 && total.linear_wrong > 0 && total.seen_inside > 0;
  if (!holds) std::fprintf(stderr, "culling: exact normals should have decided every face right, and only they\n");
  return holds ? 0 : 1;
}
