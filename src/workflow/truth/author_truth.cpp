#include "workflow/truth/author_truth.h"

#include <algorithm>
#include <optional>

#include "chronormal/normals/control_normals.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kFramesOfBlock = 256;
constexpr double kOnSum = 0.01 / kDegreesPerRadian;  // radians: a normal that is nearer to its sum has no offset

// Returns the largest angle, in radians, by which an exporter may have turned normals by rounding. Returns zero unless
// all components look like multiples of 1/127, since some exporters store normals as signed bytes.
double rounding_of_stored(const GltfShading& shading) {
  constexpr double kSteps = 127, kNear = 1e-3;
  constexpr std::size_t kEnough = 16;
  std::size_t count = 0;
  for (const float component : shading.normals) {
    const double steps = kSteps * static_cast<double>(component);
    if (std::fabs(steps - std::round(steps)) > kNear) return 0;
    count += component != 0 && std::fabs(component) != 1 ? 1U : 0U;
  }
  constexpr double kOfVector = 1.7320508075688772;
  return count >= kEnough ? 0.5 / kSteps * kOfVector : 0;
}

}  // namespace

// Finds the elements whose normals have offsets, the edges from which the azimuths of these offsets are measured, and
// the targets whose stored normals are stale (stale_keys.h).
class AuthorTruth::Finder {
 public:
  explicit Finder(AuthorTruth& truth)
      : truth_(truth),
        shading_(*truth.shading_),
        vertex_of_(vertices_of_elements(shading_)),
        tolerance_(std::max(kOnSum, rounding_of_stored(shading_))),
        base_(shading_),
        z0_(vertex_of_.size()),
        side_(vertex_of_.size(), 1),
        off_(vertex_of_.size()),
        stale_(shading_) {}

  void find() {
    // A target whose normals follow the rule of the mesh is not stale, even if its normals look stale compared with
    // plain sums of triangles.
    if (!stale_.list().empty()) stale_.keep_common(StaleKeys(shading_, &truth_.sums_));
    parallel_each(z0_.size(), kFramesOfBlock, [&](std::size_t i) {
      const auto e = static_cast<std::uint32_t>(i);
      if (vertex_of_[e] == kNone) return;
      const Vec3d r = unit(sum(base_, e)), stored = base_.normal(vertex_of_[e]);
      if (r == Vec3d{} || stored == Vec3d{}) return;
      side_[e] = dot(r, stored) < 0 ? -1 : 1;
      z0_[e] = side_[e] * r;
      off_[e] = angle_between(z0_[e], stored) > tolerance_ ? 1 : 0;
    });
    std::vector<std::size_t> targets = targets_with_normals(shading_);
    std::erase_if(targets, [&](std::size_t k) { return stale_.is_stale_everywhere(k); });
    if (targets.empty()) return;
    for (const std::size_t k : targets) note_bent(k);
    make_frames();
    if (truth_.frames_.empty()) return;
    for (const std::size_t k : targets) measure_edges(k);
    choose_edges();
    truth_.changes_.resize(shading_.set.targets.size());
    for (const std::size_t k : targets) find_changes(k);
  }

  [[nodiscard]] const std::vector<StaleKey>& stale() const noexcept { return stale_.list(); }

 private:
  [[nodiscard]] Vec3d sum(const StoredKey& key, std::uint32_t e) const {
    return truth_.sums_.at(e, [&](std::uint32_t v) { return key.position(v); }).normal;
  }

  // Marks the elements whose stored normals in target k, at weight 1, differ from the sum of face normals by more than
  // the tolerance.
  void note_bent(std::size_t k) {
    const StoredKey key(shading_, k);
    std::vector<bool> moves(shading_.element_of_vertex.size());
    for (const std::uint32_t v : shading_.set.targets[k].vertices) moves[v] = true;
    const std::vector<bool> around = truth_.sums_.elements_around(moves);
    parallel_each(vertex_of_.size(), kFramesOfBlock, [&](std::size_t i) {
      const auto e = static_cast<std::uint32_t>(i);
      if (off_[e] != 0 || vertex_of_[e] == kNone || z0_[e] == Vec3d{}) return;
      if ((!around[e] && !key.turns(vertex_of_[e])) || stale_.is_stale(k, vertex_of_[e])) return;
      const Vec3d stored = key.normal(vertex_of_[e]), z = side_[e] * unit(sum(key, e));
      if (z != Vec3d{} && stored != Vec3d{} && angle_between(z, stored) > tolerance_) off_[e] = 1;
    });
  }

  // Lists the edges around each element that has an offset, one edge to each neighbouring point.
  void make_frames() {
    for (std::uint32_t e = 0; e < off_.size(); ++e) {
      if (off_[e] == 0 || z0_[e] == Vec3d{}) continue;
      Frame frame;
      frame.first_edge = static_cast<std::uint32_t>(truth_.edges_.size());
      frame.side = side_[e];
      std::vector<std::uint32_t> seen;
      truth_.sums_.for_edges(e, [&](std::uint32_t from, std::uint32_t to) {
        const std::uint32_t point = shading_.point_of_vertex[to];
        if (std::find(seen.begin(), seen.end(), point) != seen.end()) return;
        seen.push_back(point);
        truth_.edges_.push_back({from, to});
      });
      frame.edge_count = static_cast<std::uint32_t>(truth_.edges_.size()) - frame.first_edge;
      if (truth_.frame_of_element_.empty()) truth_.frame_of_element_.assign(off_.size(), kNone);
      truth_.frame_of_element_[e] = static_cast<std::uint32_t>(truth_.frames_.size());
      element_of_.push_back(e);
      truth_.frames_.push_back(frame);
    }
    base_offsets_.resize(truth_.edges_.size());
    differences_.resize(truth_.edges_.size());
    parallel_each(truth_.frames_.size(), kFramesOfBlock, [&](std::size_t n) {
      const Frame& frame = truth_.frames_[n];
      for (std::uint32_t i = frame.first_edge; i < frame.first_edge + frame.edge_count; ++i) {
        const std::optional<PlaneOffset> offset = by_edge(base_, n, i, z0_[element_of_[n]]);
        if (offset)
          base_offsets_[i] = *offset;
        else
          differences_[i] = -1;
      }
    });
  }

  // Returns the offset of a stored normal, with its azimuth measured from an edge. Returns nothing if no azimuth can be
  // measured from this edge.
  [[nodiscard]] std::optional<PlaneOffset> by_edge(const StoredKey& key, std::size_t n, std::uint32_t edge,
                                                   const Vec3d& z) const {
    const auto position = [&](std::uint32_t v) { return key.position(v); };
    const Frame& frame = truth_.frames_[n];
    if (!gives_azimuth(truth_.edges_of(frame), truth_.edges_[edge], z, position)) return std::nullopt;
    Frame measured = frame;
    measured.edge = edge;
    return measured_offset(key, n, measured, z);
  }

  [[nodiscard]] PlaneOffset measured_offset(const StoredKey& key, std::size_t n, const Frame& frame,
                                            const Vec3d& z) const {
    const auto position = [&](std::uint32_t v) { return key.position(v); };
    const Vec3d x = frame.edge == kNone ? turned_with(frame, z) : zero_azimuth(truth_.edges_[frame.edge], z, position);
    return offset_of(key.normal(vertex_of_[element_of_[n]]), z, x,
                     mean_edge_angle(truth_.edges_of(frame), z, position));
  }

  // Returns true if an offset can be measured from the stored normal of the element of frame n in target k, at weight
  // 1. Writes the unit sum of face normals in this target to z.
  [[nodiscard]] bool tells(const StoredKey& key, std::size_t k, std::size_t n, Vec3d& z) const {
    const std::uint32_t e = element_of_[n];
    if (stale_.is_stale(k, vertex_of_[e])) return false;
    z = side_[e] * unit(sum(key, e));
    return z != Vec3d{} && key.normal(vertex_of_[e]) != Vec3d{};
  }

  void measure_edges(std::size_t k) {
    const StoredKey key(shading_, k);
    parallel_each(truth_.frames_.size(), kFramesOfBlock, [&](std::size_t n) {
      Vec3d z;
      if (!tells(key, k, n, z)) return;
      const Frame& frame = truth_.frames_[n];
      for (std::uint32_t i = frame.first_edge; i < frame.first_edge + frame.edge_count; ++i) {
        if (differences_[i] < 0) continue;
        const std::optional<PlaneOffset> offset = by_edge(key, n, i, z);
        if (!offset) {
          differences_[i] = -1;
          continue;
        }
        const double x = offset->x - base_offsets_[i].x, y = offset->y - base_offsets_[i].y;
        differences_[i] += x * x + y * y;
      }
    });
  }

  void choose_edges() {
    parallel_each(truth_.frames_.size(), kFramesOfBlock, [&](std::size_t n) {
      Frame& frame = truth_.frames_[n];
      for (std::uint32_t i = frame.first_edge; i < frame.first_edge + frame.edge_count; ++i) {
        if (differences_[i] >= 0 && (frame.edge == kNone || differences_[i] < differences_[frame.edge])) frame.edge = i;
      }
      const Vec3d& z = z0_[element_of_[n]];
      if (frame.edge != kNone) {
        frame.base = base_offsets_[frame.edge];
        return;
      }
      frame.base_z = z;
      const Vec3d axis = std::fabs(z.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
      frame.base_x = unit(axis - dot(axis, z) * z);
      frame.base = measured_offset(base_, n, frame, z);
    });
  }

  void find_changes(std::size_t k) {
    const StoredKey key(shading_, k);
    std::vector<PlaneOffset> by(truth_.frames_.size());
    parallel_each(by.size(), kFramesOfBlock, [&](std::size_t n) {
      Vec3d z;
      if (!tells(key, k, n, z)) return;
      const Frame& frame = truth_.frames_[n];
      const PlaneOffset offset = measured_offset(key, n, frame, z);
      by[n] = {offset.x - frame.base.x, offset.y - frame.base.y};
    });
    for (std::uint32_t n = 0; n < by.size(); ++n)
      if (by[n].x != 0 || by[n].y != 0) truth_.changes_[k].push_back({n, by[n]});
  }

  AuthorTruth& truth_;
  const GltfShading& shading_;
  std::vector<std::uint32_t> vertex_of_;
  double tolerance_;
  StoredKey base_;
  std::vector<Vec3d> z0_;  // unit sum of each element in the base, on the side that the author shows
  std::vector<double> side_;
  std::vector<char> off_;
  StaleKeys stale_;
  std::vector<std::uint32_t> element_of_;  // for each frame, its element
  std::vector<PlaneOffset> base_offsets_;  // for each edge, the base's offset with the azimuth measured from it
  // Holds for each edge a sum over the targets at weight 1 for which tells() is true: the squared distance between the
  // offset in the target and the offset in the base, with azimuths measured from this edge. Holds -1 if the edge cannot
  // be used.
  std::vector<double> differences_;
};

AuthorTruth::AuthorTruth(const GltfShading& shading, Weighting weighting) : shading_(&shading) {
  rule_.weighting = weighting;
  if (is_plain()) return;
  sums_ = AuthorSums(shading, Polygons(shading.set.topology), weighting, std::vector<bool>(shading.groups.size()));
}

AuthorTruth::AuthorTruth(const GltfShading& shading, bool any_split) : shading_(&shading), any_split_(any_split) {
  FoundRule found = find_author_rule(shading);
  rule_ = found.rule;
  sums_ = std::move(found.sums);
  if (!targets_with_normals(shading).empty()) {
    Finder finder(*this);
    finder.find();
    stale_ = finder.stale();
  }
  if (is_plain()) sums_ = AuthorSums();  // sums by area need no lists
}

Vec3d AuthorTruth::turned_with(const Frame& frame, const Vec3d& z) { return turned(frame.base_z, z, frame.base_x); }

AuthorTruth::Pose AuthorTruth::pose(std::span<const double> weights) const {
  Pose result(frames_.size());
  for (std::size_t n = 0; n < frames_.size(); ++n) result[n] = frames_[n].base;
  for (std::size_t k = 0; k < std::min(weights.size(), changes_.size()); ++k) {
    if (weights[k] == 0) continue;
    for (const Change& change : changes_[k]) {
      result[change.frame].x += weights[k] * change.by.x;
      result[change.frame].y += weights[k] * change.by.y;
    }
  }
  return result;
}

AuthorTruth::Pose AuthorTruth::pose_alone(std::size_t target, double weight) const {
  std::vector<double> weights(changes_.size());
  if (target < weights.size()) weights[target] = weight;
  return pose(weights);
}

std::vector<std::uint32_t> AuthorTruth::elements_of(std::size_t target) const {
  if (target >= shading_->set.targets.size()) return {};  // the target is not in the author's mesh; a bake added it
  std::vector<bool> moves(shading_->element_of_vertex.size());
  for (const std::uint32_t v : shading_->set.targets[target].vertices) moves[v] = true;
  std::vector<bool> turns = sums_.elements_around(moves);
  if (target < changes_.size()) {
    std::vector<bool> changed(frames_.size());
    for (const Change& change : changes_[target]) changed[change.frame] = true;
    for (std::size_t e = 0; e < frame_of_element_.size(); ++e)
      if (frame_of_element_[e] != kNone && changed[frame_of_element_[e]]) turns[e] = true;
  }
  std::vector<std::uint32_t> result;
  for (std::uint32_t e = 0; e < turns.size(); ++e)
    if (turns[e]) result.push_back(e);
  return result;
}

AuthorTruth author_truth(GltfShading& shading, std::optional<Weighting> asked) {
  if (asked) return {shading, *asked};
  const bool any_split = split_by_keys(shading);
  return AuthorTruth(shading, any_split);
}

}  // namespace chronormal::inline internal
