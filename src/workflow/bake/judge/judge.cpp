// Poses are columns of weights side by side, so that a delta is added to many poses in one loop over memory.
#include "workflow/bake/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kSamplesOfBlock = 8192, kMostOfBlock = 1024, kEdgeBlock = 1024;
constexpr int kFineBits = 16;
constexpr auto kDegrees = static_cast<float>(kDegreesPerRadian);
// Limits for the samples whose right normals are held, and for the poses of one kind.
constexpr std::size_t kMostPairs = 2500000, kFewestPoses = 12, kMostPoses = 800;
// A glance takes every eighth pose, but no fewer than this if there are more.
constexpr std::size_t kGlance = 8, kFewestAtGlance = 24;
// The number of errors of vertices that are held at once.
constexpr std::size_t kMostErrors = 4000000;

// Returns the viewer without rounding that is too fine to decide a choice, or comes from compressors: half floats, and
// numbers of a few bits.
Viewer without_rounding(Viewer viewer) {
  viewer.bits = viewer.normals == NormalRule::kClamped ? kFineBits : 32;
  viewer.octahedral_base = false;
  return viewer;
}

// Returns whether two viewers render all deltas alike.
bool shows_alike(const Viewer& a, const Viewer& b, bool is_skinned) {
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base && (a.skins == b.skins || !is_skinned);
}

// Holds the weights of poses by column, side by side, and the range of poses in which a column has any: if targets are
// judged alone, most columns have no weight in most poses.
class PoseWeights {
 public:
  explicit PoseWeights(std::span<const SeenPose> poses)
      : poses_(poses.size()), active_(poses.empty() ? 0 : poses[0].weights.size()), weights_(poses_ * active_.size()) {
    for (std::size_t p = 0; p < poses_; ++p) {
      for (std::size_t c = 0; c < active_.size(); ++c) {
        const auto weight = static_cast<float>(poses[p].weights[c]);
        weights_[c * poses_ + p] = weight;
        if (weight == 0) continue;
        IndexRange& active = active_[c];
        if (active.count == 0) active.first = p;
        active.count = p + 1 - active.first;
      }
    }
    for (std::uint32_t c = 0; c < active_.size(); ++c)
      if (active_[c].count > 0) columns_.push_back(c);
  }

  // Returns the weights of a column: (poses).
  [[nodiscard]] const float* of(std::size_t column) const { return weights_.data() + column * poses_; }
  // Returns the columns with any weight, ascending.
  [[nodiscard]] std::span<const std::uint32_t> columns() const { return columns_; }
  // Returns the range of poses beyond which the column has no weight.
  [[nodiscard]] const IndexRange& active(std::size_t column) const { return active_[column]; }

 private:
  std::size_t poses_;
  std::vector<IndexRange> active_;
  std::vector<std::uint32_t> columns_;
  std::vector<float> weights_;
};

// Holds the sums of one vertex in many poses.
class Sums {
 public:
  void add_up(const Viewer& viewer, const Vec3f& normal, std::span<const VertexColumns::Entry> entries,
              const PoseWeights& weights, std::size_t first, std::size_t count) {
    const Vec3f base = kept_normal(viewer, normal);
    x_.assign(count, base.x);
    y_.assign(count, base.y);
    z_.assign(count, base.z);
    const auto add = [&](std::uint32_t column, const Vec3f& delta) {
      const IndexRange& active = weights.active(column);
      const std::size_t begin = std::max(active.first, first), end = std::min(active.end(), first + count);
      if (begin >= end) return;
      const Vec3f kept = kept_delta(viewer, normal, base, delta);
      const float* const w = weights.of(column) + first;
      for (std::size_t p = begin - first; p < end - first; ++p) {
        x_[p] += w[p] * kept.x;
        y_[p] += w[p] * kept.y;
        z_[p] += w[p] * kept.z;
      }
    };
    constexpr std::size_t kFew = 8;  // a list of entries is searched for columns only if it is this many times longer
    if (kFew * weights.columns().size() > entries.size()) {
      for (const auto& [column, delta] : entries) add(column, delta);
      return;
    }
    for (const std::uint32_t column : weights.columns()) {
      const auto found = std::lower_bound(entries.begin(), entries.end(), column,
                                          [](const auto& entry, std::uint32_t c) { return entry.column < c; });
      if (found != entries.end() && found->column == column) add(column, found->delta);
    }
  }

  // Replaces the sums by what the skin makes of them.
  void carry(const SkinsInPoses::Vertex& carrying, SkinRule rule) {
    for (std::size_t p = 0; p < x_.size(); ++p) {
      const Vec3f seen = to_float(carrying.seen(rule, p, to_double(Vec3f{x_[p], y_[p], z_[p]})));
      x_[p] = seen.x;
      y_[p] = seen.y;
      z_[p] = seen.z;
    }
  }

  // Writes the angles to the right normals in degrees, negative where no right normal is known, and the differences of
  // unit vectors as planes, NaN where none is known. Returns the largest length of a difference. right has three
  // planes.
  float compare_with(const std::array<const float*, 3>& right, std::span<float> degrees, std::span<float> errors) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const std::size_t count = degrees.size();
    const auto [u, v, w] = right;
    const float *const x = x_.data(), *const y = y_.data(), *const z = z_.data();
    for (std::vector<double>* const of : {&across_, &along_, &angles_}) of->resize(count);
    for (std::size_t p = 0; p < count; ++p) {
      const float a = y[p] * w[p] - z[p] * v[p], b = z[p] * u[p] - x[p] * w[p], c = x[p] * v[p] - y[p] * u[p];
      across_[p] = static_cast<double>(std::sqrt(a * a + b * b + c * c));
      along_[p] = static_cast<double>(x[p] * u[p] + y[p] * v[p] + z[p] * w[p]);
    }
    upper_angles(across_, along_, angles_);
    float *const to_x = errors.data(), *const to_y = to_x + count, *const to_z = to_y + count;
    for (std::size_t p = 0; p < count; ++p) {
      const float size = std::sqrt(x[p] * x[p] + y[p] * y[p] + z[p] * z[p]);
      const float angle = kDegrees * static_cast<float>(angles_[p]);
      const bool is_lit = size > 0 && size <= std::numeric_limits<float>::max() && angle <= 180.5F;
      const bool is_known = u[p] != 0 || v[p] != 0 || w[p] != 0;
      degrees[p] = is_known ? is_lit ? angle : 180 : -1;
      // A normal that is not lit counts as one that points to the other side.
      const float scale = is_lit ? 1 / size : 0, side = is_known ? is_lit ? 1 : 2 : kNan;
      to_x[p] = (is_lit ? scale * x[p] : 0) - side * u[p];
      to_y[p] = (is_lit ? scale * y[p] : 0) - side * v[p];
      to_z[p] = (is_lit ? scale * z[p] : 0) - side * w[p];
    }
    float largest = 0;
    for (std::size_t p = 0; p < count; ++p)
      largest = std::max(largest, to_x[p] * to_x[p] + to_y[p] * to_y[p] + to_z[p] * to_z[p]);  // NaN counts for nothing
    return std::sqrt(largest);
  }

 private:
  std::vector<float> x_, y_, z_;
  std::vector<double> across_, along_, angles_;
};

// Returns the edges with an end among some vertices, by indices in that list; other vertices have an index beyond its
// end.
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

// Writes vectors as planes with this distance.
void write_planes(std::span<const Vec3f> vectors, float* planes, std::size_t stride) {
  for (std::size_t p = 0; p < vectors.size(); ++p) {
    planes[p] = vectors[p].x;
    planes[stride + p] = vectors[p].y;
    planes[2 * stride + p] = vectors[p].z;
  }
}

std::array<const float*, 3> planes_at(const float* first, std::size_t stride) {
  return {first, first + stride, first + 2 * stride};
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
             std::span<const Viewer> viewers, bool animations_only)
    : rights_(rights), weights_(weights), viewers_(viewers) {
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
    sums.add_up(Viewer{}, to_float(rights_.stored(vertices_[n])), columns.of(n), weights, first, right.size());
    degrees.resize(right.size());
    errors.resize(3 * right.size());
    planes.resize(3 * right.size());
    write_planes(right, planes.data(), right.size());
    (void)sums.compare_with(planes_at(planes.data(), right.size()), degrees, errors);
    for (const float error : degrees) result[n] = std::fmax(result[n], error);
  });
  return result;
}

std::vector<ErrorsOfKinds> Judge::measure(const Candidate& candidate, Depth depth, bool with_rounding) const {
  std::vector<ErrorsOfKinds> result(viewers_.size());
  const VertexColumns columns = columns_of(candidate, vertices_);
  for (const KnownSet& known : sets_) {
    if (candidate.animations_only && known.set.kind != PoseKind::kFile) continue;
    const std::size_t count = known.set.poses.size();
    const std::size_t step = depth == Depth::kAll ? 1 : std::clamp<std::size_t>(count / kFewestAtGlance, 1, kGlance);
    const std::vector<SeenPose> poses =
        with_extra_targets(known.set, weights_, candidate.drivers, viewers_[known.set.viewers[0]]);
    const bool is_skinned = any_skinned(poses);
    std::vector<std::pair<Viewer, JudgedErrors>> measured;
    for (const std::size_t v : known.set.viewers) {
      const Viewer viewer = with_rounding ? viewers_[v] : without_rounding(viewers_[v]);
      auto found = std::find_if(measured.begin(), measured.end(),
                                [&](const auto& of_other) { return shows_alike(of_other.first, viewer, is_skinned); });
      if (found == measured.end()) {
        measured.emplace_back(viewer, errors_of(known, viewer, columns, poses, step));
        found = measured.end() - 1;
      }
      result[v][static_cast<std::size_t>(known.set.kind)].add(found->second);
    }
  }
  return result;
}

JudgedErrors Judge::errors_of(const KnownSet& known, const Viewer& viewer, const VertexColumns& columns,
                              std::span<const SeenPose> all, std::size_t step) const {
  JudgedErrors result;
  const std::size_t count = known.numbers.size();
  const std::size_t at_once = std::max<std::size_t>(1, kMostErrors / std::max<std::size_t>(1, count));
  std::vector<SeenPose> looked_at;
  std::vector<std::size_t> places;
  for (std::size_t p = step / 2; p < all.size(); p += step) {
    looked_at.push_back(all[p]);
    places.push_back(p);
  }
  Differences differences{std::vector<float>(), std::vector<float>(count), 0};
  for (std::size_t first = 0; first < looked_at.size(); first += at_once) {
    const std::size_t poses = std::min(at_once, looked_at.size() - first);
    const std::span<const SeenPose> some = std::span(looked_at).subspan(first, poses);
    const PoseWeights weights(some);
    const SkinsInPoses skins(some);
    differences.poses = poses;
    result.poses += poses;
    differences.planes.resize(3 * count * poses);
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
      sums.add_up(viewer, to_float(rights_.stored(vertex)), columns.of(n), weights, 0, poses);
      if (skins.any()) {
        const SkinsInPoses::Vertex carrying(skins, vertex, 0, poses);
        sums.carry(carrying, viewer.skins);
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
    result.tears.add(tears_of(known, differences));
  }
  return result;
}

TearCounts Judge::tears_of(const KnownSet& known, const Differences& differences) const {
  // Vertices that are not judged count as without error.
  const std::size_t count = known.numbers.size(), poses = differences.poses;
  const std::vector<float> none(3 * poses, 0.0F);
  return parallel_fold<TearCounts>(
      known.edges.size(), kEdgeBlock,
      [&](std::size_t edge, TearCounts& counts) {
        const auto [a, b] = known.edges[edge];
        // A jump is no larger than the sum of both errors.
        const float most = differences.largest[a] + (b < count ? differences.largest[b] : 0);
        if (most * most < TearCounts::kSquares[0]) return;
        counts.add(differences.planes.data() + 3 * a * poses,
                   b < count ? differences.planes.data() + 3 * b * poses : none.data(), poses);
      },
      [](TearCounts& to, const TearCounts& from) { to.add(from); });
}

}  // namespace chronormal::inline internal
