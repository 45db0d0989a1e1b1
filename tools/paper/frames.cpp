// Section 5: frames drawn at random, and the one angle that they all come down to.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

constexpr std::size_t kSeeds = 200, kPairs = 2000, kSamples = 21;

// Everything is relative to linear. Frames that are constructed or searched for, and circles.
struct Choice {
  const char* scheme;
  Colour colour;
  Mark mark;
};
constexpr std::array kChoices = {
    Choice{"slerp", Colour::kBlack, Mark::kCross},
    Choice{"quaternion:edge", Colour::kSky, Mark::kOpenSquare},
    Choice{"quaternion:polar", Colour::kPurple, Mark::kOpenTriangle},
    Choice{"quaternion:matrix", Colour::kBlue, Mark::kSquare},
    Choice{"quaternion:optimal", Colour::kRed, Mark::kDiamond},
    Choice{"circle", Colour::kGreen, Mark::kCircle},
    Choice{"circle:timed", Colour::kOrange, Mark::kTriangle},
};
constexpr std::size_t kMatrix = 3, kOptimal = 4, kCircle = 5, kTimed = 6;

struct Spread {
  std::string name;
  std::vector<double> random;   // a mesh's sum for each seed
  std::vector<double> best_of;  // the sum with the best of the first k + 1 seeds on each face
  std::array<double, kChoices.size()> constructed{};
  double pairs_that_beat_matrix = 0;  // share of random pairs of frames
  double faces_that_can = 0;          // share of faces on which one of the seeds beats matrix
  double quadratic = 0;

  // The sum of one choice over that of another.
  [[nodiscard]] double over(std::size_t choice, std::size_t other) const {
    return constructed[choice] / constructed[other];
  }
};

Spread measure(const Morph& m) {
  Spread spread{m.name, {}, {}};
  const Motion part = some_pairs(m.motion, kPairs);
  const PairErrors errors(part, kSamples);
  const double linear = sum(errors.sums("linear"));
  std::vector<std::vector<double>> by_seed(kSeeds), constructed(kChoices.size());
  parallel_for(kSeeds,
               [&](std::size_t seed) { by_seed[seed] = errors.sums(fmt::format("quaternion:random:{}", seed)); });
  parallel_for(kChoices.size(), [&](std::size_t c) { constructed[c] = errors.sums(kChoices[c].scheme); });
  for (std::size_t c = 0; c < kChoices.size(); ++c) spread.constructed[c] = sum(constructed[c]) / linear;
  spread.quadratic = sum(errors.sums("quadratic")) / linear;

  std::vector<double> best = by_seed[0];
  std::vector<char> can(errors.pairs(), 0);
  double beats = 0;
  for (const auto& sums : by_seed) {
    spread.random.push_back(sum(sums) / linear);
    for (std::size_t p = 0; p < sums.size(); ++p) {
      best[p] = std::min(best[p], sums[p]);
      if (sums[p] < constructed[kMatrix][p]) ++beats, can[p] = 1;
    }
    spread.best_of.push_back(sum(best) / linear);
  }
  const double pairs = static_cast<double>(errors.pairs());
  spread.pairs_that_beat_matrix = beats / (pairs * kSeeds);
  spread.faces_that_can = static_cast<double>(std::count(can.begin(), can.end(), 1)) / pairs;
  return spread;
}

// The spread over seeds, and what is constructed, a row a morph.
Figure random_figure(const std::vector<Spread>& spreads) {
  Panel panel;
  panel.x = {"sum of angles relative to linear",
             0.11,
             4,
             true,
             {{0.2, "0.2"}, {0.3, "0.3"}, {0.5, "0.5"}, {1, "1"}, {2, "2"}, {3, "3"}}};
  panel.y = {"", 0.4, 4.6, false, {}};
  panel.legend = "outside right center Left reverse width -4";
  Series random{fmt::format("random, {} seeds", kSeeds), {}, Colour::kGrey, 0, false, Mark::kDisc, 0.3};
  Series best{fmt::format("random, best of {} per face", kSeeds), {}, Colour::kGrey, 0, false, Mark::kDisc, 1.0};
  // Marks stand a little above each other, so that none hides another.
  const auto height = [&spreads](std::size_t m, std::size_t mark) {
    return static_cast<double>(spreads.size() - m) + 0.35 - 0.1 * static_cast<double>(mark);
  };
  for (std::size_t m = 0; m < spreads.size(); ++m) {
    const double y = static_cast<double>(spreads.size() - m);
    panel.y.ticks.emplace_back(y, spreads[m].name);
    for (std::size_t seed = 0; seed < kSeeds; ++seed)
      random.points.emplace_back(spreads[m].random[seed], y - 0.35 + 0.7 * static_cast<double>(seed) / kSeeds);
    best.points.emplace_back(spreads[m].best_of.back(), height(m, kChoices.size()));
  }
  panel.series = {random};
  for (std::size_t c = 0; c < kChoices.size(); ++c) {
    Series series{kChoices[c].scheme, {}, kChoices[c].colour, 0, false, kChoices[c].mark, 0.9};
    for (std::size_t m = 0; m < spreads.size(); ++m)
      series.points.emplace_back(spreads[m].constructed[c], height(m, c));
    panel.series.push_back(series);
  }
  panel.series.push_back(best);
  return {"frames_random", 860, 460, 1, {panel}};
}

// What trying k random pairs on each face gives.
Figure best_of_figure(const std::vector<Spread>& spreads) {
  Figure figure{"frames_best_of", 900, 300, 4, {}};
  for (const Spread& spread : spreads) {
    const bool first = figure.panels.empty(), last = figure.panels.size() + 1 == spreads.size();
    Panel panel;
    panel.title = spread.name;
    panel.x = {"pairs tried per face", 1, 200, true, {{1, "1"}, {10, "10"}, {100, "100"}}};
    panel.y = {first ? "sum relative to linear" : "",
               0,
               3.4,
               false,
               {{0, "0"}, {0.5, ""}, {1, "1"}, {1.5, ""}, {2, "2"}, {2.5, ""}, {3, "3"}}};
    if (last) panel.legend = "at graph 0.02,0.98 left top Left reverse";
    Series random{"best random pair", {}, Colour::kGrey, 2.5};
    for (std::size_t k = 0; k < kSeeds; ++k) random.points.emplace_back(static_cast<double>(k + 1), spread.best_of[k]);
    panel.series.push_back(random);
    for (const auto& [c, title] : {std::pair{kMatrix, "matrix"}, {kOptimal, "optimal"}}) {
      const double y = spread.constructed[c];
      panel.series.push_back({title, {{1, y}, {200, y}}, kChoices[c].colour, 1.6, true});
    }
    figure.panels.push_back(panel);
  }
  return figure;
}

// One face: the mean error of the circle about axis(phi), by eq. 6 and 7, in degrees.
class OneAngle {
 public:
  explicit OneAngle(const ControlNormals& normals)
      : u0_(unit_normal_at(normals, 0).vector),
        u1_(unit_normal_at(normals, 1).vector),
        pole_(unit(cross(u0_, u1_))),
        bisector_(unit(u0_ + u1_)) {
    for (int i = 0; i <= 200; ++i) exact_.push_back(unit_normal_at(normals, i / 200.0).vector);
  }

  [[nodiscard]] double mean_error(double phi) const {
    const Vec3d axis = std::cos(phi) * pole_ + std::sin(phi) * bisector_;
    const Vec3d w = dot(axis, u0_) * axis, p = u0_ - w, q = cross(axis, u0_);
    double arc = std::atan2(dot(q, u1_), dot(p, u1_));
    if (arc < 0) arc += 2 * kPi;
    double total = 0;
    for (std::size_t i = 0; i < exact_.size(); ++i) {
      const double angle = arc * static_cast<double>(i) / static_cast<double>(exact_.size() - 1);
      total += degrees_between(w + std::cos(angle) * p + std::sin(angle) * q, exact_[i]);
    }
    return total / static_cast<double>(exact_.size());
  }

  /// phi of a scheme that runs on a circle, from where it is at t = 1/2.
  [[nodiscard]] double phi_of(const Vec3d& middle) const {
    const Vec3d axis = cross(middle - u0_, u1_ - u0_);
    return std::atan2(dot(axis, bisector_), dot(axis, pole_));
  }

  /// The mean error of a scheme on the same samples.
  [[nodiscard]] double mean_error_of(const PreparedScheme& scheme) const {
    double total = 0;
    for (std::size_t i = 0; i < exact_.size(); ++i)
      total +=
          degrees_between(scheme.at(static_cast<double>(i) / static_cast<double>(exact_.size() - 1))[0], exact_[i]);
    return total / static_cast<double>(exact_.size());
  }

 private:
  Vec3d u0_, u1_, pole_, bisector_;
  std::vector<Vec3d> exact_;
};

// Of the faces of segment 0, the one whose linear error is at this place of their order.
std::size_t face_at(const Motion& motion, double share) {
  const PairErrors errors(motion, kSamples);
  std::vector<double> sums = errors.sums("linear");
  sums.resize(motion.topology.face_count());
  const double wanted = quantile(sums, share);
  return static_cast<std::size_t>(std::find(sums.begin(), sums.end(), wanted) - sums.begin());
}

Figure angle_figure(double& disagreement) {
  Figure figure{"frames_angle", 900, 360, 3, {}};
  disagreement = 0;
  const std::array<std::pair<const char*, double>, 3> shown = {{{"cloth", 0.5}, {"twist", 0.5}, {"eversion", 0.5}}};
  for (const auto& [name, share] : shown) {
    const Motion part = some_pairs(morph(name), kPairs);
    const Segment segment = part.segment(0);
    const std::size_t face = face_at(part, share);
    std::vector<ControlNormals> normals(1);
    face_control_normals(segment, {face, 1}, normals);
    const OneAngle angle(normals[0]);

    Panel panel;
    panel.title = fmt::format("a face of {}", name);
    panel.x = {"phi, degrees", -180, 180, false, {{-180, "-180"}, {-90, "-90"}, {0, "0"}, {90, "90"}, {180, "180"}}};
    panel.bands = {{-180, -90}, {90, 180}};
    Series curve{"", {}, Colour::kGrey, 2.2};
    for (int i = -180; i <= 180; ++i) curve.points.emplace_back(i, angle.mean_error(i / kDegreesPerRadian));
    panel.series.push_back(curve);
    double top = 0;
    for (std::size_t c = 0; c < kTimed; ++c) {
      const PreparedScheme scheme(kChoices[c].scheme, segment, {face, 1});
      const double phi = angle.phi_of(scheme.at(0.5)[0]), error = angle.mean_error(phi);
      top = std::max(top, error);
      // The arc that eq. 6 and 7 give is the scheme.
      disagreement = std::max(disagreement, std::fabs(error - angle.mean_error_of(scheme)));
      const std::string scheme_name = kChoices[c].scheme;
      panel.series.push_back({scheme_name.substr(scheme_name.find(':') + 1),
                              {{kDegreesPerRadian * phi, error}},
                              kChoices[c].colour,
                              0,
                              false,
                              kChoices[c].mark,
                              1.1});
    }
    const bool first = figure.panels.empty();
    panel.y = {first ? "mean error, degrees" : "", 0, 2.4 * top, false, {}};
    if (figure.panels.size() == 2) panel.legend = "at graph 0.5,0.97 center top Left reverse";
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace

void measure_frames(Page& page) {
  std::vector<Spread> spreads;
  for (const Morph& m : morphs()) spreads.push_back(measure(m));
  std::vector<Cells> rows;
  Cells header = {"sum relative to linear"};
  for (const Spread& s : spreads) header.push_back(s.name);
  const auto add_row = [&](std::string name, auto value) {
    Cells cells = {std::move(name)};
    for (const Spread& s : spreads) cells.push_back(value(s));
    rows.push_back(std::move(cells));
  };
  add_row("random, mean of the seeds", [](const Spread& s) { return ratio(sum(s.random) / kSeeds); });
  add_row("random, least and most",
          [](const Spread& s) { return fmt::format("{} to {}", ratio(smallest(s.random)), ratio(largest(s.random))); });
  add_row(fmt::format("random, best of {} on each face", kSeeds),
          [](const Spread& s) { return ratio(s.best_of.back()); });
  for (std::size_t c = 0; c < kChoices.size(); ++c)
    add_row(fmt::format("`{}`", kChoices[c].scheme), [c](const Spread& s) { return ratio(s.constructed[c]); });
  add_row("random pairs better than `matrix`", [](const Spread& s) { return percent(s.pairs_that_beat_matrix, 1); });
  add_row(fmt::format("faces where one of {} is", kSeeds),
          [](const Spread& s) { return percent(s.faces_that_can, 1); });
  page.table("frames", header, rows);
  page.picture("frames_random", random_figure(spreads));
  page.picture("frames_best_of", best_of_figure(spreads));

  double widest = 0;
  for (const Spread& s : spreads) {
    widest = std::max(widest, largest(s.random) / smallest(s.random) - 1);
    require(smallest(s.random) > s.constructed[kMatrix], "no seed beats matrix on a mesh");
    require(s.best_of.back() < s.constructed[kMatrix], "the best random pairs beat matrix");
    require(s.best_of.back() > s.constructed[kOptimal], "no random pairs beat the optimum");
    page.set(fmt::format("random_wins_{}", s.name), percent(s.pairs_that_beat_matrix));
    page.set(fmt::format("faces_won_{}", s.name), percent(s.faces_that_can));
    page.set(fmt::format("optimal_saves_{}", s.name), percent(1 - s.over(kOptimal, kMatrix)));
  }
  double disagreement = 0;
  page.picture("frames_angle", angle_figure(disagreement));
  require(disagreement < 1e-3, "eq. 6 and 7 give what the schemes give");

  rows.clear();
  header[0] = "ratio of sums";
  const auto times = [](double factor) { return fmt::format("{:.2f}", factor); };
  add_row("`optimal` against linear", [](const Spread& s) { return ratio(s.constructed[kOptimal]); });
  add_row("`optimal` against `matrix`", [&](const Spread& s) { return times(s.over(kOptimal, kMatrix)); });
  add_row("`circle` against `optimal`", [&](const Spread& s) { return times(s.over(kCircle, kOptimal)); });
  add_row("`circle:timed` against `optimal`", [&](const Spread& s) { return times(s.over(kTimed, kOptimal)); });
  add_row("`quadratic` against `optimal`",
          [&](const Spread& s) { return times(s.quadratic / s.constructed[kOptimal]); });
  page.table("worth", header, rows);
  require(spreads[1].over(kOptimal, kMatrix) < 0.65, "optimal is worth it on bend");
  require(spreads[0].quadratic < spreads[0].constructed[kOptimal], "quadratic beats optimal on cloth");
  page.set({{"seeds", grouped(kSeeds)},
            {"frame_pairs", grouped(kPairs)},
            {"frame_samples", grouped(kSamples)},
            {"seeds_spread", percent(widest)},
            {"angle_disagreement", scientific(disagreement)},
            {"circle_excess_cloth", percent(spreads[0].over(kCircle, kOptimal) - 1, 2)},
            {"circle_excess_bend", percent(spreads[1].over(kCircle, kOptimal) - 1, 1)},
            {"circle_excess_twist", percent(spreads[2].over(kCircle, kOptimal) - 1, 1)},
            {"circle_excess_eversion", percent(spreads[3].over(kCircle, kOptimal) - 1)}});
}

}  // namespace chronormal::paper
