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

// The median, 99 % and the largest.
void add_spread(Cells& row, const std::vector<double>& values) {
  if (values.empty())
    row.insert(row.end(), 3, "none");
  else
    row.insert(row.end(), {degrees(quantile(values, 0.5)), degrees(quantile(values, 0.99)), degrees(largest(values))});
}

}  // namespace

void measure_fits(Page& page) {
  Cells header = {"microseconds per vertex"};
  for (const WeightingInfo& info : kWeightings) {
    if (info.weighting != Weighting::kArea) header.push_back(fmt::format("`{}`", info.name));
  }
  std::vector<Cells> rows, times;
  std::vector<double> ratios;
  std::map<std::string, double> largest_of;  // by "morph weighting"
  std::size_t unbounded = 0;
  for (const Part& part : kParts) {
    const std::string morph = part.morph;
    const Patches patches = patches_of(make_builtin_morph(morph).value(), part.bands, part.faces_in_band);
    Cells time_row = {morph};
    for (const WeightingInfo& info : kWeightings) {
      if (info.weighting == Weighting::kArea) continue;
      const Errors errors = measure(patches, info.weighting);
      Cells row = {fmt::format("{}, `{}`", morph, info.name), grouped(static_cast<double>(errors.elements))};
      add_spread(row, errors.bounds);
      add_spread(row, errors.sampled);
      row.push_back(percent(static_cast<double>(errors.unbounded) / static_cast<double>(errors.elements), 1));
      rows.push_back(row);
      time_row.push_back(fmt::format("{:.0f}", errors.microseconds));
      unbounded += errors.unbounded;
      if (!errors.sampled.empty()) largest_of[fmt::format("{} {}", morph, info.name)] = largest(errors.sampled);
      if (morph == "soup") {
        require(!errors.sampled.empty(), "soup has bounds");
        require(largest(errors.sampled) < 1e-6, "a single face is fitted exactly");
        require(largest(errors.bounds) == 0, "the bound of a single face is 0");
      } else {
        ratios.insert(ratios.end(), errors.ratios.begin(), errors.ratios.end());
      }
    }
    times.push_back(time_row);
  }
  for (const std::string morph : {"cloth", "bend", "twist"}) {
    for (const char* const other : {" angle", " uniform", " max"})
      require(largest_of.at(morph + " area-angle") < largest_of.at(morph + other), "area-angle fits best");
  }
  require(unbounded > 0, "some vertices have no bound");
  page.table("fits", {"morph", "vertices", "bound, median", "99 %", "max", "error, median", "99 %", "max", "no bound"},
             rows);
  page.table("fit_times", header, times);
  page.set({{"fit_samples", grouped(kSamples + 1)},
            {"bound_median", fmt::format("{:.1f}", quantile(ratios, 0.5))},
            {"bound_99", fmt::format("{:.1f}", quantile(ratios, 0.99))}});
}

}  // namespace chronormal::weightings
