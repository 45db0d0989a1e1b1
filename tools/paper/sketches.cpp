// Section 7: the paper's Figures 1 and 3, which are sketches there, drawn from a face of twist.

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

using Points = std::vector<std::pair<double, double>>;

// Two directions on paper.
struct View {
  Vec3d right, up;

  [[nodiscard]] std::pair<double, double> of(const Vec3d& p) const { return {dot(p, right), dot(p, up)}; }
  // The view against `towards`, with `along` to the right.
  static View against(const Vec3d& towards, const Vec3d& along) {
    const Vec3d right = unit(along - dot(along, towards) * towards);
    return {right, cross(towards, right)};
  }
};

// The one face of this section: where its corners are, seen from its centre, and its exact normal.
struct Face {
  std::array<Vec3d, 3> from, to;
  ControlNormals normals;

  [[nodiscard]] Vec3d exact(double t) const { return unit_normal_at(normals, t).vector; }
};

Face face_of(const Segment& segment, std::size_t index) {
  Face face;
  Vec3d centre0, centre1;
  const auto corners = segment.topology->face(index);
  for (std::size_t c = 0; c < 3; ++c) {
    face.from[c] = to_double(segment.from[corners[c]]);
    face.to[c] = to_double(segment.to[corners[c]]);
    centre0 = centre0 + (1.0 / 3) * face.from[c];
    centre1 = centre1 + (1.0 / 3) * face.to[c];
  }
  for (std::size_t c = 0; c < 3; ++c) face.from[c] = face.from[c] - centre0, face.to[c] = face.to[c] - centre1;
  std::vector<ControlNormals> normals(1);
  face_control_normals(segment, {index, 1}, normals);
  face.normals = normals[0];
  return face;
}

// A point of the great circle through two unit vectors.
Vec3d on_arc(const Vec3d& a, const Vec3d& b, double t) {
  const double angle = angle_between(a, b);
  if (angle < 1e-9) return a;
  return (1 / std::sin(angle)) * (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b);
}

template <class Curve>
Points path(const View& view, Curve curve) {
  Points points;
  for (int i = 0; i <= 100; ++i) points.push_back(view.of(curve(i / 100.0)));
  return points;
}

Figure triangle_figure(const Face& face) {
  const Vec3d u0 = face.exact(0), u1 = face.exact(1);
  // From above both normals and aside, so that neither they nor the triangles are seen along.
  const View view = View::against(unit(unit(cross(u1, u0)) + 0.8 * unit(u0 + u1)), u1 - u0);
  double size = 0;
  for (const auto& corners : {face.from, face.to}) {
    for (const Vec3d& p : corners) size = std::max(size, length(p));
  }
  Panel panel;
  panel.x = {"", -1.2, 1.2, false, {{0, ""}}};
  panel.y = {"", -0.8, 1.15, false, {{0, ""}}};
  panel.legend = "outside right center Left reverse width -4";
  panel.equal_axes = true;
  const auto corner = [&](std::size_t c, double t) { return view.of((1 / size) * lerp(face.from[c], face.to[c], t)); };
  for (std::size_t c = 0; c < 3; ++c)
    panel.series.push_back(
        {c == 0 ? "paths of the vertices" : "", {corner(c, 0), corner(c, 1)}, Colour::kGrey, 1, true});
  constexpr std::array kTimes = {0.25, 0.5, 0.75, 0.0, 1.0};  // the ends last, above the others
  const Vec3d centre;
  for (const double t : kTimes) {
    const bool start = t == 0, end = t == 1, middle = t == 0.5;
    const Colour colour = start ? Colour::kBlue : end ? Colour::kRed : Colour::kGrey;
    panel.series.push_back({start    ? "t = 0"
                            : end    ? "t = 1"
                            : middle ? "between"
                                     : "",
                            {corner(0, t), corner(1, t), corner(2, t), corner(0, t)},
                            colour,
                            start || end ? 2.0 : 1.0});
    if (start || end) {
      panel.series.push_back({"", {view.of(centre), view.of(face.exact(t))}, colour, 2.4});
      continue;
    }
    panel.series.push_back(
        {middle ? "exact normals" : "", {view.of(centre), view.of(face.exact(t))}, Colour::kBlack, 2});
    panel.series.push_back(
        {middle ? "linear normals" : "", {view.of(centre), view.of(unit(lerp(u0, u1, t)))}, Colour::kSky, 1.6, true});
  }
  return {"figure1", 860, 420, 1, {panel}};
}

Panel sphere_panel(const char* title, const Face& face, const View& view) {
  Panel panel;
  panel.title = title;
  panel.x = {"", -0.9, 0.9, false, {}};
  panel.y = {"", -0.45, 0.95, false, {}};
  panel.legend = "at graph 0.02,0.98 left top Left reverse";
  panel.equal_axes = true;
  panel.series.push_back({"exact", path(view, [&](double t) { return face.exact(t); }), Colour::kBlack, 2.4});
  return panel;
}

}  // namespace

void draw_sketches(Page& page) {
  const Segment segment = morph("twist").segment(0);
  const Comparison comparison = compare(morph("twist"), {{"linear"}, 21, Access::kRandom, {}}).value();
  const std::size_t index = comparison.schemes[0].quality.max_at.element;
  const Face face = face_of(segment, index);
  const Vec3d u0 = face.exact(0), u1 = face.exact(1), half = face.exact(0.5);

  page.picture("figure1", triangle_figure(face));
  double turned = 0;
  for (int i = 0; i < 1000; ++i) turned += degrees_between(face.exact(i / 1000.0), face.exact((i + 1) / 1000.0));
  require(turned > degrees_between(u0, u1), "the exact normal takes no short cut");
  page.set({{"ends_apart", grouped(degrees_between(u0, u1), 1)}, {"path_length", grouped(turned, 1)}});

  // De Casteljau, by its levels: arcs between neighbours, and the points at t = 1/2 on them.
  const View view = View::against(unit(u0 + half + u1), u1 - u0);
  const auto at = [&](const char* scheme, double t) { return PreparedScheme(scheme, segment, {index, 1}).at(t)[0]; };
  Panel casteljau = sphere_panel("(a) de Casteljau with four normals", face, view);
  std::vector<Vec3d> level = {u0, face.exact(1.0 / 3), face.exact(2.0 / 3), u1};
  Points controls;
  for (const Vec3d& n : level) controls.push_back(view.of(n));
  bool first = true;
  while (level.size() > 1) {
    std::vector<Vec3d> next;
    for (std::size_t i = 0; i + 1 < level.size(); ++i) {
      casteljau.series.push_back({first ? "arcs, at t = 1/2" : "",
                                  path(view, [&](double t) { return on_arc(level[i], level[i + 1], t); }),
                                  Colour::kGrey, 1.2});
      next.push_back(on_arc(level[i], level[i + 1], 0.5));
      first = false;
    }
    level = next;
  }
  casteljau.series.push_back({"exact normals", controls, Colour::kBlack, 0, false, Mark::kDisc, 0.7});
  casteljau.series.push_back(
      {"decasteljau:4", path(view, [&](double t) { return at("decasteljau:4", t); }), Colour::kPurple, 2});
  casteljau.series.push_back({"", {view.of(level[0])}, Colour::kPurple, 0, false, Mark::kSquare, 0.7});
  require(degrees_between(level[0], at("decasteljau:4", 0.5)) < 1e-4, "the construction is the scheme");

  Panel frames = sphere_panel("(b) frames run on circles", face, view);
  struct Circle {
    const char* scheme;
    Colour colour;
    Mark mark;
  };
  constexpr Circle kCircles[] = {{"slerp", Colour::kSky, Mark::kCross},
                                 {"quaternion:matrix", Colour::kBlue, Mark::kSquare},
                                 {"quaternion:optimal", Colour::kRed, Mark::kDiamond},
                                 {"circle", Colour::kGreen, Mark::kCircle}};
  for (const auto& [scheme, colour, mark] : kCircles) {
    const PreparedScheme prepared(scheme, segment, {index, 1});
    frames.series.push_back({scheme, path(view, [&](double t) { return prepared.at(t)[0]; }), colour, 1.8});
    frames.series.push_back({"", {view.of(prepared.at(0.5)[0])}, colour, 0, false, mark, 0.8});
  }
  frames.series.push_back({"", {view.of(half)}, Colour::kBlack, 0, false, Mark::kDisc, 0.7});
  page.picture("figure3", {"figure3", 900, 420, 2, {casteljau, frames}});
  require(dot(at("circle", 0.5) - half, u1 - u0) > 0, "circle is past the middle at t = 1/2");
  for (const auto& [name, scheme] : {std::pair{"casteljau_half", "decasteljau:4"},
                                     {"slerp_half", "slerp"},
                                     {"matrix_half", "quaternion:matrix"},
                                     {"optimal_half", "quaternion:optimal"},
                                     {"circle_half", "circle"}})
    page.set(name, grouped(degrees_between(at(scheme, 0.5), half), 1));
}

}  // namespace chronormal::paper
