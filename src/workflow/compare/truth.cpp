// Leaves out keyframes of a motion, lets schemes interpolate normals at the times of these keyframes, and compares
// these normals with the true normals.
#include "chronormal/workflow/compare.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/quality/shared_reference.h"
#include "chronormal/core/parallel.h"
#include "chronormal/motion/paths.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/schemes/scheme.h"
#include "core/text.h"
#include "normals/control/shared_faces.h"
#include "workflow/sample/scheme_normals.h"

namespace chronormal {
namespace {

constexpr std::size_t kTruthBlock = 1024;

// The keyframes of a motion that are not left out: every `every`-th keyframe.
class KeptKeys {
 public:
  KeptKeys(const Motion& motion, std::size_t every) : motion_(motion), every_(every) {}

  [[nodiscard]] std::size_t count() const { return (motion_.keyframes.size() - 1) / every_ + 1; }
  [[nodiscard]] const Motion::Keyframe& operator[](std::size_t i) const { return motion_.keyframes[i * every_]; }
  [[nodiscard]] Segment segment(std::size_t i) const {
    const KeptKeys& keys = *this;
    Segment segment = still_segment(motion_.topology, keys[i]);
    const Segment end = still_segment(motion_.topology, keys[i + 1]);
    segment.to = end.to;
    segment.to_residuals = end.to_residuals;
    segment.start_time = keys[i].time;
    segment.end_time = keys[i + 1].time;
    segment.index = i;
    return segment;
  }
  // Returns the keyframes that were left out between the kept keyframes i and i + 1.
  [[nodiscard]] std::span<const Motion::Keyframe> between(std::size_t i) const {
    return std::span(motion_.keyframes).subspan(i * every_ + 1, every_ - 1);
  }
  [[nodiscard]] std::vector<const Motion::Keyframe*> all() const {
    std::vector<const Motion::Keyframe*> keys;
    for (std::size_t i = 0; i < count(); ++i) keys.push_back(&(*this)[i]);
    return keys;
  }

 private:
  const Motion& motion_;
  std::size_t every_;
};

// The elements of a motion, with their control normals. Elements are faces, or groups of the corners of faces.
class TruthElements {
 public:
  TruthElements(const Topology& topology, std::optional<NormalGroups> groups)
      : groups_(std::move(groups)), count_(groups_ ? groups_->size() : topology.face_count()) {}

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] bool are_faces() const noexcept { return !groups_; }
  [[nodiscard]] std::size_t first_output(std::size_t element) const {
    if (!groups_) return element;
    const auto outputs = groups_->element_of_output();
    return static_cast<std::size_t>(std::find(outputs.begin(), outputs.end(), element) - outputs.begin());
  }
  [[nodiscard]] std::vector<ControlNormals> control_normals(const Segment& segment) const {
    std::vector<ControlNormals> of_faces = all_face_control_normals(segment);
    if (!groups_) return of_faces;
    std::vector<ControlNormals> result(count_);
    group_control_normals(segment, *groups_, of_faces, {0, count_}, result);
    return result;
  }
  // Computes the exact normals of a mesh that does not move.
  void exact_normals(const Segment& still, IndexRange range, std::span<Vec3d> result) const {
    if (!groups_) return reference_normals(still, range, 0, result);
    const SharedFaces shared(still);
    const LargeFaceValues<ReferenceArea> large;
    std::vector<ReferenceArea> areas;
    for (std::size_t i = 0; i < range.count; ++i) {
      const auto faces = groups_->faces(range.first + i);
      areas.clear();
      for (const std::uint32_t f : faces)
        areas.push_back(large.of(*still.topology, f, [&] { return reference_area(still, f, 0); }));
      result[i] = reference_normal(shared, faces, areas, 0);
    }
  }

  template <class Body>
  static void parallel_blocks_of(std::size_t count, const Body& body) {
    parallel_for((count + kTruthBlock - 1) / kTruthBlock, [&](std::size_t b) {
      body(IndexRange{b * kTruthBlock, std::min(kTruthBlock, count - b * kTruthBlock)});
    });
  }

 private:
  std::optional<NormalGroups> groups_;
  std::size_t count_;
};

// The segment between two kept keyframes, and the keyframes between them that were left out.
struct Piece {
  Segment segment;
  std::span<const Motion::Keyframe> between;
  std::vector<ControlNormals> straight;
  std::vector<std::vector<Motion::Keyframe>> curved;  // for each curved path, the poses at the times of `between`

  [[nodiscard]] double local_time(const Motion::Keyframe& keyframe) const {
    return (keyframe.time - segment.start_time) / (segment.end_time - segment.start_time);
  }
};

// Returns the poses of a mesh whose vertices move on `curve`, at the times of the keyframes that were left out.
std::vector<Motion::Keyframe> poses_on_curve(const Piece& piece, const CubicSegment& curve) {
  std::vector<Motion::Keyframe> poses;
  for (const Motion::Keyframe& keyframe : piece.between) {
    const double t = piece.local_time(keyframe);
    std::vector<double> coordinates;
    for (std::size_t v = 0; v < piece.segment.topology->vertex_count(); ++v) {
      const Vec3d p = curve.position(v, t);
      coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    }
    poses.emplace_back().set_positions(coordinates, std::vector<double>(coordinates.size(), 0));
  }
  return poses;
}

// Measures the errors on one block of elements, for all rows of the result. The rows of schemes come first, then the
// rows of curved paths.
std::vector<Quality> errors_of_block(const Piece& piece, const TruthElements& elements, IndexRange range,
                                     const std::vector<std::string>& names) {
  std::vector<std::unique_ptr<Scheme>> schemes;
  for (const std::string& name : names) {
    schemes.push_back(make_scheme(name).value());
    schemes.back()->prepare(
        {&piece.segment, range, std::span(piece.straight).subspan(range.first, range.count), elements.are_faces()});
  }
  std::vector<Quality> result(names.size() + piece.curved.size());
  std::vector<Vec3d> exact(range.count), on_curve(range.count);
  std::vector<float> packed(3 * range.count);
  const auto shown = VectorView<float>::packed(packed);
  for (const Motion::Keyframe& keyframe : piece.between) {
    const double t = piece.local_time(keyframe);
    const Segment still = still_segment(*piece.segment.topology, keyframe);
    elements.exact_normals(still, range, exact);
    const ErrorPlace first{piece.segment.index, range.first, t};
    for (std::size_t s = 0; s < schemes.size(); ++s) {
      schemes[s]->evaluate(t, shown);
      result[s].add(exact, shown, first);
    }
    for (std::size_t c = 0; c < piece.curved.size(); ++c) {
      const std::size_t k = static_cast<std::size_t>(&keyframe - piece.between.data());
      elements.exact_normals(still_segment(*piece.segment.topology, piece.curved[c][k]), range, on_curve);
      for (std::size_t i = 0; i < range.count; ++i) shown.set(i, to_float(unit(on_curve[i])));
      result[names.size() + c].add(exact, shown, first);
    }
  }
  return result;
}

Status check(const Motion& motion, const TruthOptions& options) {
  const auto refuse = [](const std::string& message) { return Error{ErrorCode::kUsage, "", message}; };
  if (options.every < 2) return refuse("no keyframe would be left out to compare with; give --truth 2 or more");
  if (motion.kind != MotionKind::kSequence)
    return refuse(
        "--truth is only for a sequence of keyframes, and this input is not one; leave --truth out to compare with "
        "exact normals");
  const std::size_t count = motion.keyframes.size();
  if (count < 3)
    return refuse("the motion has only two keyframes, so none can be left out to compare with; leave --truth out");
  if (count <= options.every)
    return refuse("only the first of " + counted(count, "keyframe", "keyframes") +
                  " would be kept, but at least two are needed; give --truth " + std::to_string(count - 1) +
                  " or less");
  return Success{};
}

}  // namespace

Result<TruthComparison> compare_with_truth(const Motion& motion, const TruthOptions& options) {
  if (const Status status = check(motion, options); !status) return status.error();
  const ElementKind kind = options.elements.kind;
  const std::vector<std::string> names = options.schemes.empty() ? default_schemes(kind) : options.schemes;
  for (const std::string& name : names) {
    if (const auto scheme = scheme_for(name, kind); !scheme) return scheme.error();
  }
  std::optional<NormalGroups> groups;
  if (kind != ElementKind::kFaces) {
    Result<NormalGroups> made = make_groups(motion, options.elements);
    if (!made) return made.error();
    groups = std::move(made).value();
  }
  const TruthElements elements(motion.topology, std::move(groups));
  const KeptKeys keys(motion, options.every);
  std::vector<PathKind> curves;
  if (keys.count() >= 3) curves.push_back(PathKind::kCatmullRom);
  if (check_path(motion, PathKind::kHermite)) curves.push_back(PathKind::kHermite);

  TruthComparison result;
  result.kind = kind;
  result.vertices = motion.topology.vertex_count();
  result.faces = motion.topology.face_count();
  result.elements = elements.count();
  result.kept = keys.count();
  result.left_out = (keys.count() - 1) * (options.every - 1);
  MotionStream whole(motion);
  result.bend = bend_of(whole, options.every).value();
  for (const std::string& name : names) result.rows.push_back({std::string(path_name(PathKind::kLinear)), name, {}});
  for (const PathKind curve : curves) result.rows.push_back({std::string(path_name(curve)), "exact", {}});

  const std::size_t blocks = (elements.count() + kTruthBlock - 1) / kTruthBlock;
  std::vector<std::vector<Quality>> found(blocks);
  for (std::size_t i = 0; i + 1 < keys.count(); ++i) {
    Piece piece{keys.segment(i), keys.between(i), elements.control_normals(keys.segment(i)), {}};
    for (const PathKind curve : curves)
      piece.curved.push_back(poses_on_curve(piece, cubic_segment(keys.all(), i, curve)));
    TruthElements::parallel_blocks_of(elements.count(), [&](IndexRange range) {
      found[range.first / kTruthBlock] = errors_of_block(piece, elements, range, names);
    });
    for (const std::vector<Quality>& block : found)
      for (std::size_t r = 0; r < result.rows.size(); ++r) result.rows[r].quality.add(block[r]);
    if (options.progress) options.progress(i + 1, keys.count() - 1);
  }
  for (TruthRow& row : result.rows) {
    if (row.quality.count > 0) row.quality.max_at.element = elements.first_output(row.quality.max_at.element);
  }
  return result;
}

}  // namespace chronormal
