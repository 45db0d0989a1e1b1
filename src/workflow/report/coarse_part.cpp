#include "workflow/report/coarse_part.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "workflow/report/keep_only.h"

namespace chronormal::inline internal {
namespace {

constexpr std::uint32_t kNone = kNoReportElement;

// The faces of a part. Each face is a range of consecutive triangles of the part.
struct Faces {
  explicit Faces(const ModelPart& part) {
    const std::size_t triangles = part.triangles.size() / 3;
    for (std::size_t t = 0; t < triangles; ++t)
      if (t == 0 || part.faces.empty() || part.faces[t] != part.faces[t - 1]) first.push_back(t);
    first.push_back(triangles);
  }
  [[nodiscard]] std::size_t count() const noexcept { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> corners(const ModelPart& part, std::size_t face) const {
    return std::span(part.triangles).subspan(3 * first[face], 3 * (first[face + 1] - first[face]));
  }

  std::vector<std::size_t> first;  // the first triangle of each face, then the number of triangles
};

// A list of numbers for each element. All lists are stored one after the other in one array.
struct ListsOfElements {
  // Collects the lists. each(use) must call use(element, number) for all entries, in order. Entries whose element is
  // kNone are ignored.
  template <class Each>
  ListsOfElements(const ModelPart& part, const Each& each) : offsets(part.elements + 1) {
    each([&](std::uint32_t e, std::size_t) {
      if (e != kNone) ++offsets[e + 1];
    });
    for (std::size_t e = 0; e < part.elements; ++e) offsets[e + 1] += offsets[e];
    list.resize(offsets.back());
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    each([&](std::uint32_t e, std::size_t n) {
      if (e != kNone) list[next[e]++] = n;
    });
  }
  [[nodiscard]] std::span<const std::size_t> of(std::size_t e) const {
    return std::span(list).subspan(offsets[e], offsets[e + 1] - offsets[e]);
  }

  std::vector<std::size_t> offsets, list;
};

ListsOfElements faces_of_elements(const ModelPart& part, const Faces& faces) {
  return {part, [&](const auto& use) {
            for (std::size_t f = 0; f < faces.count(); ++f)
              for (const std::uint32_t v : faces.corners(part, f)) use(part.element[v], f);
          }};
}

// Calls use(corner, element) for each corner whose polygon an element adds to its normal.
template <class Use>
void for_terms(const ModelPart& part, const Use& use) {
  const ModelTruth& truth = part.truth;
  for (std::size_t i = 0; i < truth.terms.size(); i += 2) use(truth.terms[i], truth.terms[i + 1]);
  if (!truth.terms.empty()) return;
  for (std::uint32_t c = 0; c < truth.corners.size(); ++c) use(c, part.element[truth.corners[c]]);
}

std::vector<std::uint32_t> polygons_of_corners(const ModelTruth& truth) {
  std::vector<std::uint32_t> result;
  result.reserve(truth.corners.size());
  for (std::uint32_t p = 0; p + 1 < truth.first.size(); ++p) result.resize(truth.first[p + 1], p);
  return result;
}

// For each element, lists the vertices that its true normal needs in addition to the vertices of its triangles.
ListsOfElements vertices_of_truths(const ModelPart& part) {
  const ModelTruth& truth = part.truth;
  const std::vector<std::uint32_t> polygon_of = polygons_of_corners(truth);
  return {part, [&](const auto& use) {
            for_terms(part, [&](std::uint32_t corner, std::uint32_t element) {
              const std::uint32_t p = polygon_of[corner];
              for (std::uint32_t c = truth.first[p]; c < truth.first[p + 1]; ++c) use(element, truth.corners[c]);
            });
            for (const ModelOffset& offset : truth.offsets)
              for (const std::uint32_t v : offset.edges) use(offset.element, v);
          }};
}

struct Kept {
  std::vector<bool> faces, vertices, elements;
};

// Keeps the elements around the worst places, one ring of neighbours after the other, until the faces of the kept
// elements have most_vertices vertices. The elements of the worst places themselves are always kept.
Kept keep_neighbourhoods(const ReportModel& model, std::size_t number, std::size_t most_vertices) {
  const ModelPart& part = model.parts[number];
  const Faces faces(part);
  const ListsOfElements faces_of = faces_of_elements(part, faces), seen_by = vertices_of_truths(part);
  Kept kept{std::vector<bool>(faces.count()), std::vector<bool>(part.vertex_count()), std::vector<bool>(part.elements)};
  std::vector<std::uint32_t> ring;
  std::vector<bool> is_seen(part.elements);
  const auto see = [&](std::uint32_t vertex) {
    const std::uint32_t e = part.element[vertex];
    if (e == kNone || is_seen[e]) return;
    is_seen[e] = true;
    ring.push_back(e);
  };
  for (const ReportPlace& place : model.worst)
    if (place.part == number) see(static_cast<std::uint32_t>(place.vertex));
  const std::size_t places = ring.size();
  std::size_t count = 0;
  const auto keep = [&](std::uint32_t vertex) {
    if (!kept.vertices[vertex]) ++count;
    kept.vertices[vertex] = true;
    see(vertex);
  };
  for (std::size_t i = 0; i < ring.size() && (i < places || count < most_vertices); ++i) {
    kept.elements[ring[i]] = true;
    for (const std::size_t f : faces_of.of(ring[i])) {
      if (kept.faces[f]) continue;
      kept.faces[f] = true;
      for (const std::uint32_t v : faces.corners(part, f)) keep(v);
    }
    for (const std::size_t v : seen_by.of(ring[i])) keep(static_cast<std::uint32_t>(v));
  }
  return kept;
}

// Returns about most_triangles larger triangles, which replace the given triangles and use the same vertices. Keeps the
// border of the triangles if possible.
std::vector<std::uint32_t> simplified(const std::vector<std::uint32_t>& triangles, const std::vector<float>& positions,
                                      std::size_t most_triangles) {
  if (triangles.empty() || most_triangles == 0) return {};
  constexpr float kAnyError = 1e9F;
  constexpr std::size_t kStride = 3 * sizeof(float);
  const std::size_t vertices = positions.size() / 3, most = 3 * most_triangles;
  std::vector<std::uint32_t> result(triangles.size());
  std::size_t count = meshopt_simplify(result.data(), triangles.data(), triangles.size(), positions.data(), vertices,
                                       kStride, most, kAnyError, meshopt_SimplifyLockBorder);
  // Uses another method, which keeps only the rough shape, if the topology or the borders of the mesh prevent
  // simplification.
  if (count > most + most / 2)
    count = meshopt_simplifySloppy(result.data(), triangles.data(), triangles.size(), positions.data(), vertices,
                                   kStride, most, kAnyError);
  result.resize(count);
  return result;
}

// Returns new indices for the kept items, in their order, and kNone for all other items.
std::vector<std::uint32_t> numbers(const std::vector<bool>& kept) {
  std::vector<std::uint32_t> result(kept.size(), kNone);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) result[i] = count++;
  return result;
}

void keep_vectors(const std::vector<bool>& kept, const std::vector<std::uint32_t>& number, ModelVectors& vectors) {
  if (vectors.is_dense) {
    keep_only(kept, 3, vectors.values);
    return;
  }
  std::vector<bool> is_kept(vectors.vertices.size());
  for (std::size_t i = 0; i < is_kept.size(); ++i) is_kept[i] = kept[vectors.vertices[i]];
  keep_only(is_kept, 3, vectors.values);
  keep_only(is_kept, 1, vectors.vertices);
  for (std::uint32_t& v : vectors.vertices) v = number[v];
}

// Keeps the true normals of kept elements, and renumbers their vertices and elements. The other members of the part
// must still have the old numbers.
void keep_truth(const Kept& kept, const std::vector<std::uint32_t>& vertex, const std::vector<std::uint32_t>& element,
                ModelPart& part) {
  ModelTruth& truth = part.truth;
  std::vector<bool> is_polygon_kept(truth.first.empty() ? 0 : truth.first.size() - 1);
  const std::vector<std::uint32_t> polygon_of = polygons_of_corners(truth);
  for_terms(part, [&](std::uint32_t corner, std::uint32_t e) {
    if (e != kNone && kept.elements[e]) is_polygon_kept[polygon_of[corner]] = true;
  });
  std::vector<bool> is_corner_kept;
  for (const std::uint32_t p : polygon_of) is_corner_kept.push_back(is_polygon_kept[p]);
  const std::vector<std::uint32_t> corner = numbers(is_corner_kept);
  std::vector<std::uint32_t> terms;
  for (std::size_t i = 0; i < truth.terms.size(); i += 2)
    if (kept.elements[truth.terms[i + 1]])
      terms.insert(terms.end(), {corner[truth.terms[i]], element[truth.terms[i + 1]]});
  truth.terms = std::move(terms);
  std::vector<std::uint32_t> first, corners;
  if (!truth.first.empty()) first.push_back(0);
  for (std::size_t p = 0; p < is_polygon_kept.size(); ++p) {
    if (!is_polygon_kept[p]) continue;
    for (std::uint32_t c = truth.first[p]; c < truth.first[p + 1]; ++c) corners.push_back(vertex[truth.corners[c]]);
    first.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  truth.first = std::move(first);
  truth.corners = std::move(corners);

  std::vector<bool> is_kept;
  for (const ModelOffset& offset : truth.offsets) is_kept.push_back(kept.elements[offset.element]);
  const std::vector<std::uint32_t> number = numbers(is_kept);
  keep_only(is_kept, 1, truth.offsets);
  for (ModelOffset& offset : truth.offsets) {
    offset.element = element[offset.element];
    for (std::uint32_t& v : offset.edges) v = vertex[v];
  }
  for (ModelTruth::Changes& changes : truth.changes) {
    std::vector<bool> is_change_kept;
    for (const std::uint32_t n : changes.offsets) is_change_kept.push_back(is_kept[n]);
    keep_only(is_change_kept, 2, changes.values);
    keep_only(is_change_kept, 1, changes.offsets);
    for (std::uint32_t& n : changes.offsets) n = number[n];
  }
}

// Stores for each vertex the number by which the report names it: its number in the file, or in its primitive if there
// are several primitives.
void label(ModelPart& part) {
  if (!part.labels.empty()) return;
  for (const ModelPrimitive& primitive : part.primitives)
    for (std::uint32_t v = 0; v < primitive.count; ++v) part.labels.push_back(v);
}

}  // namespace

void make_coarse(ReportModel& model, std::size_t number, std::size_t most_vertices) {
  ModelPart& part = model.parts[number];
  Kept kept = keep_neighbourhoods(model, number, most_vertices / 2);
  const Faces faces(part);
  std::vector<std::uint32_t> fine, rest, face_of_fine, backs;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const auto corners = faces.corners(part, f);
    const std::size_t begin = 3 * faces.first[f];
    for (std::size_t i = 0; kept.faces[f] && !part.backs.empty() && i < corners.size(); ++i)
      if (std::binary_search(part.backs.begin(), part.backs.end(), begin + i))
        backs.push_back(static_cast<std::uint32_t>(fine.size() + i));
    std::vector<std::uint32_t>& to = kept.faces[f] ? fine : rest;
    to.insert(to.end(), corners.begin(), corners.end());
    if (kept.faces[f] && !part.faces.empty())
      face_of_fine.insert(face_of_fine.end(), corners.size() / 3, part.faces[faces.first[f]]);
  }
  // Passes the limit of vertices as a limit of triangles. The triangles need about half as many vertices, because a
  // closed mesh has twice as many triangles as vertices.
  part.coarse = simplified(rest, part.positions, most_vertices);
  part.triangles = std::move(fine);
  part.faces = std::move(face_of_fine);
  part.backs = std::move(backs);
  for (const std::uint32_t v : part.coarse) kept.vertices[v] = true;

  label(part);
  const std::vector<std::uint32_t> vertex = numbers(kept.vertices), element = numbers(kept.elements);
  for (std::vector<std::uint32_t>* corners : {&part.triangles, &part.coarse})
    for (std::uint32_t& v : *corners) v = vertex[v];
  keep_truth(kept, vertex, element, part);
  for (std::uint32_t& e : part.element) e = e == kNone ? kNone : element[e];
  std::size_t first = 0;
  for (ModelPrimitive& primitive : part.primitives) {
    const auto begin = kept.vertices.begin() + static_cast<std::ptrdiff_t>(primitive.first);
    primitive.count =
        static_cast<std::size_t>(std::count(begin, begin + static_cast<std::ptrdiff_t>(primitive.count), true));
    primitive.first = std::exchange(first, first + primitive.count);
  }
  keep_only(kept.vertices, 1, part.labels);
  keep_only(kept.vertices, 1, part.element);
  keep_only(kept.vertices, 3, part.positions);
  keep_only(kept.vertices, 3, part.normals);
  for (ModelVectors& target : part.targets) keep_vectors(kept.vertices, vertex, target);
  for (ModelShown& shown : part.shown) {
    keep_only(kept.vertices, 3, shown.normals);
    for (ModelVectors& target : shown.targets) keep_vectors(kept.vertices, vertex, target);
  }
  for (ModelVectors& keyframe : part.keyframe_positions) keep_vectors(kept.vertices, vertex, keyframe);
  for (ModelVectors& keyframe : part.keyframe_normals) keep_vectors(kept.vertices, vertex, keyframe);
  for (ModelMotion& motion : part.motions) keep_only(kept.elements, 1, motion.least);
  part.elements = static_cast<std::size_t>(std::count(kept.elements.begin(), kept.elements.end(), true));
  part.peaks.clear();
  for (ReportPlace& place : model.worst)
    if (place.part == number) place.vertex = vertex[place.vertex];
}

}  // namespace chronormal::inline internal
