// Compares schemes block by block. Processes enough blocks at a time to keep all threads busy, and adds up the results
// of blocks in order.
#include "chronormal/workflow/compare.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/quality/kernels/reference_angles.h"
#include "analysis/quality/shared_reference.h"
#include "chronormal/analysis/certify.h"
#include "chronormal/analysis/quality.h"
#include "chronormal/core/parallel.h"
#include "chronormal/normals/normal_groups.h"
#include "core/blocks.h"
#include "io/bytes/checksum.h"
#include "normals/control/shared_faces.h"
#include "normals/groups/group_sum.h"
#include "normals/weighting/sampled_normal.h"
#include "workflow/compare/compared.h"
#include "workflow/errors/error_rows.h"
#include "workflow/sample/scheme_normals.h"

namespace chronormal {
namespace {

// The numbers of elements in a block, and of blocks for each thread in a wave. A block is so small that it stays in the
// second-level cache, even with the scheme that needs most memory. The blocks of a wave are computed at the same time.
// A wave is small, so that few partial results are in memory and progress is reported often.
constexpr std::size_t kBlockSize = 1024;
constexpr std::size_t kBlocksPerWaveAndThread = 4;

using Clock = std::chrono::steady_clock;

double nanoseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

// Returns the median of measured times. A thread that is interrupted measures too long a time, and a few such values do
// not change the median.
double median(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The results of one scheme on one block, or the sum of such results over the blocks of a segment.
struct Tally : SchemeTally {
  std::vector<Quality> samples;                // the errors at each sample; set only if samples are kept
  std::vector<float> prepare_ns, evaluate_ns;  // nanoseconds per element, one value for each block

  void add(const Tally& other) {
    chronormal::add(*this, other);
    prepare_ns.insert(prepare_ns.end(), other.prepare_ns.begin(), other.prepare_ns.end());
    evaluate_ns.insert(evaluate_ns.end(), other.evaluate_ns.begin(), other.evaluate_ns.end());
  }
};

// The times that one scheme takes. Only the median of each segment is kept, so memory grows with the number of segments
// but not with the number of faces.
struct SchemeTimes {
  std::vector<float> prepare_ns, evaluate_ns;
};

double time_of_sample(std::size_t i, std::size_t samples) {
  return static_cast<double>(i) / static_cast<double>(samples - 1);
}

// The elements of a motion whose normals are compared: its faces, or groups of their corners.
class Elements {
 public:
  explicit Elements(const Topology& topology) : count_(topology.face_count()) {}
  Elements(const Topology& topology, NormalGroups groups, Weighting weighting, std::size_t samples)
      : groups_(std::move(groups)),
        weighting_(weighting),
        count_(groups_->size()),
        samples_(samples),
        many_corners_(std::max<std::size_t>(32, samples / 16)) {
    for (std::uint32_t f = 0; f < topology.face_count() && !topology.all_triangles(); ++f)
      if (topology.face(f).size() > many_corners_) large_.push_back(f);
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  // Returns the element of each output. Returns an empty list if elements are faces, because each element then is its
  // own output.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept {
    return groups_ ? groups_->element_of_output() : std::span<const std::uint32_t>();
  }
  [[nodiscard]] bool are_faces() const noexcept { return !groups_; }

  // Returns the number by which messages name an element: the index of its face, or the index of the first vertex or
  // corner that shows the element.
  [[nodiscard]] std::size_t first_output(std::size_t element) const {
    if (!groups_) return element;
    const auto outputs = groups_->element_of_output();
    return static_cast<std::size_t>(std::find(outputs.begin(), outputs.end(), element) - outputs.begin());
  }

  // Computes the control normals of all faces for the segments from `first` to `last`. Keeps the results, because a
  // face can belong to many groups.
  void enter(const Motion& motion, std::size_t first, std::size_t last) {
    if (!groups_ || !by_area()) return;
    of_faces_.erase(of_faces_.begin(), of_faces_.lower_bound(first));
    of_large_.erase(of_large_.begin(), of_large_.lower_bound(first));
    shared_.erase(shared_.begin(), shared_.lower_bound(first));
    for (std::size_t s = first; s <= last; ++s) {
      if (of_faces_.contains(s)) continue;
      const auto start = Clock::now();
      const Segment segment = motion.segment(s);
      shared_.try_emplace(s, segment);
      of_faces_.emplace(s, all_face_control_normals(segment));
      shared_ns_ = nanoseconds_since(start) * static_cast<double>(thread_count()) / static_cast<double>(count_);
      std::vector<ReferenceArea>& large = of_large_[s];
      large.resize(large_.size() * samples_);
      parallel_for(large.size(), [&](std::size_t i) {
        large[i] = reference_area(segment, large_[i / samples_], time_of_sample(i % samples_, samples_));
      });
    }
  }
  // Returns the time that the control normals of faces take for a segment in one thread, in nanoseconds per element.
  [[nodiscard]] double shared_ns() const noexcept { return shared_ns_; }
  // Computes the control normals of a range of elements. If the weighting is not area, the control normals are fitted
  // to the normals at t = 0, 1/2 and 1.
  void control_normals(const Segment& segment, IndexRange range, std::span<ControlNormals> result) const {
    if (!by_area()) {
      for (std::size_t i = 0; i < range.count; ++i) {
        const auto node = [&](double t) {
          return sample_normal(segment, *groups_, range.first + i, weighting_, t).with_area_length();
        };
        result[i] = quadratic_through(node(0), node(0.5), node(1));
      }
    } else if (groups_)
      group_control_normals(shared(segment), *groups_, of_faces_.find(segment.index)->second, range, result);
    else
      face_control_normals(segment, range, result);
  }
  // Returns a range of elements as a block from which schemes prepare their data. All arguments must outlive the
  // result.
  [[nodiscard]] ElementBlock block(const Segment& segment, IndexRange range,
                                   std::span<const ControlNormals> normals) const {
    ElementBlock block{&segment, range, normals, are_faces()};
    if (!by_area())
      block.exact = [this, &segment, first = range.first](std::size_t i, double t) {
        return sample_normal(segment, *groups_, first + i, weighting_, t).normal;
      };
    return block;
  }
  // Returns bounds of the errors that rounding makes in the control normals. The list is empty for faces.
  [[nodiscard]] std::vector<ControlErrors> control_errors(const Segment& segment, IndexRange range) const {
    std::vector<ControlErrors> errors;
    if (!groups_) return errors;
    const std::vector<ControlNormals>& of_faces = of_faces_.find(segment.index)->second;
    for (std::size_t i = 0; i < range.count; ++i)
      errors.push_back(settled_group_normals(shared(segment), *groups_, of_faces, range.first + i).errors);
    return errors;
  }
  // Returns the triangles of a range of faces, for exact_normals(). Returns nothing if the elements are not triangles.
  [[nodiscard]] std::optional<ReferenceTriangles> triangles(const Segment& segment, IndexRange range) const {
    if (groups_ || !segment.topology->all_triangles()) return std::nullopt;
    return ReferenceTriangles(segment, range);
  }
  // Computes the exact normals of a range of elements at a sample (an instant of a segment). The results have any
  // length.
  void exact_normals(const Segment& segment, IndexRange range, const std::optional<ReferenceTriangles>& triangles,
                     std::size_t sample, std::size_t samples, std::span<Vec3d> result) const {
    const double t = time_of_sample(sample, samples);
    if (triangles) return triangles->normals(t, result);
    if (!groups_) return reference_normals(segment, range, t, result);
    for (std::size_t i = 0; i < range.count && !by_area(); ++i)
      result[i] = sample_normal(segment, *groups_, range.first + i, weighting_, t).normal;
    if (!by_area()) return;
    std::vector<ReferenceArea> areas;
    for (std::size_t i = 0; i < range.count; ++i) {
      const auto faces = groups_->faces(range.first + i);
      areas.clear();
      for (const std::uint32_t f : faces)
        areas.push_back(segment.topology->face(f).size() > many_corners_ ? area_of_large(segment.index, f, sample)
                                                                         : reference_area(segment, f, t));
      result[i] = reference_normal(shared(segment), faces, areas, t);
    }
  }

 private:
  [[nodiscard]] const SharedFaces& shared(const Segment& segment) const { return shared_.find(segment.index)->second; }
  [[nodiscard]] const ReferenceArea& area_of_large(std::size_t segment, std::uint32_t face, std::size_t sample) const {
    const auto number = static_cast<std::size_t>(std::lower_bound(large_.begin(), large_.end(), face) - large_.begin());
    return of_large_.find(segment)->second[number * samples_ + sample];
  }
  [[nodiscard]] bool by_area() const noexcept { return weighting_ == Weighting::kArea; }

  std::optional<NormalGroups> groups_;
  Weighting weighting_ = Weighting::kArea;
  std::size_t count_;
  std::size_t samples_ = 0;  // the number of samples; set only for groups
  // The largest number of corners of a face whose normal is computed anew for each group. The normal of a larger face
  // is computed once for all groups that contain the face. These stored normals take less than 400 bytes for each
  // corner.
  std::size_t many_corners_ = 0;
  // The control normals of all faces, keyed by the segment. Only used if elements are groups.
  std::map<std::size_t, std::vector<ControlNormals>> of_faces_;
  std::vector<std::uint32_t> large_;           // for groups: faces with more than many_corners_ corners
  std::map<std::size_t, SharedFaces> shared_;  // only for groups: control normals of faces for exact sums, by segment
  // The areas of the faces in large_ at each sample, keyed by the segment.
  std::map<std::size_t, std::vector<ReferenceArea>> of_large_;
  double shared_ns_ = 0;
};

// Returns the angle in degrees between an exact and a rendered normal. Returns NaN if one of the normals has no
// direction, because Quality does not count such samples.
float error_in_degrees(const Vec3d& exact, const Vec3d& shown) {
  if (exact == Vec3d{} || shown == Vec3d{} || !is_finite(shown)) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(angle_between(unit(exact), shown) * kDegreesPerRadian);
}

// Makes a table of the errors of one scheme. of_elements has the errors of elements, (rows, elements). If several
// vertices or corners share an element, each of them gets an entry in the table.
ErrorTable table_of(const Motion& motion, const Elements& all, const CompareOptions& options, const std::string& scheme,
                    const std::vector<float>& of_elements) {
  ErrorTable table{scheme, options.elements.kind, motion.topology, motion.keyframes[0].positions};
  const auto outputs = all.element_of_output();
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const double start_time = motion.keyframes[motion.segments[s].from].time;
    const double end_time = motion.keyframes[motion.segments[s].to].time;
    const bool is_weight = motion.kind == MotionKind::kTargets;
    for (std::size_t i = 0; i < options.samples; ++i) {
      check_interruption();
      const double t = time_of_sample(i, options.samples);
      const double at = is_weight ? t : (1 - t) * start_time + t * end_time;
      const std::span<float> row = add_row(table, s, is_weight, at);
      const float* const errors = of_elements.data() + (s * options.samples + i) * all.count();
      for (std::size_t o = 0; o < row.size(); ++o) row[o] = errors[outputs.empty() ? o : outputs[o]];
    }
  }
  return table;
}

// Returns a certified bound of the largest error of a scheme that has been prepared for a block.
CertifiedError certified_error(const Scheme& scheme, const ElementBlock& block, std::span<const ControlErrors> errors) {
  CertifyOptions options;
  options.only_worst = true;
  std::vector<ErrorBounds> bounds(block.elements.count);
  certify(scheme, block, bounds, options, errors);
  CertifiedError all;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const auto& [lower, upper, at, from, to] = bounds[i];
    add(all,
        {lower, upper, block.segment->index, block.elements.first + i, from, to, upper < std::numbers::pi ? 0U : 1U});
  }
  return all;
}

std::uint32_t checksum_of_options(const CompareOptions& options, const std::vector<std::string>& names) {
  NumberChecksum sum;
  for (const std::string& name : names) sum.add(name);
  sum.add(std::uint64_t{options.samples});
  for (const std::uint64_t number :
       {static_cast<std::uint64_t>(options.access), static_cast<std::uint64_t>(options.elements.kind),
        std::uint64_t{options.certify}, std::uint64_t{options.tolerance.has_value()}})
    sum.add(number);
  sum.add(options.tolerance.value_or(0));
  if (options.weighting != Weighting::kArea) sum.add(static_cast<std::uint64_t>(options.weighting));
  return sum.value();
}

// Prepares every scheme on one block of elements, evaluates it at every sample, and compares its normals with the exact
// normals. If `each` is not empty, writes the errors of each scheme to the array of this scheme in `each`.
std::vector<Tally> compare_block(const Segment& segment, const Elements& all, IndexRange range,
                                 const std::vector<std::string>& names, const CompareOptions& options,
                                 std::span<std::vector<float>> each) {
  const std::size_t samples = options.samples;
  std::vector<ControlNormals> control_normals(range.count);
  const auto control_start = Clock::now();
  all.control_normals(segment, range, control_normals);
  const double control_ns = nanoseconds_since(control_start) + all.shared_ns() * static_cast<double>(range.count);

  const double elements = static_cast<double>(range.count);
  std::vector<std::unique_ptr<Scheme>> schemes;
  std::vector<Tally> tallies(names.size());
  const ElementBlock block = all.block(segment, range, control_normals);
  for (std::size_t s = 0; s < names.size(); ++s) {
    schemes.push_back(make_scheme(names[s]).value());
    Scheme& scheme = *schemes[s];
    const auto start = Clock::now();
    scheme.prepare(block);
    const double prepare_ns = nanoseconds_since(start) + (scheme.uses_control_normals() ? control_ns : 0);
    tallies[s].prepare_ns.push_back(static_cast<float>(prepare_ns / elements));
    tallies[s].fallbacks = scheme.fallback_count();
    tallies[s].flagged = scheme.flagged_count();
    tallies[s].bytes = static_cast<double>(scheme.bytes());
  }
  if (options.certify || options.tolerance) {
    const std::vector<ControlErrors> errors = all.control_errors(segment, range);
    for (std::size_t s = 0; s < names.size(); ++s) tallies[s].certified = certified_error(*schemes[s], block, errors);
  }

  const std::optional<ReferenceTriangles> triangles = all.triangles(segment, range);
  std::vector<Vec3d> exact(range.count);
  std::vector<float> planes(3 * range.count);
  float* const first = planes.data();
  const auto result = VectorView<float>::planes(first, first + range.count, first + 2 * range.count, range.count);
  std::vector<std::unique_ptr<SchemePlayback>> playbacks(schemes.size());
  if (options.access == Access::kSequential) {
    const double step = time_of_sample(1, samples);
    for (std::size_t s = 0; s < schemes.size(); ++s) playbacks[s] = schemes[s]->play(0, step, kDefaultAnchorInterval);
  }
  std::vector<double> evaluate_ns(schemes.size(), 0);
  for (std::size_t i = 0; i < samples; ++i) {
    check_interruption();
    const double t = time_of_sample(i, samples);
    all.exact_normals(segment, range, triangles, i, samples, exact);
    for (std::size_t s = 0; s < schemes.size(); ++s) {
      const auto start = Clock::now();
      if (playbacks[s])
        playbacks[s]->next(result);
      else
        schemes[s]->evaluate(t, result);
      evaluate_ns[s] += nanoseconds_since(start);
      tallies[s].quality.add(exact, result, {segment.index, range.first, t});
      if (options.keep_samples) tallies[s].samples.emplace_back().add(exact, result, {segment.index, range.first, t});
      if (s < each.size()) {
        float* const row = each[s].data() + (segment.index * samples + i) * all.count() + range.first;
        for (std::size_t e = 0; e < range.count; ++e) row[e] = error_in_degrees(exact[e], to_double(result[e]));
      }
    }
  }
  for (std::size_t s = 0; s < schemes.size(); ++s)
    tallies[s].evaluate_ns.push_back(static_cast<float>(evaluate_ns[s] / elements / static_cast<double>(samples)));
  return tallies;
}

// Checks that the options can be used together.
Status check(const CompareOptions& options) {
  const auto misuse = [](const char* why) { return Status(Error{ErrorCode::kUsage, "", why}); };
  const bool certified = options.certify || options.tolerance, by_area = options.weighting == Weighting::kArea;
  if (options.samples < 2) return misuse("the number of samples must be at least 2");
  if (options.tolerance && !(*options.tolerance >= 0 && std::isfinite(*options.tolerance)))
    return misuse("the tolerance must be an angle in degrees, at least 0");
  if (certified && options.access == Access::kSequential)
    return misuse("bounds can only be computed for random access, not for sequential access; choose random access");
  if (!by_area && options.elements.kind == ElementKind::kFaces)
    return misuse("a weighting has no meaning for normals of faces; choose vertices or corners");
  if (!by_area && certified)
    return misuse("bounds can only be computed for normals weighted by area; choose this weighting");
  return Success{};
}

// Makes a row without results for each scheme that the options name.
Result<std::vector<SchemeComparison>> rows_of(const CompareOptions& options) {
  const ElementKind kind = options.elements.kind;
  std::vector<SchemeComparison> rows;
  for (const std::string& name : options.schemes.empty() ? default_schemes(kind) : options.schemes) {
    const auto scheme = scheme_for(name, kind);
    if (!scheme) return scheme.error();
    const auto sequential = scheme.value()->sequential_operations();
    SchemeComparison& row = rows.emplace_back();
    row.scheme = name;
    row.sequential = options.access == Access::kSequential && sequential.has_value();
    row.operations = row.sequential ? *sequential : scheme.value()->operations();
  }
  return rows;
}

// Makes a comparison that says what was compared, and has no rows yet. `elements` is the number of compared elements.
Comparison without_results(const Motion& motion, const CompareOptions& options, std::size_t elements) {
  Comparison comparison{options.elements.kind,
                        motion.topology.vertex_count(),
                        motion.topology.face_count(),
                        elements,
                        motion.segments.size(),
                        options.samples,
                        {},
                        motion.kind};
  comparison.weighting = options.weighting;
  comparison.span = {motion.keyframes.front().time, motion.keyframes.back().time};
  comparison.tolerance = options.tolerance;
  return comparison;
}

Result<Elements> elements_of(MotionStream& stream, const CompareOptions& options) {
  const Topology& topology = stream.motion().topology;
  if (options.elements.kind == ElementKind::kFaces) return Elements(topology);
  Result<NormalGroups> groups = make_groups(stream, options.elements);
  if (!groups) return groups.error();
  return Elements(topology, std::move(groups).value(), options.weighting, options.samples);
}

}  // namespace

std::vector<std::string> default_schemes(ElementKind kind) {
  std::vector<std::string> names = {"linear",
                                    "quadratic",
                                    "cubic",
                                    "polynomial",
                                    "slerp",
                                    "decasteljau:4",
                                    "quaternion:matrix",
                                    "quaternion:optimal",
                                    "circle:timed"};
  if (kind != ElementKind::kFaces)
    std::erase_if(names, [](const std::string& name) { return make_scheme(name).value()->needs_faces(); });
  return names;
}

Result<Comparison> compare(const Motion& motion, const CompareOptions& options) {
  MotionStream stream(motion);
  return compare(stream, options);
}

Result<Comparison> compare(MotionStream& stream, const CompareOptions& options) {
  CompareRun run;
  run.progress = options.progress;
  return compare(stream, options, run);
}

Result<Comparison> internal::compare(MotionStream& stream, const CompareOptions& options, CompareRun& run) {
  const Motion& motion = stream.motion();
  if (const Status status = check(options); !status) return status.error();
  const ElementKind kind = options.elements.kind;
  const bool certified = options.certify || options.tolerance;
  Result<std::vector<SchemeComparison>> made = rows_of(options);
  if (!made) return made.error();
  std::vector<SchemeComparison> rows = std::move(made).value();
  // Adds `linear` to the computed schemes even if no row shows it, because results show the errors of all schemes
  // relative to those of `linear`.
  std::vector<std::string> names;
  for (const SchemeComparison& row : rows) names.push_back(row.scheme);
  if (std::find(names.begin(), names.end(), "linear") == names.end()) names.emplace_back("linear");

  KeyframeChecksums seen(stream);
  if (const Status status = run.shard ? seen.begin() : Success{}; !status) return status.error();
  Result<Elements> elements = elements_of(stream, options);
  if (!elements) return elements.error();
  Elements& all = elements.value();
  // The errors of every scheme in `rows`, for all elements at all samples.
  std::vector<std::vector<float>> each;
  if (options.keep_errors) {
    const std::size_t samples = motion.segments.size() * options.samples;
    ErrorTable room{names[0], kind, motion.topology, {}};
    if (const Status status = reserve_rows(room, samples * rows.size(), run.expansion); !status) return status.error();
    each.assign(rows.size(), std::vector<float>(samples * all.count()));
  }
  if (run.is_divided() && (options.keep_errors || options.keep_samples))
    return Error{ErrorCode::kUsage, "",
                 "a run with --shard or --resume cannot keep the error of every sample; leave one of the two out"};
  if (options.keep_samples)
    for (SchemeComparison& row : rows) row.samples.resize(motion.segments.size() * options.samples);
  std::vector<SchemeTally> totals(names.size());
  std::vector<SchemeTimes> times(names.size());
  const auto add_segment = [&](const ComparedSegment& found) {
    for (std::size_t s = 0; s < names.size(); ++s) add(totals[s], found.schemes[s]);
  };
  const std::size_t blocks = block_count(all.count(), kBlockSize), at_once = kBlocksPerWaveAndThread * thread_count();
  const Status begun = run.begin(
      motion.segments.size(), blocks, "comparison",
      [&](const ComparedSegment& known) { return known.schemes.size() == names.size(); }, add_segment);
  if (!begun) return begun.error();
  std::vector<std::vector<Tally>> wave(at_once);
  std::vector<Tally> of_segment(names.size());
  // The results of blocks are added in order, segment by segment, so that sums do not depend on threads.
  const auto add_block = [&](std::size_t segment, const std::vector<Tally>& of_block) {
    for (std::size_t s = 0; s < names.size(); ++s) {
      of_segment[s].add(of_block[s]);
      for (std::size_t k = 0; s < rows.size() && k < of_block[s].samples.size(); ++k)
        rows[s].samples[segment * options.samples + k].add(of_block[s].samples[k]);
    }
  };
  const auto end_segment = [&](std::size_t segment) {
    ComparedSegment done{segment, {}};
    for (std::size_t s = 0; s < names.size(); ++s) {
      Tally& found = of_segment[s];
      found.quality.max_at.element = all.first_output(found.quality.max_at.element);
      found.certified.element = all.first_output(found.certified.element);
      times[s].prepare_ns.push_back(static_cast<float>(median(std::move(found.prepare_ns))));
      times[s].evaluate_ns.push_back(static_cast<float>(median(std::move(found.evaluate_ns))));
      done.schemes.push_back(found);
      found = {};
    }
    return run.take(std::move(done), add_segment);
  };
  const Status compared = run.over(
      stream, segment_keys(motion), run.rest(), std::max<std::size_t>(at_once / blocks, 1), [&](IndexRange segments) {
        all.enter(motion, segments.first, segments.end() - 1);
        // Computes several small segments together, and a large segment in several waves.
        const std::size_t wanted = segments.count * blocks;
        for (std::size_t first = 0; first < wanted; first += at_once) {
          const std::size_t count = std::min(at_once, wanted - first);
          parallel_for(count, [&](std::size_t i) {
            const Segment segment = motion.segment(segments.first + (first + i) / blocks);
            const std::size_t first_element = (first + i) % blocks * kBlockSize;
            const IndexRange range{first_element, std::min(kBlockSize, all.count() - first_element)};
            wave[i] = compare_block(segment, all, range, names, options, each);
          });
          for (std::size_t i = 0; i < count; ++i) {
            const std::size_t segment = segments.first + (first + i) / blocks;
            add_block(segment, wave[i]);
            if ((first + i + 1) % blocks != 0) continue;
            if (Status kept = end_segment(segment); !kept) return kept;
          }
          if (first + count < wanted) run.tell(0, first + count);
        }
        return Status(Success{});
      });
  if (!compared) return compared.error();

  Comparison comparison = without_results(motion, options, all.count());
  comparison.schemes = std::move(rows);
  for (std::size_t s = 0; s < comparison.schemes.size(); ++s) {
    SchemeComparison& row = comparison.schemes[s];
    row.prepare_ns = median(times[s].prepare_ns);
    row.evaluate_ns = median(times[s].evaluate_ns);
    if (s >= each.size()) continue;
    if (const Status status = stream.hold(0, 0); !status) return status.error();
    comparison.errors.push_back(table_of(motion, all, options, each.size() > 1 ? row.scheme : "", each[s]));
    each[s] = {};
  }
  if (run.shard) {
    NumberChecksum sharing;
    sharing.add(all.element_of_output());
    run.checksums["the options"] = checksum_of_options(options, names);
    run.checksums["the hard edges"] = sharing.value();
    const Status status = seen.finish(keyframes_of_shard(motion, *run.shard), run.checksums);
    if (!status) return status.error();
  }
  conclude(totals, run.share().count, certified, comparison);
  return comparison;
}

}  // namespace chronormal
