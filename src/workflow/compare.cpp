#include "chronormal/workflow/compare.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "chronormal/analysis/reference_normals.h"
#include "chronormal/core/parallel.h"

namespace chronormal {
namespace {

// A block of the widest scheme stays in the second-level cache; a wave keeps partial results few and progress smooth.
constexpr std::size_t kBlockSize = 1024;
constexpr std::size_t kBlocksPerWave = 64;

using Clock = std::chrono::steady_clock;

double nanoseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

// What one scheme did on one block, or on all blocks so far.
struct Tally {
  Quality quality;
  std::size_t fallbacks = 0, flagged = 0;
  double prepare_ns = 0, evaluate_ns = 0, bytes = 0;

  void add(const Tally& other) {
    quality.add(other.quality);
    fallbacks += other.fallbacks;
    flagged += other.flagged;
    prepare_ns += other.prepare_ns;
    evaluate_ns += other.evaluate_ns;
    bytes += other.bytes;
  }
};

double time_of_sample(std::size_t i, std::size_t samples) {
  return static_cast<double>(i) / static_cast<double>(samples - 1);
}

// Prepares every scheme on one block of faces, evaluates it at every sample, and holds it against the exact normals.
std::vector<Tally> compare_block(const Segment& segment, IndexRange faces, const std::vector<std::string>& names,
                                 std::size_t samples) {
  std::vector<ControlNormals> control_normals(faces.count);
  const auto control_start = Clock::now();
  face_control_normals(segment, faces, control_normals);
  const double control_ns = nanoseconds_since(control_start);

  std::vector<std::unique_ptr<Scheme>> schemes;
  std::vector<Tally> tallies(names.size());
  for (std::size_t s = 0; s < names.size(); ++s) {
    schemes.push_back(make_scheme(names[s]).value());
    Scheme& scheme = *schemes[s];
    const auto start = Clock::now();
    scheme.prepare({&segment, faces, control_normals});
    tallies[s].prepare_ns = nanoseconds_since(start) + (scheme.uses_control_normals() ? control_ns : 0);
    tallies[s].fallbacks = scheme.fallback_count();
    tallies[s].flagged = scheme.flagged_count();
    tallies[s].bytes = static_cast<double>(scheme.bytes());
  }

  std::vector<Vec3d> exact(faces.count);
  std::vector<float> planes(3 * faces.count);
  float* const first = planes.data();
  const auto result = VectorView<float>::planes(first, first + faces.count, first + 2 * faces.count, faces.count);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = time_of_sample(i, samples);
    reference_normals(segment, faces, t, exact);
    for (std::size_t s = 0; s < schemes.size(); ++s) {
      const auto start = Clock::now();
      schemes[s]->evaluate(t, result);
      tallies[s].evaluate_ns += nanoseconds_since(start);
      tallies[s].quality.add(exact, result, {segment.index, faces.first, t});
    }
  }
  return tallies;
}

}  // namespace

std::vector<std::string> default_schemes() {
  return {"linear",
          "quadratic",
          "cubic",
          "polynomial",
          "slerp",
          "decasteljau:4",
          "quaternion:matrix",
          "quaternion:optimal",
          "circle:timed"};
}

Result<Comparison> compare(const Motion& motion, const CompareOptions& options) {
  if (options.samples < 2) return Error{ErrorCode::kUsage, "", "it takes 2 samples or more, the ends of a segment"};
  if (options.schemes.empty()) return Error{ErrorCode::kUsage, "", "there is no scheme to compare"};

  // Linear is the measure of the others, so it takes part even where it is not a row.
  std::vector<std::string> names = options.schemes;
  std::vector<OperationCounts> operations;
  for (const std::string& name : names) {
    auto scheme = make_scheme(name);
    if (!scheme) return scheme.error();
    operations.push_back(scheme.value()->operations());
  }
  std::size_t linear = static_cast<std::size_t>(std::find(names.begin(), names.end(), "linear") - names.begin());
  if (linear == names.size()) names.emplace_back("linear");

  const std::size_t faces = motion.topology.face_count();
  const std::size_t blocks_per_segment = (faces + kBlockSize - 1) / kBlockSize;
  const std::size_t blocks = blocks_per_segment * motion.segments.size();
  std::vector<Tally> totals(names.size());
  std::vector<std::vector<Tally>> wave(std::min(blocks, kBlocksPerWave));
  for (std::size_t first = 0; first < blocks; first += kBlocksPerWave) {
    const std::size_t count = std::min(kBlocksPerWave, blocks - first);
    parallel_for(count, [&](std::size_t i) {
      const Segment segment = motion.segment((first + i) / blocks_per_segment);
      const std::size_t first_face = (first + i) % blocks_per_segment * kBlockSize;
      const IndexRange range{first_face, std::min(kBlockSize, faces - first_face)};
      wave[i] = compare_block(segment, range, names, options.samples);
    });
    // In order, so that sums do not depend on the threads.
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t s = 0; s < names.size(); ++s) totals[s].add(wave[i][s]);
    }
    if (options.progress) options.progress(first + count, blocks);
  }

  Comparison comparison{motion.topology.vertex_count(), faces, motion.segments.size(), options.samples, {}};
  const double elements = static_cast<double>(faces * motion.segments.size());
  const double linear_sum = totals[linear].quality.sum;
  for (std::size_t s = 0; s < options.schemes.size(); ++s) {
    const Tally& total = totals[s];
    SchemeComparison row;
    row.scheme = names[s];
    row.quality = total.quality;
    if (linear_sum > 0) row.relative_to_linear = total.quality.sum / linear_sum;
    row.fallbacks = total.fallbacks;
    row.flagged = total.flagged;
    row.prepare_ns = total.prepare_ns / elements;
    row.evaluate_ns = total.evaluate_ns / elements / static_cast<double>(options.samples);
    row.bytes = total.bytes / elements;
    row.operations = operations[s];
    comparison.schemes.push_back(std::move(row));
  }
  return comparison;
}

}  // namespace chronormal
