#include "workflow/report/worst_places.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "core/text.h"
#include "workflow/audit/blend_source.h"

namespace chronormal::inline internal {
namespace {

// Returns the length of the diagonal of the box around a mesh.
double diagonal_of(const std::vector<float>& positions) {
  Vec3d low, high;
  for (std::size_t v = 0; 3 * v < positions.size(); ++v) {
    const Vec3d p = to_double(vector_at(positions, v));
    if (v == 0) low = high = p;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(high - low);
}

std::string label_of(const ModelPart& part, std::size_t vertex) {
  const std::size_t number = part.labels.empty() ? vertex : part.labels[vertex];
  if (!part.mesh) return "vertex " + std::to_string(number);
  const auto after = std::upper_bound(part.primitives.begin(), part.primitives.end(), vertex,
                                      [](std::size_t v, const ModelPrimitive& p) { return v < p.first; });
  const ModelPrimitive& primitive = *(after - 1);
  return "mesh " + std::to_string(*part.mesh) + ", primitive " + std::to_string(primitive.primitive) + ", vertex " +
         std::to_string(number - primitive.first);
}

std::string moment_of(const ModelMotion& motion, std::size_t sample) {
  std::string name = motion.subject.name;
  if (name.empty() && motion.subject.target) name = "target " + std::to_string(*motion.subject.target);
  if (name.empty() && motion.subject.animation) name = "animation " + std::to_string(*motion.subject.animation);
  if (name.empty() && motion.subject.expression) name = "expression " + std::to_string(*motion.subject.expression);
  const bool is_weight = motion.subject.is_weighed();
  return (name.empty() ? "" : name + " at ") + with_digits(motion.at[sample], 6) + (is_weight ? "" : " s");
}

}  // namespace

std::vector<ReportPlace> find_worst_places(const std::vector<ModelPart>& parts) {
  struct Candidate {
    float degrees = 0;
    std::uint32_t part = 0, vertex = 0;
  };
  std::vector<Candidate> candidates;
  std::vector<double> diagonals;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    diagonals.push_back(diagonal_of(parts[p].positions));
    for (std::uint32_t v = 0; v < parts[p].peaks.size(); ++v)
      if (parts[p].peaks[v].degrees > kLeastPlace) candidates.push_back({parts[p].peaks[v].degrees, p, v});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.degrees > b.degrees; });
  std::vector<ReportPlace> places;
  const auto position = [&](std::size_t part, std::size_t vertex) {
    return to_double(vector_at(parts[part].positions, vertex));
  };
  for (const Candidate& c : candidates) {
    if (places.size() == kMostWorstPlaces) break;
    const double distance = kPlaceDistance * diagonals[c.part];
    const bool is_known = std::any_of(places.begin(), places.end(), [&](const ReportPlace& place) {
      return place.part == c.part &&
             length(position(c.part, c.vertex) - position(place.part, place.vertex)) <= distance;
    });
    if (is_known) continue;
    const ModelPart& part = parts[c.part];
    const ModelPeak& peak = part.peaks[c.vertex];
    places.push_back({c.part, peak.motion, peak.sample, c.vertex, c.degrees, label_of(part, c.vertex),
                      moment_of(part.motions[peak.motion], peak.sample)});
  }
  return places;
}

}  // namespace chronormal::inline internal
