// Section 3: sequential access, and how it drifts.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

struct Incremental {
  const char* scheme;
  const char* how;
  Colour colour;
  Mark mark;
  bool dashed;
};
constexpr std::array kSchemes = {
    Incremental{"polynomial", "2 differences", Colour::kBlack, Mark::kDisc, false},
    Incremental{"linear", "1 difference", Colour::kSky, Mark::kSquare, false},
    Incremental{"quadratic", "2 differences", Colour::kBlue, Mark::kTriangle, false},
    Incremental{"cubic", "3 differences", Colour::kPurple, Mark::kDiamond, false},
    Incremental{"slerp", "rotation", Colour::kOrange, Mark::kOpenSquare, true},
    Incremental{"quaternion:optimal", "rotation", Colour::kRed, Mark::kOpenTriangle, true},
    Incremental{"circle", "rotation", Colour::kGreen, Mark::kCircle, true},
};
constexpr std::size_t kFaces = 400;
constexpr std::array<std::size_t, 7> kSteps = {100, 200, 500, 1000, 2000, 5000, 10000};

// The largest angle, in radians, and the largest difference of a length from 1.
struct Drift {
  double angle = 0, length = 0;
};

// What there is between a scheme that is played over a whole segment and itself at random access, over
// faces and 40 places: just before the state is made anew where it is.
Drift drift(const PreparedScheme& scheme, std::size_t faces, std::size_t steps, std::size_t anchor_interval) {
  const auto playback = scheme->play(0, 1.0 / static_cast<double>(steps), anchor_interval);
  std::vector<float> played(3 * faces);
  const auto view = VectorView<float>::packed(played.data(), faces);
  constexpr std::size_t kPlaces = 40;
  Drift worst;
  std::size_t place = 1;
  for (std::size_t k = 0; k <= steps; ++k) {
    playback->next(view);
    std::size_t check = place * steps / kPlaces;
    if (anchor_interval != 0) check = std::min(check - check % anchor_interval + anchor_interval - 1, steps);
    if (k != check) continue;
    const std::vector<Vec3d> random = scheme.at(static_cast<double>(k) / static_cast<double>(steps));
    for (std::size_t f = 0; f < faces; ++f) {
      const Vec3d u = to_double(view[f]);
      worst.angle = std::max(worst.angle, degrees_between(random[f], u) / kDegreesPerRadian);
      worst.length = std::max(worst.length, std::fabs(length(u) - 1));
    }
    while (place * steps / kPlaces <= k) ++place;
  }
  return worst;
}

// Drifts of every scheme for every number of steps.
using Drifts = std::array<std::array<Drift, kSteps.size()>, kSchemes.size()>;

struct MorphDrift {
  Drifts free{}, anchored{};
};

MorphDrift measure(const Motion& motion) {
  MorphDrift result;
  const Motion part = some_faces(motion, kFaces);
  const Segment segment = part.segment(0);
  const IndexRange faces{0, part.topology.face_count()};
  parallel_for(kSchemes.size(), [&](std::size_t s) {
    const PreparedScheme scheme(kSchemes[s].scheme, segment, faces);
    for (std::size_t n = 0; n < kSteps.size(); ++n) {
      result.free[s][n] = drift(scheme, faces.count, kSteps[n], 0);
      result.anchored[s][n] = drift(scheme, faces.count, kSteps[n], kDefaultAnchorInterval);
    }
  });
  return result;
}

// Cosine and sine over 1.5 rad in float32, by a rotation per step and by x'' = 2 cos(step) x' - x: the largest errors.
struct Recurrences {
  double rotation = 0, chebyshev = 0;
};

Recurrences recurrences(std::size_t steps) {
  const double step = 1.5 / static_cast<double>(steps);
  const float step_cosine = static_cast<float>(std::cos(step)), step_sine = static_cast<float>(std::sin(step));
  float rotated_cosine = 1, rotated_sine = 0;
  float cosine = step_cosine, sine = step_sine, cosine_before = 1, sine_before = 0;
  Recurrences worst;
  for (std::size_t k = 1; k <= steps; ++k) {
    const float next = rotated_cosine * step_cosine - rotated_sine * step_sine;
    rotated_sine = rotated_sine * step_cosine + rotated_cosine * step_sine;
    rotated_cosine = next;
    const double angle = step * static_cast<double>(k), c = std::cos(angle), s = std::sin(angle);
    worst.rotation = std::max(
        worst.rotation, std::hypot(static_cast<double>(rotated_cosine) - c, static_cast<double>(rotated_sine) - s));
    worst.chebyshev =
        std::max(worst.chebyshev, std::hypot(static_cast<double>(cosine) - c, static_cast<double>(sine) - s));
    const float next_cosine = 2 * step_cosine * cosine - cosine_before,
                next_sine = 2 * step_cosine * sine - sine_before;
    cosine_before = cosine, sine_before = sine;
    cosine = next_cosine, sine = next_sine;
  }
  return worst;
}

Panel drift_panel(const std::string& title, const Drifts& drifts, const std::string& legend) {
  Panel panel;
  panel.title = title;
  panel.x = {"steps over the segment", 80, 12500, true, {{100, "100"}, {1000, "1,000"}, {10000, "10,000"}}};
  panel.y = {"largest drift, radians", 1e-7, 2e-3, true, {}};
  panel.legend = legend;
  for (std::size_t s = 0; s < kSchemes.size(); ++s) {
    Series series{legend.empty() ? "" : kSchemes[s].scheme,
                  {},
                  kSchemes[s].colour,
                  1.8,
                  kSchemes[s].dashed,
                  kSchemes[s].mark,
                  0.7};
    for (std::size_t n = 0; n < kSteps.size(); ++n)
      series.points.emplace_back(static_cast<double>(kSteps[n]), std::max(drifts[s][n].angle, 6e-8));
    panel.series.push_back(series);
  }
  return panel;
}

// The largest error of `polynomial` at random access on twist, in radians.
double polynomial_error() {
  return compare(morph("twist"), {{"polynomial"}, 21, Access::kRandom, {}}).value().schemes[0].quality.max;
}

// The largest over all numbers of steps.
double worst_angle(const std::array<Drift, kSteps.size()>& drifts) {
  double worst = 0;
  for (const Drift& d : drifts) worst = std::max(worst, d.angle);
  return worst;
}

}  // namespace

void measure_drift(Page& page) {
  std::vector<MorphDrift> drifts;
  for (const Morph& m : morphs()) drifts.push_back(measure(m.motion));
  const MorphDrift &twist = drifts[2], &eversion = drifts[3];
  const auto at = [](std::size_t steps) {
    return static_cast<std::size_t>(std::find(kSteps.begin(), kSteps.end(), steps) - kSteps.begin());
  };
  const std::size_t last = at(10000);

  std::vector<Cells> rows;
  for (std::size_t s = 0; s < kSchemes.size(); ++s) {
    Cells row = {fmt::format("`{}`", kSchemes[s].scheme), kSchemes[s].how};
    for (const Drifts* d : {&twist.free, &twist.anchored}) {
      for (const std::size_t steps : {100u, 1000u, 10000u}) row.push_back(scientific((*d)[s][at(steps)].angle, 1));
    }
    rows.push_back(std::move(row));
  }
  page.table("drifts",
             {"drift, radians", "by", "100 steps", "1,000", "10,000", "anew, 100", "anew, 1,000", "anew, 10,000"},
             rows);
  Figure figure{"drift", 900, 400, 2, {}};
  figure.panels.push_back(drift_panel("never made anew", twist.free, ""));
  figure.panels.push_back(drift_panel(fmt::format("made anew every {} steps", kDefaultAnchorInterval), twist.anchored,
                                      "at graph 0.03,0.99 left top Left reverse"));
  page.picture("drift", figure);

  double free_worst = 0, free_least = 1, arc_length = 0, arc_length_anchored = 0;
  for (std::size_t s = 0; s < kSchemes.size(); ++s) {
    free_worst = std::max(free_worst, twist.free[s][last].angle);
    free_least = std::min(free_least, twist.free[s][last].angle);
    if (std::string_view(kSchemes[s].how) != "rotation") continue;
    arc_length = std::max(arc_length, twist.free[s][last].length);
    arc_length_anchored = std::max(arc_length_anchored, twist.anchored[s][last].length);
  }
  std::vector<double> anchored;  // a morph each
  std::vector<std::string> everywhere;
  for (std::size_t m = 0; m < morphs().size(); ++m) {
    anchored.push_back(0);
    for (const auto& of_scheme : drifts[m].anchored) anchored[m] = std::max(anchored[m], worst_angle(of_scheme));
    everywhere.push_back(fmt::format("{} on {}", scientific(anchored[m], 1), morphs()[m].name));
  }
  require(largest(anchored) < 5e-6, "anchored drift stays below 5e-6 rad, as schemes/scheme.h says");
  const Drift &slerp_last = twist.free[4][last], &slerp_before = twist.free[4][at(5000)];
  require(slerp_last.length > slerp_before.length && slerp_last.angle < slerp_before.angle,
          "slerp trades angle for length");
  require(eversion.free[3][last].angle > 2 * twist.free[3][last].angle,
          "close to zero, drift of a polynomial counts more");
  require(eversion.free[5][last].angle < twist.free[5][last].angle, "arcs never come close to zero");
  page.set({{"drift_faces", grouped(kFaces)},
            {"drift_least", scientific(free_least)},
            {"drift_most", scientific(free_worst)},
            {"drift_most_degrees", ratio(kDegreesPerRadian * free_worst)},
            {"drift_anchored", listed(everywhere)},
            {"drift_anchored_most", scientific(largest(anchored))},
            {"drift_over_error", grouped(worst_angle(twist.anchored[0]) / polynomial_error())},
            {"length_drift", scientific(arc_length)},
            {"length_drift_anchored", scientific(arc_length_anchored)},
            {"slerp_last_angle", scientific(slerp_last.angle)},
            {"slerp_last_length", scientific(slerp_last.length)},
            {"cubic_drift_eversion", scientific(eversion.free[3][last].angle)},
            {"cubic_drift_twist", scientific(twist.free[3][last].angle)},
            {"optimal_drift_eversion", scientific(eversion.free[5][last].angle)},
            {"optimal_drift_twist", scientific(twist.free[5][last].angle)}});
  for (const std::size_t steps : {100u, 1000u, 10000u}) {
    const Recurrences worst = recurrences(steps);
    require(steps < 10000 || worst.chebyshev > 10 * worst.rotation, "Chebyshev loses more than the rotation");
    page.set(fmt::format("chebyshev_{}", steps), scientific(worst.chebyshev));
    page.set(fmt::format("rotation_{}", steps), scientific(worst.rotation));
  }
}

}  // namespace chronormal::paper
