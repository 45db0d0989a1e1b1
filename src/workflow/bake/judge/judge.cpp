// Measures the errors of candidates. The weights of many poses lie side by side in memory, so that one loop adds a
// delta to many poses.
#include "workflow/bake/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/quality/kernels/blended_normals.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kSamplesOfBlock = 8192, kMostOfBlock = 1024, kEdgeBlock = 1024;
constexpr int kFineBits = 16;
// kMostPairs is the largest number of samples whose right normals are in memory. A sample is a vertex in a pose. The
// other constants limit the number of poses of one kind.
constexpr std::size_t kMostPairs = 2500000, kFewestPoses = 12, kMostPoses = 800;
// Numbers of poses in a glance, which is a quick measurement. A glance takes every kGlance-th pose, but at least
// kFewestAtGlance poses, or all poses if there are fewer.
constexpr std::size_t kGlance = 8, kFewestAtGlance = 24;
// The largest number of errors (of a vertex in a pose) that are in memory at the same time.
constexpr std::size_t kMostErrors = 4000000;

// Returns the viewer without two kinds of rounding, because they must not decide which candidate is chosen. Rounding to
// half floats has too small an effect, and rounding to a few bits is done by compressors and not by the viewer.
Viewer without_rounding(Viewer viewer) {
  viewer.bits = viewer.normals == NormalRule::kClamped ? kFineBits : 32;
  viewer.octahedral_base = false;
  return viewer;
}

// Returns true if two viewers render the same normals for any deltas.
bool shows_alike(const Viewer& a, const Viewer& b, bool is_skinned) {
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base && (a.skins == b.skins || !is_skinned);
}

std::size_t padded(std::size_t poses) { return block_count(poses, kPosePadding) * kPosePadding; }

// The weights of poses, one column for each target. Each column also has the range of poses in which its weight is not
// zero. If targets are judged one by one, most columns have no weight in most poses.
class PoseWeights {
 public:
  explicit PoseWeights(std::span<const SeenPose> poses)
      : stride_(padded(poses.size())),
        active_(poses.empty() ? 0 : poses[0].weights.size()),
        weights_(stride_ * active_.size() + kPosePadding) {  // padded, since SIMD loads may begin at any pose
    for (std::size_t p = 0; p < poses.size(); ++p) {
      for (std::size_t c = 0; c < active_.size(); ++c) {
        const auto weight = static_cast<float>(poses[p].weights[c]);
        weights_[c * stride_ + p] = weight;
        if (weight == 0) continue;
        IndexRange& active = active_[c];
        if (active.count == 0) active.first = p;
        active.count = p + 1 - active.first;
      }
    }
    for (std::uint32_t c = 0; c < active_.size(); ++c)
      if (active_[c].count > 0) columns_.push_back(c);
  }

  // Returns the weights of a column (target) in all poses, padded with zeros.
  [[nodiscard]] const float* of(std::size_t column) const { return weights_.data() + column * stride_; }
  // Returns the columns (targets) that have a weight in some pose, in ascending order.
  [[nodiscard]] std::span<const std::uint32_t> columns() const { return columns_; }
  // Returns the range of poses outside of which the weight of a column (target) is 0.
  [[nodiscard]] const IndexRange& active(std::size_t column) const { return active_[column]; }

 private:
  std::size_t stride_;
  std::vector<IndexRange> active_;
  std::vector<std::uint32_t> columns_;
  std::vector<float> weights_;
};

std::array<const float*, 3> planes_at(const float* first, std::size_t stride) {
  return {first, first + stride, first + 2 * stride};
}

// The sums of the normal and the weighted deltas of one vertex, in many poses.
class Sums {
 public:
  // Adds up the normal of a vertex and its weighted deltas in `count` poses, beginning with pose `first`. The normal
  // and the deltas must be rounded as a viewer stores them.
  void add_up(const Vec3f& normal, std::span<const VertexColumns::Entry> entries, const PoseWeights& weights,
              std::size_t first, std::size_t count) {
    terms_.clear();
    no_sums_.clear();
    const auto add = [&](std::uint32_t column, const Vec3f& delta) {
      const IndexRange& active = weights.active(column);
      const std::size_t begin = std::max(active.first, first), end = std::min(active.end(), first + count);
      if (begin >= end) return;
      if (is_finite(to_double(delta)))
        terms_.push_back({weights.of(column) + first, begin - first, end - first, delta});
      else
        no_sums_.push_back({begin - first, end - begin});
    };
    constexpr std::size_t kFew = 8;  // lists with more entries than this per column are searched
    if (kFew * weights.columns().size() > entries.size()) {
      for (const auto& [column, delta] : entries) add(column, delta);
    } else {
      for (const std::uint32_t column : weights.columns()) {
        const auto found = std::lower_bound(entries.begin(), entries.end(), column,
                                            [](const auto& entry, std::uint32_t c) { return entry.column < c; });
        if (found != entries.end() && found->column == column) add(column, found->delta);
      }
    }
    stride_ = padded(count);
    planes_.resize(3 * stride_);
    add_weighted(normal, terms_, planes_.data(), stride_);
    for (const IndexRange& range : no_sums_)
      std::fill_n(planes_.data() + range.first, range.count, std::numeric_limits<float>::quiet_NaN());
  }

  // Replaces the sums by the normals that a viewer shows after the skin of each pose has transformed them.
  void carry(const SkinsInPoses::Vertex& carrying, SkinRule rule, std::size_t poses) {
    for (std::size_t p = 0; p < poses; ++p) {
      float *const x = planes_.data() + p, *const y = x + stride_, *const z = y + stride_;
      const Vec3f seen = to_float(carrying.seen(rule, p, to_double(Vec3f{*x, *y, *z})));
      *x = seen.x;
      *y = seen.y;
      *z = seen.z;
    }
  }

  // Compares the sums with the right normals, which are given as planes of x, y and z. Writes the angles between sums
  // and right normals in degrees, and the differences of the unit vectors as planes. Returns the length of the longest
  // difference.
  float compare_with(const std::array<const float*, 3>& right, std::span<float> degrees, std::span<float> errors) {
    float *const x = errors.data(), *const y = x + degrees.size(), *const z = y + degrees.size();
    return compare_normals(planes_at(planes_.data(), stride_), right, degrees, {x, y, z});
  }

 private:
  std::vector<WeightedVector> terms_;
  std::vector<IndexRange> no_sums_;  // poses that a delta makes infinite or NaN
  std::size_t stride_ = 0;
  std::vector<float> planes_;
};

// Returns the edges that have at least one end in a list of vertices. The result gives each end as the index of its
// vertex in the list, or as an index beyond the list if the vertex is not in the list.
std::vector<SurfaceEdge> edges_of(std::span<const SurfaceEdge> edges, std::span<const std::uint32_t> vertices,
                                  std::size_t vertex_count) {
  const auto none = static_cast<std::uint32_t>(vertices.size());
  std::vector<std::uint32_t> places(vertex_count, none);
  for (std::uint32_t place = 0; place < none; ++place) places[vertices[place]] = place;
  std::vector<SurfaceEdge> result;
  for (const auto& [a, b] : edges)
    if (places[a] != none || places[b] != none)
      result.push_back({std::min(places[a], places[b]), std::max(places[a], places[b])});
  return result;
}

// Writes vectors as three planes: all x, then all y, then all z. The planes begin `stride` floats apart.
void write_planes(std::span<const Vec3f> vectors, float* planes, std::size_t stride) {
  for (std::size_t p = 0; p < vectors.size(); ++p) {
    planes[p] = vectors[p].x;
    planes[stride + p] = vectors[p].y;
    planes[2 * stride + p] = vectors[p].z;
  }
}

std::vector<std::uint32_t> numbers_up_to(std::size_t count) {
  std::vector<std::uint32_t> result(count);
  for (std::size_t n = 0; n < count; ++n) result[n] = static_cast<std::uint32_t>(n);
  return result;
}

}  // namespace

ShownErrors JudgedErrors::errors() const {
  ShownErrors result = spread.errors();
  result.tears = tears.beyond;
  result.poses = poses;
  return result;
}

JudgedErrors errors_of_all(const ErrorsOfKinds& kinds) {
  JudgedErrors all;
  for (const JudgedErrors& errors : kinds) all.add(errors);
  return all;
}

Judge::Judge(const DeltaSource& source, const RightNormals& rights, const MeshWeights& weights,
             std::span<const Viewer> viewers, std::size_t named, bool animations_only)
    : rights_(rights),
      weights_(weights),
      viewers_(viewers),
      named_(named),
      are_sliders_driven_(source.plan.encoding != BakeEncoding::kSmallest) {
  const std::vector<VertexVectors> stored = stored_deltas(source.shading);
  vertices_ = judged_vertices(source, stored);
  const std::vector<SurfaceEdge> edges = surface_edges(source.shading);
  const std::size_t most =
      std::clamp(kMostPairs / std::max<std::size_t>(1, vertices_.size()), kFewestPoses, kMostPoses);
  for (PoseSet& set :
       pose_sets(weights, viewers, numbers_of_targets(source, stored, vertices_), most, animations_only)) {
    KnownSet& known = sets_.emplace_back();
    known.set = std::move(set);
    known.numbers = known.set.numbers.empty() ? numbers_up_to(vertices_.size()) : known.set.numbers;
    std::vector<std::uint32_t> some;
    for (const std::uint32_t n : known.numbers) some.push_back(vertices_[n]);
    PoseList poses;
    for (const PlayedPose& pose : known.set.poses) poses.push_back(pose.seen.weights);
    known.edges = edges_of(edges, some, source.shading.element_of_vertex.size());
    const std::size_t count = poses.size();
    known.right.resize(3 * some.size() * count);
    rights_.for_each(some, poses, [&](std::size_t at, std::size_t first, std::span<const Vec3f> right) {
      write_planes(right, known.right.data() + 3 * at * count + first, count);
    });
  }
}

std::vector<float> Judge::worst(const VertexColumns& columns, const PoseList& poses) const {
  std::vector<float> result(vertices_.size(), 0.0F);
  const std::vector<SeenPose> seen = seen_through(poses, nullptr);
  const PoseWeights weights(seen);
  rights_.for_each(vertices_, poses, [&](std::size_t n, std::size_t first, std::span<const Vec3f> right) {
    thread_local Sums sums;
    thread_local std::vector<float> degrees;
    thread_local std::vector<float> errors, planes;
    sums.add_up(to_float(rights_.stored(vertices_[n])), columns.of(n), weights, first, right.size());
    degrees.resize(right.size());
    errors.resize(3 * right.size());
    planes.resize(3 * right.size());
    write_planes(right, planes.data(), right.size());
    (void)sums.compare_with(planes_at(planes.data(), right.size()), degrees, errors);
    for (const float error : degrees) result[n] = std::fmax(result[n], error);
  });
  return result;
}

std::vector<ErrorsOfKinds> Judge::measure(const Candidate& candidate, Depth depth) const {
  std::vector<ErrorsOfKinds> result(viewers_.size());
  const VertexColumns columns = columns_of(candidate, vertices_);
  // Copies of the deltas as each kind of viewer stores them, for viewers that do not store the deltas of the candidate
  // as they are.
  std::vector<std::pair<Viewer, VertexColumns>> of_viewers;
  const auto kept_by = [&](const Viewer& viewer) -> const VertexColumns& {
    if (viewer.normals == NormalRule::kSum && !viewer.keeps_halves()) return columns;
    auto found = std::find_if(of_viewers.begin(), of_viewers.end(),
                              [&](const auto& of_other) { return shows_alike(of_other.first, viewer, false); });
    if (found == of_viewers.end()) {
      of_viewers.emplace_back(viewer, kept_columns(viewer, columns));
      found = of_viewers.end() - 1;
    }
    return found->second;
  };
  for (const KnownSet& known : sets_) {
    if (candidate.animations_only && known.set.kind != PoseKind::kFile) continue;
    if (depth == Depth::kGlance && !decides(known.set.kind)) continue;
    const std::vector<SeenPose> poses =
        with_extra_targets(known.set, weights_, candidate.drivers, viewers_[known.set.viewers[0]], are_sliders_driven_);
    const bool is_skinned = any_skinned(poses);
    std::vector<std::pair<Viewer, JudgedErrors>> measured;
    for (const std::size_t v : known.set.viewers) {
      if (depth == Depth::kGlance && v >= named_) continue;
      if (depth == Depth::kRounded && viewers_[v].normals != NormalRule::kClamped) continue;
      const Viewer viewer = depth == Depth::kRounded ? viewers_[v] : without_rounding(viewers_[v]);
      auto found = std::find_if(measured.begin(), measured.end(),
                                [&](const auto& of_other) { return shows_alike(of_other.first, viewer, is_skinned); });
      if (found == measured.end()) {
        measured.emplace_back(viewer, errors_of(known, viewer, kept_by(viewer), poses, depth));
        found = measured.end() - 1;
      }
      result[v][static_cast<std::size_t>(known.set.kind)].add(found->second);
    }
  }
  return result;
}

VertexColumns Judge::kept_columns(const Viewer& viewer, VertexColumns columns) const {
  parallel_each(vertices_.size(), kMostOfBlock, [&](std::size_t n) {
    const Vec3f normal = to_float(rights_.stored(vertices_[n])), kept = kept_normal(viewer, normal);
    for (std::size_t k = columns.first[n]; k < columns.first[n + 1]; ++k)
      columns.entries[k].delta = kept_delta(viewer, normal, kept, columns.entries[k].delta);
  });
  return columns;
}

JudgedErrors Judge::errors_of(const KnownSet& known, const Viewer& viewer, const VertexColumns& columns,
                              std::span<const SeenPose> all, Depth depth) const {
  JudgedErrors result;
  const std::size_t step = depth == Depth::kAll ? 1 : std::clamp<std::size_t>(all.size() / kFewestAtGlance, 1, kGlance);
  const std::size_t count = known.numbers.size();
  const std::size_t at_once = std::max<std::size_t>(1, kMostErrors / std::max<std::size_t>(1, count));
  std::vector<SeenPose> looked_at;
  std::vector<std::size_t> places;
  for (std::size_t p = step / 2; p < all.size(); p += step) {
    looked_at.push_back(all[p]);
    places.push_back(p);
  }
  Differences& differences = differences_;
  differences.largest.resize(count);
  for (std::size_t first = 0; first < looked_at.size(); first += at_once) {
    const std::size_t poses = std::min(at_once, looked_at.size() - first);
    const std::span<const SeenPose> some = std::span(looked_at).subspan(first, poses);
    const PoseWeights weights(some);
    const SkinsInPoses skins(some);
    differences.poses = poses;
    result.poses += poses;
    if (differences.planes.size() < 3 * count * poses) differences.planes.resize(3 * count * poses);
    const auto measure_vertex = [&](std::size_t at, ErrorSpread& spread) {
      thread_local Sums sums;
      thread_local std::vector<float> degrees, right;
      const std::size_t n = known.numbers[at];
      const std::uint32_t vertex = vertices_[n];
      const float* const of_all = known.right.data() + 3 * at * all.size();
      std::array<const float*, 3> planes = planes_at(of_all + first, all.size());
      if (step > 1 || skins.any()) {
        right.resize(3 * poses);
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (std::size_t p = 0; p < poses; ++p)
            right[axis * poses + p] = of_all[axis * all.size() + places[first + p]];
        planes = planes_at(right.data(), poses);
      }
      degrees.resize(poses);
      sums.add_up(kept_normal(viewer, to_float(rights_.stored(vertex))), columns.of(n), weights, 0, poses);
      if (skins.any()) {
        const SkinsInPoses::Vertex carrying(skins, vertex, 0, poses);
        sums.carry(carrying, viewer.skins, poses);
        for (std::size_t p = 0; p < poses; ++p) {
          const Vec3f of_mesh{right[p], right[poses + p], right[2 * poses + p]};
          const Vec3f seen = to_float(carrying.seen(viewer.skins, p, to_double(of_mesh)));
          write_planes(std::span(&seen, 1), right.data() + p, poses);
        }
      }
      differences.largest[at] =
          sums.compare_with(planes, degrees, std::span(differences.planes).subspan(3 * at * poses, 3 * poses));
      spread.add(degrees);
    };
    result.spread.add(
        parallel_fold<ErrorSpread>(count, std::clamp<std::size_t>(kSamplesOfBlock / poses, 1, kMostOfBlock),
                                   measure_vertex, [](ErrorSpread& to, const ErrorSpread& from) { to.add(from); }));
    if (depth != Depth::kGlance) result.tears.add(tears_of(known, differences));
  }
  return result;
}

TearCounts Judge::tears_of(const KnownSet& known, const Differences& differences) const {
  // Uses zeros for a vertex that is not judged, because such a vertex counts as a vertex without error.
  const std::size_t count = known.numbers.size(), poses = differences.poses;
  const std::vector<float> none(3 * poses, 0.0F);
  return parallel_fold<TearCounts>(
      known.edges.size(), kEdgeBlock,
      [&](std::size_t edge, TearCounts& counts) {
        const auto [a, b] = known.edges[edge];
        // Skips an edge if the errors at its two ends are too small for a tear. The length of the difference of these
        // errors is at most the sum of their lengths.
        const float most = differences.largest[a] + (b < count ? differences.largest[b] : 0);
        if (most * most < TearCounts::kSquares[0]) return;
        counts.add(differences.planes.data() + 3 * a * poses,
                   b < count ? differences.planes.data() + 3 * b * poses : none.data(), poses);
      },
      [](TearCounts& to, const TearCounts& from) { to.add(from); });
}

}  // namespace chronormal::inline internal
