// Section 3: quadratics in place of weighted normals that are none.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <map>
#include <numbers>

#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

constexpr double kRounding = 1e-9;     // radians: of both sides of the comparison, in double
constexpr std::size_t kSamples = 100;  // steps in which the error is sampled

// Some of a motion: bands of neighbouring faces, evenly over mesh and segments, with all vertices in their places.
struct Patches {
  Motion motion;
  std::vector<std::size_t> whole;  // vertices that have all of their faces
};

Patches patches_of(const Motion& from, std::size_t bands, std::size_t faces_in_band) {
  const std::size_t faces = from.topology.face_count();
  std::vector<std::uint32_t> corners;
  for (std::size_t b = 0; b < bands; ++b) {
    const std::size_t first = (2 * b + 1) * faces / (2 * bands) - faces_in_band / 2;
    for (std::size_t f = first; f < first + faces_in_band; ++f)
      corners.insert(corners.end(), from.topology.face(f).begin(), from.topology.face(f).end());
  }
  std::vector<std::size_t> here(from.topology.vertex_count()), all(here.size());
  for (const std::uint32_t v : corners) ++here[v];
  for (const std::uint32_t v : from.topology.corners()) ++all[v];
  Patches patches{{Topology::triangles(here.size(), corners).value(), from.keyframes, from.segments}, {}};
  for (std::size_t v = 0; v < here.size(); ++v) {
    if (here[v] > 0 && here[v] == all[v]) patches.whole.push_back(v);
  }
  return patches;
}

struct Errors {
  std::vector<double> bounds, sampled, ratios;  // degrees, of those elements that have a bound
  std::size_t elements = 0, unbounded = 0;
  double microseconds = 0;  // per element that has faces
};

Errors measure(const Patches& patches, Weighting weighting) {
  Errors errors;
  const Topology& topology = patches.motion.topology;
  const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(topology.vertex_count()));
  for (std::size_t s = 0; s < patches.motion.segments.size(); ++s) {
    const Segment segment = patches.motion.segment(s);
    const auto before = std::chrono::steady_clock::now();
    const WeightingFit fit = fit_weighting(segment, groups, weighting);
    errors.microseconds += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - before).count();

    std::vector<double> worst(groups.size());
    for (std::size_t i = 0; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      const auto truth = all_weighted_normals_at(segment, groups, weighting, t);
      for (const std::size_t v : patches.whole)
        worst[v] = std::max(worst[v], angle_between(normal_at(fit.normals[v], t), truth[v]));
    }
    for (const std::size_t v : patches.whole) {
      require(worst[v] <= fit.bounds[v] + kRounding, "no sampled error is above its bound");
      ++errors.elements;
      if (fit.bounds[v] >= std::numbers::pi) {
        ++errors.unbounded;
        continue;
      }
      errors.bounds.push_back(fit.bounds[v] * kDegreesPerRadian);
      errors.sampled.push_back(worst[v] * kDegreesPerRadian);
      if (worst[v] > 1e-9) errors.ratios.push_back(fit.bounds[v] / worst[v]);
    }
  }
  errors.microseconds /=
      static_cast<double>(patches.motion.segments.size() * (groups.size() - groups.isolated_count()));
  return errors;
}

// What is measured of a morph: bands of three rows of its grid, or of so many of its faces.
struct Part {
  const char* morph;
  std::size_t bands, faces_in_band;
};
constexpr std::array kParts = {Part{"cloth", 1, 3 * 266}, Part{"bend", 2, 3 * 298}, Part{"twist", 2, 3 * 200},
                               Part{"eversion", 2, 330}, Part{"soup", 1, 50}};

std::string degrees(double value) { return value < 1e-9 ? "0" : ratio(value); }

}  // namespace

void write_fits(Page& page) {
  page.heading("3 Fits");
  page.text(
      "Weighted by anything but area, the normal of a vertex is no polynomial in time ([theory, section "
      "10](theory.md#10-fits-and-their-bounds)). `fit_weighting()` takes the quadratic through the weighted normals at "
      "t "
      "= 0, 1/2 and 1, which plays at the cost of the exact one, and proves for each vertex how far it is off at most. "
      "Below, that bound, and the error over 101 samples of t, in degrees: median, 99 % and largest over whole "
      "vertices "
      "of bands of each morph, all segments. Vertices without a bound (it is 180 degrees) are counted, and left out.");

  std::vector<std::vector<std::string>> rows, times;
  std::vector<double> ratios;
  std::map<std::string, double> largest_of;  // by "morph weighting"
  double soup_error = 0, soup_bound = 0;
  std::size_t unbounded = 0;
  for (const Part& part : kParts) {
    const Patches patches = patches_of(make_builtin_morph(part.morph).value(), part.bands, part.faces_in_band);
    std::vector<std::string> time_row = {part.morph};
    for (const WeightingInfo& info : kWeightings) {
      if (info.weighting == Weighting::kArea) continue;
      const Errors errors = measure(patches, info.weighting);
      const auto three = [](const std::vector<double>& v) {
        if (v.empty()) return std::vector<std::string>(3, "none");
        return std::vector{degrees(quantile(v, 0.5)), degrees(quantile(v, 0.99)), degrees(largest(v))};
      };
      std::vector<std::string> row = {fmt::format("{}, `{}`", part.morph, info.name),
                                      grouped(static_cast<double>(errors.elements))};
      for (const auto& cells : {three(errors.bounds), three(errors.sampled)})
        row.insert(row.end(), cells.begin(), cells.end());
      row.push_back(percent(static_cast<double>(errors.unbounded) / static_cast<double>(errors.elements), 1));
      rows.push_back(row);
      time_row.push_back(fmt::format("{:.0f}", errors.microseconds));
      unbounded += errors.unbounded;
      if (std::string_view(part.morph) == "soup") {
        require(!errors.sampled.empty(), "soup has bounds");
        soup_error = std::max(soup_error, largest(errors.sampled));
        soup_bound = std::max(soup_bound, largest(errors.bounds));
      } else {
        ratios.insert(ratios.end(), errors.ratios.begin(), errors.ratios.end());
        if (!errors.sampled.empty()) largest_of[fmt::format("{} {}", part.morph, info.name)] = largest(errors.sampled);
      }
    }
    times.push_back(time_row);
  }
  page.table({"morph", "vertices", "bound, median", "99 %", "max", "error, median", "99 %", "max", "no bound"}, rows);

  page.bullet(fmt::format(
      "No sampled error is above its bound; the page would not be written. The median bound is {:.1f} times the error "
      "(99 %: {:.1f} times), where the error is not mere rounding.",
      quantile(ratios, 0.5), quantile(ratios, 0.99)));
  bool best = true;
  for (const char* const morph : {"cloth", "bend", "twist"}) {
    for (const char* const other : {"angle", "uniform", "max"})
      best = best && largest_of[fmt::format("{} area-angle", morph)] < largest_of[fmt::format("{} {}", morph, other)];
  }
  require(best, "area-angle fits best");
  page.bullet(
      "`area-angle` fits best on cloth, bend and twist: of its two factors one is the exact quadratic, and only the "
      "angle has to be fitted. The weightings without the area have to follow a unit vector, as `quadratic` does in "
      "[the paper, measured again](paper.md).");
  require(soup_error < 1e-6, "a single face is fitted exactly");
  require(unbounded > 0, "some vertices have no bound");
  page.bullet(
      "On eversion triangles pass close to a collapse, or lose their area on the way. There the weighted normal turns "
      "faster than a quadratic can, or jumps. Some vertices get no bound, and those that get one may be far from the "
      "error: intervals are worst where terms vanish.");
  require(soup_bound == 0, "the bound of a single face is 0");
  page.bullet(
      "In soup each vertex has one face, whose direction is the same in all weightings: its exact curve is taken, and "
      "there is nothing to prove.");
  page.line("");

  begin_block(page, "times");
  page.text(
      "Microseconds of one core to fit a vertex and to prove its bound. Nearly all of it is the bound. Of the machine "
      "that made this page, which had other work to do:");
  std::vector<std::string> header = {"microseconds per vertex"};
  for (const WeightingInfo& info : kWeightings) {
    if (info.weighting != Weighting::kArea) header.push_back(fmt::format("`{}`", info.name));
  }
  page.table(header, times);
  end_block(page, "times");
}

}  // namespace chronormal::weightings
