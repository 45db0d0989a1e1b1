#include "workflow/report/worst_figures.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"
#include "workflow/json/face_figure_json.h"

namespace chronormal::inline internal {
namespace {

// A face: a range of consecutive triangles in part.triangles. The triangles of a polygon form a fan.
struct ReportFace {
  std::size_t first = 0, end = 0;

  [[nodiscard]] std::vector<std::uint32_t> corners(const ModelPart& part) const {
    std::vector<std::uint32_t> all(part.triangles.begin() + static_cast<std::ptrdiff_t>(3 * first),
                                   part.triangles.begin() + static_cast<std::ptrdiff_t>(3 * first + 3));
    for (std::size_t t = first + 1; t < end; ++t) all.push_back(part.triangles[3 * t + 2]);
    return all;
  }
  [[nodiscard]] std::size_t number(const ModelPart& part) const {
    return part.faces.empty() ? first : part.faces[first];
  }
};

std::vector<ReportFace> faces_around(const ModelPart& part, std::size_t vertex) {
  const std::size_t triangles = part.triangles.size() / 3;
  std::vector<ReportFace> found;
  for (std::size_t t = 0; t < triangles;) {
    ReportFace face{t, t + 1};
    while (!part.faces.empty() && face.end < triangles && part.faces[face.end] == part.faces[t]) ++face.end;
    const auto begin = part.triangles.begin();
    if (std::find(begin + static_cast<std::ptrdiff_t>(3 * t), begin + static_cast<std::ptrdiff_t>(3 * face.end),
                  vertex) != begin + static_cast<std::ptrdiff_t>(3 * face.end))
      found.push_back(face);
    t = face.end;
  }
  return found;
}

Vec3d value_at(const std::vector<float>& values, std::size_t i) {
  return {static_cast<double>(values[3 * i]), static_cast<double>(values[3 * i + 1]),
          static_cast<double>(values[3 * i + 2])};
}

// Returns the vector of a vertex in a list, or nothing if the list has no vector for the vertex.
std::optional<Vec3d> vector_of(const ModelVectors& vectors, std::uint32_t vertex) {
  if (vectors.is_dense) return value_at(vectors.values, vertex);
  const auto found = std::lower_bound(vectors.vertices.begin(), vectors.vertices.end(), vertex);
  if (found == vectors.vertices.end() || *found != vertex) return std::nullopt;
  return value_at(vectors.values, static_cast<std::size_t>(found - vectors.vertices.begin()));
}

// Returns the positions of a vertex at both ends of its straight path, for the moment of a worst place.
std::array<Vec3d, 2> ends_of(const ModelPart& part, const ModelMotion& motion, std::size_t sample,
                             std::uint32_t vertex) {
  if (motion.weights.empty()) {
    const std::size_t segment = motion.segments[sample];
    const Vec3d first = value_at(part.positions, vertex);
    const auto position = [&](std::uint32_t keyframe) {
      return vector_of(part.keyframe_positions[keyframe], vertex).value_or(first);
    };
    return {position(part.segments[2 * segment]), position(part.segments[2 * segment + 1])};
  }
  const ModelWeights& weights = motion.weights.front();
  const std::size_t count = weights.targets.size();
  const std::size_t row = motion.subject.is_weighed() ? motion.at.size() - 1 : sample;
  const Vec3d from = value_at(part.positions, vertex);
  Vec3d to = from;
  for (std::size_t k = 0; k < count; ++k) {
    const auto delta = vector_of(part.targets[weights.targets[k]], vertex);
    if (delta) to = to + static_cast<double>(weights.values[row * count + k]) * *delta;
  }
  return {from, to};
}

// Returns a motion of one segment that consists only of this face.
Motion motion_of(const ModelPart& part, const ModelMotion& motion, std::size_t sample, const ReportFace& face) {
  const std::vector<std::uint32_t> corners = face.corners(part);
  const auto count = static_cast<std::uint32_t>(corners.size());
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  Motion alone;
  alone.topology = Topology::polygons(count, {0, count}, std::move(order)).value();
  alone.keyframes.resize(2);
  alone.keyframes[1].time = 1;
  for (const std::uint32_t corner : corners) {
    const auto ends = ends_of(part, motion, sample, corner);
    for (std::size_t end = 0; end < 2; ++end) {
      for (const double x : {ends[end].x, ends[end].y, ends[end].z})
        alone.keyframes[end].positions.push_back(static_cast<float>(x));
    }
  }
  alone.connect_as_sequence();
  return alone;
}

}  // namespace

Json worst_figures(const ReportModel& model) {
  Json figures = Json::array();
  std::vector<std::pair<std::size_t, std::size_t>> taken;  // part and first triangle of each face that has a figure
  for (std::size_t i = 0; i < model.worst.size() && figures.size() < kMostFigures; ++i) {
    const ReportPlace& place = model.worst[i];
    const ModelPart& part = model.parts[place.part];
    const ModelMotion& motion = part.motions[place.motion];
    std::optional<ReportFace> worst;
    double most = 0;
    for (const ReportFace& face : faces_around(part, place.vertex)) {
      const Result<FaceFigure> linear =
          face_figure(motion_of(part, motion, place.sample, face), {0, 0, {"linear"}, kFigureSamples});
      if (!linear || !(linear.value().schemes[0].sum > most)) continue;
      most = linear.value().schemes[0].sum;
      worst = face;
    }
    if (!worst || std::find(taken.begin(), taken.end(), std::pair{place.part, worst->first}) != taken.end()) continue;
    taken.emplace_back(place.part, worst->first);
    Result<FaceFigure> figure = face_figure(motion_of(part, motion, place.sample, *worst),
                                            {0, 0, {kFigureSchemes.begin(), kFigureSchemes.end()}, kFigureSamples});
    figure.value().face = worst->number(part);
    if (motion.weights.empty()) figure.value().segment = motion.segments[place.sample];
    Json json = {{"place", i}, {"triangle", worst->first}};
    json.update(face_figure_object(figure.value()));
    figures.push_back(std::move(json));
  }
  return figures;
}

}  // namespace chronormal::inline internal
