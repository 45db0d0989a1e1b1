// Measures the shape of a segment, models the costs of both ways, and takes the cheaper one.
#include "chronormal/normals/segment_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "chronormal/normals/control_normals.h"
#include "core/memory.h"
#include "core/portable_math.h"
#include "motion/coherence.h"
#include "motion/segment_end.h"
#include "normals/curves/curve_sources.h"
#include "normals/curves/kernels/pack.h"
#include "normals/curves/part_builder.h"
#include "normals/recompute/kernels/recompute_tiles.h"

namespace chronormal {
namespace {

// Where the data of a pass lie, by their size: in the cache of a core, in the shared one, in memory.
enum Level { kNear, kShared, kMemory };

// Nanoseconds, one for each level: of one core of an Intel Xeon of 2.6 GHz with 2 MiB of its own, on meshes of 15 k,
// 45 k, 1 M and 10 M triangles in grid order and shuffled, on a dance and on a sphere that turns inside out. What is
// added for polygons, and for a cache line that is far away, is the difference between two of them.
struct Row {
  std::array<double, 3> at;
};

// Recompute, faces: a triangle; the triangle of a polygon; a line of positions that was not at hand.
constexpr Row kRecomputeTriangle = {3.4, 3.5, 4}, kRecomputePolygon = {17, 17.5, 18};
constexpr Row kRecomputeMiss = {0.3, 1, 4.2};
// Recompute, groups: a triangle kept for its sum; a term of a sum; a term that was not in a near cache; and what is
// added for a term of a scattered element, and of a doubtful one.
constexpr Row kRecomputeKept = {3.7, 3.8, 4.2}, kRecomputeTerm = {0.75, 0.85, 1.1},
              kRecomputeTermMiss = {0.04, 2.4, 5.2};
constexpr double kRecomputeScattered = 25, kRecomputeDoubtful = 2.2;
// A triangle takes this much more where it is made in double, since it or one of its neighbours is thin.
constexpr double kRecomputeThin = 6.5;
// In float32: a triangle, a term of a sum, and a term that was not in a near cache; a vertex whose position is
// interpolated.
constexpr Row kFloatTriangle = {1.3, 1.5, 2.2}, kFloatTerm = {0.5, 0.6, 0.9}, kFloatMiss = {0.05, 1, 4};
constexpr Row kFloatVertex = {0.25, 0.4, 1.2};

// The same of preparing curves.
constexpr Row kPrepareTriangle = {7.9, 8, 9}, kPreparePolygon = {35, 35, 35}, kPrepareMiss = {1.1, 3, 6};
// Of groups: a triangle of the fan around an element, which is a point of its path, and a point that was not at hand.
// (The ratio of these to what preparing took before is that of a Zen 4 of 3.7 GHz.)
constexpr Row kPreparePoint = {2.75, 2.85, 3.4}, kPreparePointMiss = {0.3, 3, 9};
// The same of both in float32, where the tolerance allows it and sixteen curves side by side bend.
constexpr Row kPrepareFloatTriangle = {5.4, 5.5, 6.2}, kPrepareFloatPoint = {1.7, 1.75, 2};
// An element that is examined on its own, and each of its faces; or one of sixteen, with the bounds that this takes.
// (The ratio of the latter to preparing is that of a Zen 4, too.)
constexpr double kExamined = 100, kExaminedFace = 52, kExaminedOfTile = 16;
// For each byte of curves and scratch: memory that the system gives for the first time has to be cleared.
constexpr double kNewByte = 0.02;

// Evaluating curves: an element, each byte that is read or written, and what an element in double adds.
constexpr Row kEvaluate = {0.43, 0.2, 0}, kEvaluateByte = {0.0006, 0.015, 0.04};
constexpr Row kEvaluateFlagged = {1.1, 1.2, 3.7};

constexpr double kResultBytes = 3 * sizeof(float);
constexpr double kPositionBytes = 6 * sizeof(float);  // of both ends
constexpr double kIndexBytes = sizeof(std::uint32_t);
constexpr double kTermBytes = 4 * sizeof(float);
constexpr double kFullMiss = 3;  // lines of a face of which no corner was at hand

Level level_of(double bytes) {
  if (bytes <= kModelledNearCache) return kNear;
  return bytes <= kModelledSharedCache ? kShared : kMemory;
}

double cost(const Row& row, Level level) { return row.at[level]; }

// Returns the cost of what streams over so many bytes, of which a cache may hold a part. Half way from one level to the
// next on a logarithmic scale, the cost is half way, too.
double streaming_cost(const Row& row, double bytes) {
  constexpr double kNearEnd = kModelledNearCache, kSharedBegin = kModelledSharedCache / 2,
                   kSharedEnd = kModelledSharedCache, kMemoryBegin = 4 * kModelledSharedCache;
  const auto way = [bytes](double begin, double end) {
    return std::clamp(portable::log(bytes / begin) / portable::log(end / begin), 0.0, 1.0);
  };
  if (bytes <= kSharedEnd) return std::lerp(row.at[kNear], row.at[kShared], way(kNearEnd, kSharedBegin));
  return std::lerp(row.at[kShared], row.at[kMemory], way(kSharedEnd, kMemoryBegin));
}

// Mixes the costs of two ways, of which the second does this share of the work.
Row mixed(double share, const Row& first, const Row& second) {
  Row row{};
  for (std::size_t i = 0; i < row.at.size(); ++i) row.at[i] = (1 - share) * first.at[i] + share * second.at[i];
  return row;
}

// Of a curve, between degrees: 16 to 36 where lengths are kept, 12 to 20 where there is tolerance.
double curve_bytes_of_element(double degree, double tolerance) {
  const bool is_exact = tolerance <= kExactTolerance;
  const double of_degree[] = {is_exact ? 16.0 : 12.0, is_exact ? 24.0 : 12.0, is_exact ? 36.0 : 20.0};
  const double low = std::clamp(std::floor(degree), 0.0, 1.0);
  const auto i = static_cast<std::size_t>(low);
  return of_degree[i] + (degree - low) * (of_degree[i + 1] - of_degree[i]);
}

// The share of the elements that are prepared in float32.
double share_in_float(const MeshShape& shape, double tolerance) {
  return PrecisionLimits::for_float_tiles(tolerance) ? shape.in_float32 : 0;
}

// On a sample of faces.
double average_degree(const Segment& segment) {
  constexpr std::size_t kSamples = 64;
  const std::size_t faces = segment.topology->face_count(), samples = std::min(faces, kSamples);
  if (samples == 0) return 0;
  int sum = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    ControlNormals normals;
    face_control_normals(segment, {faces / samples * i, 1}, {&normals, 1});
    sum += degree(normals);
  }
  return sum / static_cast<double>(samples);
}

// Whether a tile that was made in double might as well have been made in float32. What that is off by is estimated from
// the products: half as many as faces, and those of a ring are each about as large as those of two faces.
bool fits_float(ControlTile tile, double products) {
  static const PrecisionLimits limits = *PrecisionLimits::for_float_tiles(kCompactTolerance);
  const auto roundings = static_cast<float>(0x1p-24 * (products + 5));
  for (float& magnitude : tile.magnitude) magnitude *= roundings;
  TileSummary summary;
  summarize_tiles(std::span(&tile, 1), limits, std::span(&summary, 1));
  return summary.uncertain == 0;
}

// Looks at tiles at a fixed stride as the preparation would.
template <class Source>
void find_doubtful(Source& source, std::size_t size, MeshShape& shape) {
  constexpr std::size_t kSamples = 8;
  const PrecisionLimits exact = PrecisionLimits::for_tolerance(kExactTolerance),
                        compact = PrecisionLimits::for_tolerance(kCompactTolerance);
  std::size_t seen = 0, doubtful = 0, flagged = 0, flagged_compact = 0, in_float = 0;
  const std::size_t tiles = (size + kTile - 1) / kTile, samples = std::min(tiles, kSamples);
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t first = tiles * i / samples * kTile;
    const IndexRange elements{first, std::min(kTile, size - first)};
    AlignedArray<ControlTile> tile(1);
    source.write(elements, std::span(tile.data(), 1));
    TileSummary summary;
    summarize_tiles(std::span(tile.data(), 1), exact, std::span(&summary, 1));
    seen += elements.count;
    if (fits_float(tile[0], shape.faces_per_element / 2 + 1)) in_float += elements.count;
    for (std::size_t lane = 0; lane < elements.count; ++lane) {
      if ((summary.uncertain >> lane & 1) == 0) continue;
      ++doubtful;
      if (doubtful % 4 != 1) continue;  // a sample of a quarter of them
      const ControlNormals normals = source.in_double(first + lane).normals;
      flagged += precision_for(normals, exact) ? 0U : 4U;
      flagged_compact += precision_for(normals, compact) ? 0U : 4U;
    }
  }
  if (seen == 0) return;
  const auto share = [seen](std::size_t count) { return static_cast<double>(count) / static_cast<double>(seen); };
  shape.in_float32 = share(in_float);
  shape.doubtful = share(doubtful);
  shape.flagged = std::min(shape.doubtful, share(flagged));
  shape.flagged_compact = std::min(shape.flagged, share(flagged_compact));
}

// The share of the faces that NormalRecompute makes in double since they, or some of sixteen neighbours, are thin: on a
// sample of faces and instants.
double thin_share(const Segment& segment) {
  constexpr std::size_t kSamples = 8;
  constexpr double kInstants[] = {0.125, 0.375, 0.625, 0.875};
  if (!fits_lanes(segment)) return 0;
  const std::size_t tiles = segment.topology->face_count() / kTile, samples = std::min(tiles, kSamples);
  const auto is_thin = [&segment](std::size_t face, double t) {
    const auto corners = segment.topology->face(face);
    const auto edge = [corners](const VectorView<const float>& points, std::size_t k) {
      return to_double(points[corners[k]]) - to_double(points[corners[0]]);
    };
    const Vec3d e0 = edge(segment.from, 1), e1 = edge(segment.to, 1), f0 = edge(segment.from, 2),
                f1 = edge(segment.to, 2);
    const Vec3d n = cross(lerp(e0, e1, t), lerp(f0, f1, t));
    const double a = std::lerp(dot(e0, e0), dot(e1, e1), t), b = std::lerp(dot(f0, f0), dot(f1, f1), t);
    return !(a * b <= kMostProduct * dot(n, n));
  };
  std::size_t thin = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const IndexRange tile{tiles * i / samples * kTile, kTile};
    for (const double t : kInstants) {
      std::size_t f = tile.first;
      while (f < tile.end() && !is_thin(f, t)) ++f;
      if (f < tile.end()) ++thin;
    }
  }
  return samples == 0 ? 0 : static_cast<double>(thin) / static_cast<double>(samples * std::size(kInstants));
}

// Elements of groups one by one, without the paths around all of them, which only curves need.
class SampledGroups {
 public:
  SampledGroups(const Segment& segment, const NormalGroups& groups)
      : segment_(segment), faces_(segment), groups_(groups) {}

  void write(IndexRange elements, std::span<ControlTile> tiles) const {
    for (std::size_t i = 0; i < tiles.size() * kTile; ++i) {
      const std::size_t element = elements.first + std::min(i, elements.count - 1);
      const ControlNormals normals = in_double(element).normals;
      ControlTile& tile = tiles[i / kTile];
      put(tile, i % kTile, normals);
      tile.magnitude[i % kTile] = 0;
      for (const std::uint32_t f : groups_.faces(element)) {
        tile.magnitude[i % kTile] += magnitudes_.of(*segment_.topology, f, [&] {
          ControlTile of_face;
          face_control_tiles(segment_, {f, 1}, std::span(&of_face, 1));
          return of_face.magnitude[0];
        });
      }
      tile.degree[i % kTile] = degree(normals);
    }
  }
  [[nodiscard]] BoundedNormals in_double(std::size_t i) const { return control_normals_of_group(faces_, groups_, i); }

 private:
  const Segment& segment_;
  SharedFaces faces_;
  LargeFaceValues<float> magnitudes_;
  const NormalGroups& groups_;
};

// The share of the elements whose faces no window holds, on a sample of the batches of NormalRecompute.
double scattered_share(const NormalGroups& groups) {
  constexpr std::size_t kSamples = 32, kBatch = 256, kWindow = std::size_t{1} << 14;
  const std::size_t batches = groups.size() / kBatch, samples = std::min(batches, kSamples);
  std::size_t scattered = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t first = batches * i / samples * kBatch;
    const auto begin = groups.faces(first), last = groups.faces(first + kBatch - 1);
    const std::span<const std::uint32_t> faces(begin.data(), last.data() + last.size());
    if (!faces.empty() && range_of(faces).count > kWindow) ++scattered;
  }
  return samples == 0 ? 0 : static_cast<double>(scattered) / static_cast<double>(samples);
}

template <class... Values>
std::string text_of(const char* format, Values... values) {
  std::array<char, 256> text{};
  const int size = std::snprintf(text.data(), text.size(), format, values...);
  return {text.data(), std::min(static_cast<std::size_t>(std::max(size, 0)), text.size() - 1)};
}

std::string reason_of(const StrategyChoice& choice, const MeshShape& shape, const StrategyOptions& options,
                      double evaluations) {
  const std::string anew = options.float_recompute != nullptr ? "recompute in float32" : "recompute";
  const std::string name = choice.strategy == NormalStrategy::kPolynomial ? "polynomial" : anew;
  if (shape.elements == 0) return anew + ": there is nothing to do";
  if (options.forced) return name + std::string(" because it was asked for");
  const std::string costs =
      text_of("%.3g ns an element for %.6g evaluation%s, ", std::min(choice.polynomial_cost, choice.recompute_cost),
              evaluations, evaluations == 1 ? "" : "s");
  const double break_even =
      options.float_recompute != nullptr ? choice.costs.break_even_in_float32() : choice.costs.break_even();
  std::string reason = name + ": " + costs;
  if (choice.strategy == NormalStrategy::kPolynomial)
    reason.append(text_of("%.3g by %s", choice.recompute_cost, anew.c_str()));
  else
    reason.append(text_of("%.3g by polynomial", choice.polynomial_cost));
  if (std::isfinite(break_even))
    reason.append(text_of("; they are even at %.3g", break_even));
  else
    reason.append("; curves never pay here");
  return reason;
}

}  // namespace

std::string_view name_of(NormalStrategy strategy) noexcept {
  return strategy == NormalStrategy::kPolynomial ? "polynomial" : "recompute";
}

MeshShape shape_of(const Segment& segment) {
  const Topology& topology = *segment.topology;
  MeshShape shape;
  shape.elements = shape.faces = topology.face_count();
  shape.vertices = topology.vertex_count();
  if (shape.faces == 0) return shape;
  shape.triangles_per_face =
      static_cast<double>(topology.corner_count()) / static_cast<double>(topology.face_count()) - 2;
  shape.lines_per_face = lines_per_face(topology);
  shape.degree = average_degree(segment);
  shape.thin = thin_share(segment);
  FaceNormals source(segment);
  find_doubtful(source, shape.elements, shape);
  return shape;
}

MeshShape shape_of(const Segment& segment, const NormalGroups& groups) {
  MeshShape shape = shape_of(segment);
  shape.elements = groups.size();
  if (shape.elements > 0) {
    shape.faces_per_element =
        static_cast<double>(segment.topology->corner_count()) / static_cast<double>(shape.elements);
    shape.scattered = scattered_share(groups);
    if (shape.faces > 0) {
      SampledGroups source(segment, groups);
      find_doubtful(source, shape.elements, shape);
    }
  }
  return shape;
}

double StrategyCosts::break_even_with(double rival) const noexcept {
  return rival > evaluate ? prepare / (rival - evaluate) : std::numeric_limits<double>::infinity();
}

StrategyCosts model_costs(const MeshShape& shape, double tolerance) noexcept {
  StrategyCosts costs;
  if (shape.elements == 0) return costs;
  const auto elements = static_cast<double>(shape.elements), faces = static_cast<double>(shape.faces);
  const auto vertices = static_cast<double>(shape.vertices);
  const double corners = (shape.triangles_per_face + 2) * faces;
  const bool is_sum = shape.faces_per_element > 0, is_polygon = shape.triangles_per_face > 1;
  // In good order the lines at the rim of what was read last are no misses.
  const double misses = std::max(0.0, shape.lines_per_face - 0.5) / (kFullMiss - 0.5);

  // What is read in order comes at the pace of all of it; what is missed comes from where the array is.
  const double read = kPositionBytes * vertices + kIndexBytes * corners * (is_sum ? 2 : 1);
  const Level level = level_of(read + kResultBytes * elements);
  const Level level_of_positions = level_of(kPositionBytes * vertices), level_of_terms = level_of(kTermBytes * faces);
  const auto front_end = [&](const Row& triangle, const Row& polygon, const Row& miss) {
    return shape.triangles_per_face * cost(is_polygon ? polygon : triangle, level) +
           kFullMiss * misses * cost(miss, level_of_positions);
  };
  const double thin = kRecomputeThin * shape.thin;
  const auto sum_of = [&](double face, const Row& term, const Row& miss) {
    return faces / elements * face +
           shape.faces_per_element * (cost(term, level) + misses * cost(miss, level_of_terms));
  };
  const double terms = is_sum ? shape.faces_per_element : 1, in_float = share_in_float(shape, tolerance);
  if (is_sum) {
    costs.recompute =
        sum_of(front_end(kRecomputeKept, kRecomputePolygon, kRecomputeMiss) + thin, kRecomputeTerm, kRecomputeTermMiss);
    costs.prepare = shape.faces_per_element * shape.triangles_per_face *
                    (cost(mixed(in_float, kPreparePoint, kPrepareFloatPoint), level) +
                     misses * cost(kPreparePointMiss, level_of_positions));
    costs.in_float32 = terms * (cost(kFloatTerm, level) + misses * cost(kFloatMiss, level_of_positions));
    // A mesh in no order keeps the normals of all faces, and needs no window.
    if (shape.lines_per_face <= kScatteredLines) costs.recompute += kRecomputeScattered * shape.scattered * terms;
  } else {
    costs.recompute = front_end(kRecomputeTriangle, kRecomputePolygon, kRecomputeMiss) + thin;
    costs.prepare = front_end(mixed(in_float, kPrepareTriangle, kPrepareFloatTriangle), kPreparePolygon, kPrepareMiss);
    costs.in_float32 = front_end(kFloatTriangle, kFloatTriangle, kFloatMiss);
  }
  costs.in_float32 += vertices / elements * cost(kFloatVertex, level);
  costs.recompute += kRecomputeDoubtful * shape.doubtful * terms;
  // Sixteen that are examined where those before them were not are prepared once more, with bounds.
  const double examined = std::min(1.0, static_cast<double>(kTile) * shape.doubtful);
  costs.prepare += std::min(shape.doubtful * (kExamined + kExaminedFace * terms),
                            examined * (1 - examined) * costs.prepare + shape.doubtful * kExaminedOfTile);

  const double kept = curve_bytes_of_element(shape.degree, tolerance);
  costs.curve_bytes = kept * elements;
  const double scratch = shape.lines_per_face > kScatteredLines ? kScatteredBytes * vertices / elements : 0;
  costs.prepare += kNewByte * (kept + scratch);
  const auto streaming = [bytes = (kept + kResultBytes) * elements](const Row& row) {
    return streaming_cost(row, bytes);
  };
  costs.evaluate = streaming(kEvaluate) + streaming(kEvaluateByte) * (kept + kResultBytes);
  costs.evaluate +=
      streaming(kEvaluateFlagged) * (tolerance <= kExactTolerance ? shape.flagged : shape.flagged_compact);
  return costs;
}

StrategyChoice choose_strategy(const MeshShape& shape, const StrategyOptions& options) {
  // Written so that NaN counts as one.
  const double evaluations = options.evaluations > 1 ? options.evaluations : 1;
  StrategyChoice choice;
  choice.costs = model_costs(shape, options.tolerance);
  choice.polynomial_cost = choice.costs.prepare + evaluations * choice.costs.evaluate;
  const double anew = options.float_recompute != nullptr ? choice.costs.in_float32 : choice.costs.recompute;
  choice.recompute_cost = evaluations * anew;
  // Recompute where they are even: it keeps no curves. An infinite number asks for the cheaper evaluation.
  const bool is_cheaper =
      std::isfinite(evaluations) ? choice.polynomial_cost < choice.recompute_cost : choice.costs.evaluate < anew;
  choice.strategy = is_cheaper ? NormalStrategy::kPolynomial : NormalStrategy::kRecompute;
  if (options.forced) choice.strategy = *options.forced;
  choice.reason = reason_of(choice, shape, options, evaluations);
  return choice;
}

SegmentNormals::SegmentNormals(const Segment& segment, const StrategyOptions& options, Threads threads)
    : choice_(choose_strategy(shape_of(segment), options)) {
  if (choice_.strategy == NormalStrategy::kPolynomial)
    normals_ = NormalCurves::of_faces(segment, {.tolerance = options.tolerance}, threads);
  else if (options.float_recompute != nullptr)
    normals_ = InFloat32{options.float_recompute, segment};
  else
    normals_ = NormalRecompute(segment);
}

SegmentNormals::SegmentNormals(const Segment& segment, const NormalGroups& groups, const StrategyOptions& options,
                               Threads threads)
    : choice_(choose_strategy(shape_of(segment, groups), options)) {
  if (choice_.strategy == NormalStrategy::kPolynomial)
    normals_ = NormalCurves::of_groups(segment, groups, {.tolerance = options.tolerance}, threads);
  else if (options.float_recompute != nullptr)
    normals_ = InFloat32{options.float_recompute, segment};
  else
    normals_ = NormalRecompute(segment, groups);
}

std::size_t SegmentNormals::unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) {
  return std::visit([&](auto& normals) { return normals.unit_normals(t, result, threads); }, normals_);
}

std::size_t SegmentNormals::size() const noexcept {
  if (const auto* const curves = std::get_if<NormalCurves>(&normals_)) return curves->size();
  if (const auto* const in_float32 = std::get_if<InFloat32>(&normals_)) return in_float32->size();
  return std::get_if<NormalRecompute>(&normals_)->size();
}

std::size_t SegmentNormals::bytes() const noexcept {
  if (const auto* const curves = std::get_if<NormalCurves>(&normals_)) return curves->bytes();
  if (const auto* const in_float32 = std::get_if<InFloat32>(&normals_)) return in_float32->bytes();
  return std::get_if<NormalRecompute>(&normals_)->bytes();
}

}  // namespace chronormal
