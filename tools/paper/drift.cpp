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

void write_drift(Page& page) {
  std::vector<MorphDrift> drifts;
  for (const Morph& m : morphs()) drifts.push_back(measure(m.motion));
  const MorphDrift &twist = drifts[2], &eversion = drifts[3];
  const auto at = [](std::size_t steps) {
    return static_cast<std::size_t>(std::find(kSteps.begin(), kSteps.end(), steps) - kSteps.begin());
  };
  const std::size_t last = at(10000);

  page.heading("3 Sequential access");
  page.text(
      "The paper: polynomials and slerp can be played step by step, each normal from the one before, a degree two "
      "polynomial by \"only two additions\". That is so: two per component, and three for a cubic. Arcs take one "
      "rotation of (cos, sin) in the plane per step, and no trigonometry. What the paper does not say is what it "
      "costs in accuracy: every step rounds, and the state never forgets.");
  page.text(fmt::format(
      "Measured on {} faces of twist: a segment is played in so many steps, and held against the same scheme at "
      "random access. The figures are the largest angles over faces and steps, in radians. `Scheme::play` makes "
      "its state anew every {} steps unless told otherwise.",
      kFaces, kDefaultAnchorInterval));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t s = 0; s < kSchemes.size(); ++s) {
    std::vector<std::string> row = {fmt::format("`{}`", kSchemes[s].scheme), kSchemes[s].how};
    for (const Drifts* d : {&twist.free, &twist.anchored}) {
      for (const std::size_t steps : {100u, 1000u, 10000u}) row.push_back(scientific((*d)[s][at(steps)].angle, 1));
    }
    rows.push_back(std::move(row));
  }
  page.table({"drift, radians", "by", "100 steps", "1,000", "10,000", "anew, 100", "anew, 1,000", "anew, 10,000"},
             rows);

  Figure figure{"drift", 900, 400, 2, {}};
  figure.panels.push_back(drift_panel("never made anew", twist.free, ""));
  figure.panels.push_back(drift_panel(fmt::format("made anew every {} steps", kDefaultAnchorInterval), twist.anchored,
                                      "at graph 0.03,0.99 left top Left reverse"));
  page.picture(figure,
               "Largest drift against the number of steps, on logarithmic axes: without anchors it grows, with "
               "them it stays level");

  double free_worst = 0, free_least = 1, anchored_worst = 0, arc_length = 0, arc_length_anchored = 0;
  for (std::size_t s = 0; s < kSchemes.size(); ++s) {
    free_worst = std::max(free_worst, twist.free[s][last].angle);
    free_least = std::min(free_least, twist.free[s][last].angle);
    for (const MorphDrift& d : drifts) anchored_worst = std::max(anchored_worst, worst_angle(d.anchored[s]));
    if (std::string_view(kSchemes[s].how) != "rotation") continue;
    arc_length = std::max(arc_length, twist.free[s][last].length);
    arc_length_anchored = std::max(arc_length_anchored, twist.anchored[s][last].length);
  }
  page.bullet(fmt::format(
      "Left alone, the drift grows about as the number of steps, since a difference that is added again and again "
      "is rounded the same way each time. After 10,000 steps it is {} to {} rad; the latter is {} degrees.",
      scientific(free_least), scientific(free_worst), ratio(kDegreesPerRadian * free_worst)));
  require(anchored_worst < 5e-6, "anchored drift stays below 5e-6 rad, as normals/playback.h says");
  std::vector<std::string> everywhere;
  for (std::size_t m = 0; m < morphs().size(); ++m) {
    double worst = 0;
    for (const auto& of_scheme : drifts[m].anchored) worst = std::max(worst, worst_angle(of_scheme));
    everywhere.push_back(fmt::format("{} on {}", scientific(worst, 1), morphs()[m].name));
  }
  page.bullet(fmt::format(
      "Made anew every {} steps, no scheme of the table drifts by more than {} (rad, over all numbers of steps "
      "from 100 to 10,000). That is below 5e-6, and little beside the error of everything that interpolates. For "
      "`polynomial` it is {} times its error at random access: who needs all digits, should not play.",
      kDefaultAnchorInterval, listed(everywhere), grouped(worst_angle(twist.anchored[0]) / polynomial_error())));
  const Drift &slerp_last = twist.free[4][last], &slerp_before = twist.free[4][at(5000)];
  require(slerp_last.length > slerp_before.length && slerp_last.angle < slerp_before.angle,
          "slerp trades angle for length");
  page.bullet(
      fmt::format("Arcs are not normalised, so their length drifts too: by up to {} after 10,000 steps, and by {} "
                  "made anew. `slerp` drifts less in angle than the others because a wrong radius does not turn a "
                  "great circle. (Its last point in the picture is no slip: at 10,000 steps the cosine of a step "
                  "rounds to 1, so the angle hardly drifts, {}, and the length does, {}.)",
                  scientific(arc_length), scientific(arc_length_anchored), scientific(slerp_last.angle),
                  scientific(slerp_last.length)));
  require(eversion.free[3][last].angle > 2 * twist.free[3][last].angle,
          "close to zero, drift of a polynomial counts more");
  require(eversion.free[5][last].angle < twist.free[5][last].angle, "arcs never come close to zero");
  page.bullet(fmt::format(
      "On eversion, left alone, `cubic` drifts by {} against {} on twist: a polynomial that comes close to zero "
      "turns a small error of its value into a large one of its direction. Arcs never come close to zero: {} "
      "against {} for `quaternion:optimal`.",
      scientific(eversion.free[3][last].angle), scientific(twist.free[3][last].angle),
      scientific(eversion.free[5][last].angle), scientific(twist.free[5][last].angle)));
  const Recurrences few = recurrences(100), some = recurrences(1000), many = recurrences(10000);
  require(many.chebyshev > 10 * many.rotation, "Chebyshev loses more than the rotation");
  page.bullet(
      fmt::format("Incremental slerp is often written as the recurrence x'' = 2 cos(step) x' - x, which needs no "
                  "sine. In float32 over 1.5 rad it is off by {}, {} and {} after 100, 1,000 and 10,000 steps; the "
                  "rotation that we use, by {}, {} and {}. The cosine of a small step is so close to 1 that "
                  "float32 has few digits left for the difference.",
                  scientific(few.chebyshev), scientific(some.chebyshev), scientific(many.chebyshev),
                  scientific(few.rotation), scientific(some.rotation), scientific(many.rotation)));
  page.bullet(
      "Not everything can be played: `decasteljau:4` is no arc, and `circle:timed` does not run at constant speed.");
  page.line("");
  page.statement(
      "Polynomials and slerp can be evaluated incrementally, a quadratic by \"only two additions\"",
      fmt::format("yes, per component; left alone they drift by up to {} rad in 10,000 steps, made anew every {} by {}",
                  scientific(free_worst), kDefaultAnchorInterval, scientific(anchored_worst)),
      "3");
}

}  // namespace chronormal::paper
