// Times queries about a whole segment that are answered from control normals in memory: when faces collapse, and from
// which side a viewer sees them. For comparison, also times the evaluation of the same control normals at one t, and
// the methods by which other programs answer such queries.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "chronormal/analysis/signs.h"
#include "chronormal/normals/normal_curves.h"
#include "groups/groups.h"

namespace chronormal::bench {
namespace {

const View kStill = View::of_eye({4, -5, 2}), kMoving = View::of_moving_eye({4, -5, 2}, {5, -4, 1}),
           kFar = View::of_direction({4, -5, 2});

struct Question {
  Segment segment;
  std::vector<ControlNormals> normals;
  std::vector<ShutterSide> sides;
  std::vector<Facing> facings;  // result for one block of faces

  explicit Question(const Segment& of)
      : segment(of), normals(of.topology->face_count()), sides(of.topology->face_count()), facings(1024) {
    face_control_normals(segment, {0, normals.size()}, normals);
  }
};

Vec3d way_at(const Segment& segment, std::size_t face, const View& view, double t) {
  const std::uint32_t a = segment.topology->face(face)[0];
  const Vec3d viewer = lerp(view.from, view.to, t);
  if (!view.is_eye) return viewer;
  return viewer - lerp(to_double(segment.from[a]), to_double(segment.to[a]), t);
}

// Finds which sides of a face the viewer sees at `samples` values of t, as a renderer without exact answers does.
ShutterSide side_by_samples(const Question& q, std::size_t face, const View& view, int samples) {
  bool is_front = false, is_back = false;
  for (int i = 0; i < samples; ++i) {
    const double t = i / (samples - 1.0), f = dot(normal_at(q.normals[face], t), way_at(q.segment, face, view, t));
    is_front |= f > 0;
    is_back |= f < 0;
  }
  if (!is_front) return ShutterSide::kBack;
  return is_back ? ShutterSide::kBoth : ShutterSide::kFront;
}

// Decides by the test of Munkberg and Akenine-Moller: a face can be culled if no Bernstein coefficient of the dot
// product of n(t) and the vector to the viewer, a cubic in t, is positive. Ignores rounding, as published.
ShutterSide side_by_coefficients(const Question& q, std::size_t face, const View& view) {
  const ControlNormals& c = q.normals[face];
  const Vec3d from = way_at(q.segment, face, view, 0), to = way_at(q.segment, face, view, 1);
  const double b0 = dot(c.n0, from), b1 = dot(c.n0, to) + 2 * dot(c.m, from), b2 = 2 * dot(c.m, to) + dot(c.n1, from),
               b3 = dot(c.n1, to);
  if (std::max({b0, b1, b2, b3}) <= 0) return ShutterSide::kBack;
  return std::min({b0, b1, b2, b3}) >= 0 ? ShutterSide::kFront : ShutterSide::kBoth;
}

std::string culled(const std::vector<ShutterSide>& sides) {
  const auto count = std::count(sides.begin(), sides.end(), ShutterSide::kBack);
  return fmt::format("culls {:.2f} % of the faces",
                     100.0 * static_cast<double>(count) / static_cast<double>(sides.size()));
}

// Checks the results of some faces against the sides that the viewer sees at kSamples values of t. Throws
// std::runtime_error if a face that is called front or back shows its other side at one of these t.
void verify(const Question& q, const View& view) {
  constexpr int kSamples = 257;
  const std::size_t step = std::max<std::size_t>(1, q.sides.size() / 500);
  for (std::size_t f = 0; f < q.sides.size(); f += step) {
    const ShutterSide sampled = side_by_samples(q, f, view, kSamples);
    if (q.sides[f] != ShutterSide::kBoth && sampled != q.sides[f])
      throw std::runtime_error(fmt::format("uses: face {} is not seen from the side that was said", f));
  }
}

}  // namespace

void run_uses(Suite& suite, const Size& size) {
  const std::string group = "uses";
  CaseList list(suite, group, size);
  suite.say(fmt::format("{}, {}, {}: mesh", group, size.name, size.order()));
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kFaces);
  const auto q = std::make_shared<Question>(mesh.segment());
  const std::size_t count = q->normals.size();
  const auto made = [&](const std::string& name, const std::string& note, std::function<void()> run) {
    list.add(name, [&] {
      Case one;
      one.note = note;
      one.run = std::move(run);
      return one;
    });
  };

  const auto curves = std::make_shared<NormalCurves>(q->normals);
  const auto unit_normals = std::make_shared<std::vector<float>>(3 * count);
  made("unit normals at one t, curves", "float32, for scale",
       [=] { (void)curves->unit_normals(kTime, VectorView<float>::packed(unit_normals->data(), count)); });
  made("unit normals at one t, double", "unit_normal_at() of the same control normals", [=] {
    for (std::size_t f = 0; f < count; ++f) {
      const Vec3d u = unit_normal_at(q->normals[f], kTime).vector;
      (*unit_normals)[f] = static_cast<float>(u.x + u.y + u.z);
    }
  });
  made("collapse", "decided exactly", [=] {
    if (!find_collapses(q->segment, {0, count}, q->normals).empty())
      throw std::runtime_error("uses: a face of the torus collapses, and none does");
  });
  for (const auto& [name, view] : {std::pair{"direction", kFar}, {"eye", kStill}, {"moving eye", kMoving}}) {
    const auto all_sides = [=, view = view] { sides_over(q->segment, {0, count}, q->normals, view, 0, 1, q->sides); };
    all_sides();
    verify(*q, view);
    made(fmt::format("facing over a shutter, {}", name), culled(q->sides), all_sides);
    made(fmt::format("facing, when it changes, {}", name), "brackets of every change", [=, view = view] {
      std::size_t changes = 0;
      for (std::size_t first = 0; first < count; first += q->facings.size()) {
        const IndexRange part{first, std::min(q->facings.size(), count - first)};
        find_facings(q->segment, part, std::span(q->normals).subspan(first, part.count), view,
                     std::span(q->facings).first(part.count));
        for (std::size_t i = 0; i < part.count; ++i) changes += q->facings[i].count;
      }
      if (changes > 3 * count) throw std::runtime_error("uses: a cubic has three roots");
    });
  }
  const auto with = [&](const std::string& name, auto side_of) {
    std::vector<ShutterSide> sides(count);
    const auto all_sides = [=](std::vector<ShutterSide>& result) {
      for (std::size_t f = 0; f < count; ++f) result[f] = side_of(f);
    };
    all_sides(sides);
    made(name, culled(sides), [=] { all_sides(q->sides); });
  };
  with("Munkberg's test, moving eye", [=](std::size_t f) { return side_by_coefficients(*q, f, kMoving); });
  with("16 samples, moving eye", [=](std::size_t f) { return side_by_samples(*q, f, kMoving, 16); });
  suite.run(group, size, count, oracle, list.take());
}

}  // namespace chronormal::bench
