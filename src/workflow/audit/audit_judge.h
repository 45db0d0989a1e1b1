/// The loop of an audit: right normals of the part of a mesh that moves, and what is shown instead. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_AUDIT_JUDGE_H_
#define CHRONORMAL_WORKFLOW_AUDIT_AUDIT_JUDGE_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/topology.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/audit.h"
#include "core/blocks.h"

namespace chronormal {

/// Below this part of its largest control normal, the direction of a normal means nothing.
inline constexpr double kVanished = 1e-4;

inline constexpr std::size_t kAuditSamples = 21, kAuditFewSamples = 5, kAuditManySegments = 32;

/// Something that shows a normal: a vertex, or a corner where a vertex has several normals.
struct JudgedOutput {
  std::uint32_t vertex = 0, element = 0;
  std::uint32_t face = 0, corner = 0;  ///< where a rule looks at them
};

struct PartNormals {
  std::vector<Vec3d> faces, elements;
};

/// The elements of some outputs, and the faces and vertices that these need, numbered anew.
class JudgedPart {
 public:
  /// Elements and faces of the outputs become those of this part; their vertices and corners stay those of the mesh.
  /// Without needs_faces, normals() may leave out those of faces. groups need no corners where the weighting is area.
  JudgedPart(const Topology& topology, const NormalGroups& groups, Weighting weighting,
             std::vector<JudgedOutput> outputs, bool needs_faces = true);

  /// Its vertices and its elements, as the mesh numbers them, ascending.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const std::uint32_t> elements() const noexcept { return elements_; }
  [[nodiscard]] std::span<const JudgedOutput> outputs() const noexcept { return outputs_; }

  /// Computes the normals of its faces and elements from positions of vertices(): cross products, and for elements
  /// their weighted sums (normals/weighting.h), without a look at what is rounding.
  void normals(std::span<const Vec3d> positions, PartNormals& result) const;

 private:
  [[nodiscard]] Vec3d face_normal(std::span<const Vec3d> positions, std::size_t face) const;
  // What a corner of a face adds to the normal of its element.
  [[nodiscard]] Vec3d term(std::span<const Vec3d> positions, std::size_t face, std::size_t corner,
                           const Vec3d& normal) const;

  std::vector<std::uint32_t> vertices_, elements_;
  std::vector<std::uint32_t> face_offsets_ = {0}, face_vertices_;        // of this part
  std::vector<std::uint32_t> element_offsets_ = {0}, faces_of_element_;  // of this part
  std::vector<std::uint32_t> corners_of_element_;  // 0, 1, 2 ... within these faces; empty where faces count by area
  Weighting weighting_;
  bool keeps_faces_;  // or each element computes the normals of its faces: no memory, and little time for small ones
  std::vector<JudgedOutput> outputs_;
};

/// What a rule shows between two stored normals; (0, 0, 0) where that is zero.
[[nodiscard]] Vec3f blend_stored(AuditRule rule, const Vec3d& from, const Vec3d& to, double t) noexcept;

/// The samples of a segment.
[[nodiscard]] std::size_t samples_per_segment(const AuditOptions& options, std::size_t segments) noexcept;

[[nodiscard]] Status check_samples(const AuditOptions& options);

/// The offset of stored normals (zero: none) from the geometry of some positions by a weighting, a normal for each
/// output.
/// groups must be those of the topology
[[nodiscard]] AuthoredOffset authored_offset(const Topology& topology, VectorView<const float> positions,
                                             const NormalGroups& groups, Weighting weighting,
                                             std::span<const JudgedOutput> outputs,
                                             const std::function<Vec3d(const JudgedOutput&)>& stored);

/// Sums over the subjects, finds the worst of them, and puts faults before notes.
void finish(Audit& result);

/// What one task takes.
inline constexpr std::size_t kRange = 4096;

/// Judges all samples of all segments of a source:
///     place(segment, t, positions)   writes the positions of the part; false where nothing differs from the last call
///     forget()                       makes the next call differ
///     begin(segment, start, end)     gets the normals at both ends before the samples (where kNeedsEnds)
///     shown(output)                  a normal of any length, zero for none
///     right(output, n)               the direction for a normal of the geometry
///     at(segment, t, output)         for people
template <class Source>
class Judge {
 public:
  Judge(Source& source, const JudgedPart& part, AuditRule rule) : source_(source), part_(part), rule_(rule) {}

  /// subject has its segments and samples. progress is called after each segment.
  void run(AuditSubject& subject, const std::function<void()>& progress) {
    positions_.resize(part_.vertices().size());
    find_scales(subject.segments);
    source_.forget();
    MotionError errors;  // of the last sample
    for (std::size_t s = 0; s < subject.segments; ++s) {
      begin(s);
      for (std::size_t i = 0; i < subject.samples; ++i) {
        const double t = subject.samples > 1 ? static_cast<double>(i) / static_cast<double>(subject.samples - 1) : 0;
        if (source_.place(s, t, positions_)) {
          part_.normals(positions_, normals_);
          errors = judge(s, t);
        }
        subject.error.add(errors);
        if (i == 0 || i + 1 == subject.samples) subject.at_keys.add(errors);
      }
      progress();
    }
    subject.vertices = part_.outputs().size();
  }

 private:
  // The largest control normal of each element: those of a quadratic follow from its ends and its middle.
  void find_scales(std::size_t segments) {
    scales_.assign(part_.elements().size(), 0.0);
    const auto normals_at = [&](std::size_t s, double t) -> std::vector<Vec3d> {
      if (source_.place(s, t, positions_)) part_.normals(positions_, normals_);
      return normals_.elements;
    };
    source_.forget();
    for (std::size_t s = 0; s < segments; ++s) {
      const std::vector<Vec3d> start = normals_at(s, 0), middle = normals_at(s, 0.5);
      const std::vector<Vec3d> end = normals_at(s, 1);
      numbered_blocks(scales_.size(), kRange, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t e = first; e < last; ++e) {
          const Vec3d m = 2.0 * middle[e] - 0.5 * (start[e] + end[e]);
          scales_[e] = std::max({scales_[e], length(start[e]), length(m), length(end[e])});
        }
      });
    }
  }

  void begin(std::size_t segment) {
    if constexpr (Source::kNeedsEnds) {
      PartNormals start;
      source_.place(segment, 0, positions_);
      part_.normals(positions_, start);
      source_.place(segment, 1, positions_);
      part_.normals(positions_, normals_);
      source_.begin(segment, start, normals_);
      source_.forget();
    }
  }

  [[nodiscard]] MotionError judge(std::size_t segment, double t) const {
    const std::span<const JudgedOutput> outputs = part_.outputs();
    std::vector<MotionError> of_ranges(block_count(outputs.size(), kRange));
    numbered_blocks(outputs.size(), kRange, [&](std::size_t range, std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) judge(outputs[i], segment, t, of_ranges[range]);
    });
    MotionError all;
    for (const MotionError& each : of_ranges) all.add(each);
    return all;
  }

  void judge(const JudgedOutput& output, std::size_t segment, double t, MotionError& errors) const {
    const Vec3d& normal = normals_.elements[output.element];
    const double scale = scales_[output.element];
    if (!(length(normal) > kVanished * scale)) {
      ++errors.no_normal;
      return;
    }
    const Vec3d shown = rule_ == AuditRule::kFlat ? normals_.faces[output.face] : to_double(source_.shown(output));
    if (shown == Vec3d{}) {
      ++errors.no_shown;
      return;
    }
    const double angle = angle_between(shown, source_.right(output, normal)) * kDegreesPerRadian;
    errors.add(angle, angle > errors.worst ? source_.at(segment, t, output) : AuditPlace());
  }

  Source& source_;
  const JudgedPart& part_;
  AuditRule rule_;
  std::vector<Vec3d> positions_;
  PartNormals normals_;
  std::vector<double> scales_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_AUDIT_JUDGE_H_
