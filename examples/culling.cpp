// Finds which faces of a morph face the eye between the keyframes, for back-face culling at any time t.
//
// A face shows its front if n(t).(eye - a(t)) > 0, where a is any of its corners. Two shortcuts are common and wrong:
// to interpolate the end normals, and to skip a face that is back-facing at both keyframes. Exact normals give the
// right answer at every instant. find_facing() answers for whole segments: it returns the instants at which a face
// turns, so a face that never shows its front can be skipped safely.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace {

using namespace chronormal;

constexpr Vec3d kEye{4, -5, 2};
constexpr int kSamples = 21;
// If the angle between a face and the line of sight is smaller than this, in radians, float32 may decide wrongly: its
// normals have errors of up to 1e-6 radians.
constexpr double kGrazing = 2e-6;

Vec3d corner_at(const Segment& segment, std::size_t face, double t) {
  const std::uint32_t v = segment.topology->face(face)[0];
  return lerp(to_double(segment.from[v]), to_double(segment.to[v]), t);
}

/// Returns a time at which the front of a face shows although the face is hidden at both ends of the segment. It is the
/// middle between two times at which the face turns. Returns -1 if there is no such time.
double time_seen(const Facing& facing) {
  for (std::size_t i = 0; i + 1 < facing.count; ++i)
    if (facing.at[i].after == Side::kFront) return (facing.at[i].upper + facing.at[i + 1].lower) / 2;
  return -1;
}

struct Count {
  std::size_t decisions = 0;  // number of (face, segment, sample) triples
  std::size_t linear_wrong = 0;
  std::size_t exact_wrong = 0;
  std::size_t hidden = 0;       // number of (face, segment) pairs that are back-facing at both ends
  std::size_t seen_inside = 0;  // number of these pairs that are front-facing for some t in between
  std::size_t refuted = 0;      // number of answers of find_facing() that the reference contradicts

  void add(const Count& c) {
    decisions += c.decisions, linear_wrong += c.linear_wrong, exact_wrong += c.exact_wrong;
    hidden += c.hidden, seen_inside += c.seen_inside, refuted += c.refuted;
  }
};

/// Returns the sine of the angle between a face and the line of sight. It is positive if the front of the face is seen.
/// This reference uses positions alone.
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

  // Decide in three ways whether each face is seen at each sample: by the reference, by interpolated end normals, and
  // by exact normals.
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

  // Decide for whole segments whether a face that is hidden at both ends is seen in between.
  for (std::size_t f = 0; f < faces; ++f) {
    const Facing facing = find_facing(segment, f, control[f], View::of_eye(kEye));
    if (facing.first() != Side::kBack || facing.last() != Side::kBack) continue;
    ++result.hidden;
    const double t = time_seen(facing);
    result.seen_inside += t >= 0;
    result.refuted += t >= 0 ? reference_facing(segment, f, t) <= 0 : ever_seen[f];
  }
  return result;
}

/// Prints the first faces of a segment that turn towards a far-away eye and away again. Returns the largest sine of the
/// angle between such a face and the line of sight at the times of the turns, as the reference computes it. At these
/// times the face is seen edge on, so the sine is zero up to rounding.
double print_turns(const Segment& segment, const Vec3d& direction, int wanted) {
  double largest = 0;
  for (std::size_t f = 0; f < segment.topology->face_count() && wanted > 0; ++f) {
    const Facing facing = find_facing(segment, f, View::of_direction(direction));
    if (facing.count != 2 || facing.first() != Side::kBack) continue;
    std::printf("%8zu  %13.9f  %13.9f\n", f, facing.at[0].lower, facing.at[1].lower);
    --wanted;
    for (const FacingChange& turn : facing.changes()) {
      Vec3d edge_on;
      reference_normals(segment, {f, 1}, turn.lower, {&edge_on, 1});
      largest = std::max(largest, std::fabs(dot(unit(edge_on), unit(direction))));
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
  const double edge_on = print_turns(motion.segment(1), kEye, 4);
  std::printf("\nfaces are edge on at these times to %.0e rad\n", edge_on);

  const bool holds =
      total.exact_wrong == 0 && total.refuted == 0 && edge_on < 1e-9 && total.linear_wrong > 0 && total.seen_inside > 0;
  if (!holds) std::fprintf(stderr, "culling: exact normals should have decided every face right, and only they\n");
  return holds ? 0 : 1;
}
