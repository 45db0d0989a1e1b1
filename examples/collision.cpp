// Computes collision response with the normal at the contact time: balls are thrown at a sheet that waves.
//
// A ball (a point here) moves on a straight line, and so does every vertex of the sheet. Containment::crossings() finds
// where a ball crosses the surface: the face, the time, and the unit normal of the face at that time. It promises that
// no contact is missed. This promise is only possible for closed meshes, so the sheet becomes the top of a cushion. At
// the contact, the velocity relative to the sheet is mirrored. The normal thus decides where the ball goes: an error of
// the normal changes the outgoing direction by up to twice as much.

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace {

using namespace chronormal;

constexpr int kBalls = 100;

struct Ball {
  // The position at t = 0 in units of length, and the velocity in units of length per segment.
  Vec3d position, velocity;
};

/// The path of a moving vertex: a line from its position at one end of the segment to that at the other end.
struct Line {
  Vec3d from, to;
};
std::array<Line, 3> corners(const Segment& segment, std::size_t face) {
  const auto line = [&segment](std::uint32_t v) { return Line{to_double(segment.from[v]), to_double(segment.to[v])}; };
  const auto v = segment.topology->face(face);
  return {line(v[0]), line(v[1]), line(v[2])};
}

/// Returns the motion of a closed mesh. It has the faces of the sheet, and a face from every edge of the border of the
/// sheet to a vertex below.
Motion cushion(Motion sheet) {
  // For each edge (a, b), the number of faces that have it from a to b, minus the number of faces that have it from b
  // to a.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> passed;
  const std::span<const std::uint32_t> corners = sheet.topology.corners();
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t a = corners[c], b = corners[c % 3 == 2 ? c - 2 : c + 1];
    ++passed[{a, b}];
    --passed[{b, a}];
  }
  std::vector<std::uint32_t> closed(corners.begin(), corners.end());
  const auto below = static_cast<std::uint32_t>(sheet.topology.vertex_count());
  for (const auto& [edge, count] : passed) {
    if (count == 1) closed.insert(closed.end(), {edge.second, edge.first, below});
  }
  for (Motion::Keyframe& keyframe : sheet.keyframes) keyframe.positions.insert(keyframe.positions.end(), {0, 0, -1});
  sheet.topology = Topology::triangles(below + 1, std::move(closed)).value();
  return sheet;
}

/// Returns the velocity of the sheet at the point where a ball meets it. The weight of a corner is the area between the
/// ball and the opposite edge, as a share of the face.
Vec3d surface_velocity(const Segment& segment, const Ball& ball, const Crossing& contact) {
  const std::array<Line, 3> moving = corners(segment, contact.face);
  const Vec3d p = ball.position + contact.t * ball.velocity;
  std::array<Vec3d, 3> to;
  for (std::size_t k = 0; k < 3; ++k) to[k] = lerp(moving[k].from, moving[k].to, contact.t) - p;
  std::array<double, 3> areas;
  for (std::size_t k = 0; k < 3; ++k) areas[k] = dot(contact.normal, cross(to[(k + 1) % 3], to[(k + 2) % 3]));
  Vec3d velocity;
  for (std::size_t k = 0; k < 3; ++k)
    velocity = velocity + (areas[k] / (areas[0] + areas[1] + areas[2])) * (moving[k].to - moving[k].from);
  return velocity;
}

/// Reflects a velocity elastically at a plane with the unit normal `normal`.
Vec3d reflect(const Vec3d& velocity, const Vec3d& normal) { return velocity - (2 * dot(velocity, normal)) * normal; }

/// Computes the same response independently, from positions alone. The contact time comes from a bisection of the
/// volume, which is recomputed from the corners at each step, and the normal from the cross product.
Vec3d independent_response(const Segment& segment, const Ball& ball, const Crossing& contact) {
  const std::array<Line, 3> moving = corners(segment, contact.face);
  const auto normal = [&moving](double t) {
    const Vec3d a = lerp(moving[0].from, moving[0].to, t);
    return cross(lerp(moving[1].from, moving[1].to, t) - a, lerp(moving[2].from, moving[2].to, t) - a);
  };
  const auto volume = [&](double t) {
    return dot(normal(t), ball.position + t * ball.velocity - lerp(moving[0].from, moving[0].to, t));
  };
  double before = contact.t - 1e-3, after = contact.t + 1e-3;
  for (int i = 0; i < 60; ++i) {
    const double middle = (before + after) / 2;
    ((volume(middle) < 0) == (volume(before) < 0) ? before : after) = middle;
  }
  return reflect(ball.velocity - surface_velocity(segment, ball, contact), unit(normal(before)));
}

/// Returns how far the ball is outside the face that it meets, as a share of the area of the face. It is the amount by
/// which the areas of the three triangles between the ball and the edges exceed the area of the face.
double area_outside(const Segment& segment, const Ball& ball, const Crossing& contact) {
  const Vec3d p = ball.position + contact.t * ball.velocity;
  std::array<Vec3d, 3> to;
  for (std::size_t k = 0; k < 3; ++k) {
    const Line corner = corners(segment, contact.face)[k];
    to[k] = lerp(corner.from, corner.to, contact.t) - p;
  }
  const double sum = length(cross(to[0], to[1])) + length(cross(to[1], to[2])) + length(cross(to[2], to[0]));
  return sum / length(cross(to[1] - to[0], to[2] - to[0])) - 1;
}

}  // namespace

int main() {
  // Take a sheet with a wave, which moves by a fifth of a wavelength within the segment.
  const Motion motion = cushion(make_builtin_morph("cloth").value());
  const Segment segment = motion.segment(1);
  const Containment containment =
      Containment::make(motion.topology, separate_points(motion.topology.vertex_count()), segment.from).value();

  std::vector<Ball> balls;
  std::vector<float> from, to;
  for (int i = 0; i < kBalls; ++i) {
    const Vec3f start{-0.6F + 0.08F * static_cast<float>(i % 10), -0.4F + 0.08F * static_cast<float>(i / 10), 0.4F};
    const Vec3f end = start + Vec3f{0.4F, 0, -0.72F};
    balls.push_back({to_double(start), to_double(end) - to_double(start)});
    from.insert(from.end(), {start.x, start.y, start.z});
    to.insert(to.end(), {end.x, end.y, end.z});
  }
  const std::vector<Crossing> crossings =
      containment.crossings(segment, VectorView<const float>::packed(from), VectorView<const float>::packed(to));

  // A normal that the response could use, and the errors of the directions in which balls leave with this normal.
  struct Choice {
    const char* name;
    double sum = 0, max = 0;  // sum and maximum of the errors, in degrees
    int through = 0;          // number of balls that go on through the sheet
  };
  std::array<Choice, 5> choices{{{"start"}, {"end"}, {"linear"}, {"slerp"}, {"exact"}}};

  int hits = 0;
  std::uint32_t last = kBalls;
  double energy_error = 0, difference = 0, outside = 0;
  for (const Crossing& contact : crossings) {
    if (contact.point == last) continue;  // only the first crossing of each ball is its contact
    last = contact.point;
    const Ball& ball = balls[contact.point];
    ++hits;
    outside = std::fmax(outside, area_outside(segment, ball, contact));

    // In the frame of the surface, the collision is a reflection. Adding the velocity of the surface afterwards returns
    // to the frame of the world.
    const double t = contact.t;
    ControlNormals n;
    face_control_normals(segment, {contact.face, 1}, {&n, 1});
    const Vec3d start = unit(n.n0), end = unit(n.n1), exact = contact.normal;
    const double turn = angle_between(start, end);
    const Vec3d slerp = unit(std::sin((1 - t) * turn) * start + std::sin(t * turn) * end);
    const Vec3d incoming = ball.velocity - surface_velocity(segment, ball, contact),
                outgoing = reflect(incoming, exact);
    energy_error = std::fmax(energy_error, std::fabs(dot(outgoing, outgoing) / dot(incoming, incoming) - 1));
    const Vec3d other = independent_response(segment, ball, contact);
    difference = std::fmax(difference, length(outgoing - other) / length(other));

    const std::array<Vec3d, 5> used{start, end, unit(lerp(start, end, t)), slerp, exact};
    for (std::size_t k = 0; k < used.size(); ++k) {
      const Vec3d sent = reflect(incoming, used[k]);
      const double off = kDegreesPerRadian * angle_between(sent, other);
      choices[k].sum += off;
      choices[k].max = std::fmax(choices[k].max, off);
      choices[k].through += dot(sent, exact) * dot(incoming, exact) > 0;
    }
  }

  std::printf("%d balls, %d hit the sheet\n\n", kBalls, hits);
  std::printf("normal    error of the direction  go through\n");
  std::printf("         mean deg         max deg       balls\n");
  for (const Choice& choice : choices)
    std::printf("%-7s  %8.4f  %14.4f  %10d\n", choice.name, choice.sum / hits, choice.max, choice.through);
  std::printf("\nenergy in the frame of the sheet: kept to %.0e\n", energy_error);
  std::printf("independent response: the same to %.0e\n", difference);

  bool holds = hits == kBalls && outside < 1e-9 && energy_error < 1e-13 && difference < 1e-9;
  for (const Choice& choice : choices) holds = holds && (choice.max > 10) == (&choice != &choices.back());
  holds = holds && choices.back().max < 1e-6 && choices.back().through == 0;
  if (!holds) std::fprintf(stderr, "collision: the exact normal should have been right, and only that one\n");
  return holds ? 0 : 1;
}
