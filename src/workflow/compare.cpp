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
constexpr std::size_t kBlocksPerWaveAndThread = 4;

// Below this mean, the error of linear is its rounding, and no measure for others.
constexpr double kNoError = 1e-6;  // radians

using Clock = std::chrono::steady_clock;

double nanoseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

// What one scheme did on one block, or on all blocks so far.
struct Tally {
  Quality quality;
  std::size_t fallbacks = 0, flagged = 0;
  double bytes = 0;
  std::vector<float> prepare_ns, evaluate_ns;  // per element, a value per block

  void add(const Tally& other) {
    quality.add(other.quality);
    fallbacks += other.fallbacks;
    flagged += other.flagged;
    bytes += other.bytes;
    prepare_ns.insert(prepare_ns.end(), other.prepare_ns.begin(), other.prepare_ns.end());
    evaluate_ns.insert(evaluate_ns.end(), other.evaluate_ns.begin(), other.evaluate_ns.end());
  }
};

// The median, which a thread that was interrupted does not move.
double median(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double time_of_sample(std::size_t i, std::size_t samples) {
  return static_cast<double>(i) / static_cast<double>(samples - 1);
}

// Prepares every scheme on one block of faces, evaluates it at every sample, and holds it against the exact normals.
std::vector<Tally> compare_block(const Segment& segment, IndexRange faces, const std::vector<std::string>& names,
                                 std::size_t samples, Access access) {
  std::vector<ControlNormals> control_normals(faces.count);
  const auto control_start = Clock::now();
  face_control_normals(segment, faces, control_normals);
  const double control_ns = nanoseconds_since(control_start);

  const double elements = static_cast<double>(faces.count);
  std::vector<std::unique_ptr<Scheme>> schemes;
  std::vector<Tally> tallies(names.size());
  for (std::size_t s = 0; s < names.size(); ++s) {
    schemes.push_back(make_scheme(names[s]).value());
    Scheme& scheme = *schemes[s];
    const auto start = Clock::now();
    scheme.prepare({&segment, faces, control_normals});
    const double prepare_ns = nanoseconds_since(start) + (scheme.uses_control_normals() ? control_ns : 0);
    tallies[s].prepare_ns.push_back(static_cast<float>(prepare_ns / elements));
    tallies[s].fallbacks = scheme.fallback_count();
    tallies[s].flagged = scheme.flagged_count();
    tallies[s].bytes = static_cast<double>(scheme.bytes());
  }

  std::vector<Vec3d> exact(faces.count);
  std::vector<float> planes(3 * faces.count);
  float* const first = planes.data();
  const auto result = VectorView<float>::planes(first, first + faces.count, first + 2 * faces.count, faces.count);
  std::vector<std::unique_ptr<Playback>> playbacks(schemes.size());
  if (access == Access::kSequential) {
    const double step = time_of_sample(1, samples);
    for (std::size_t s = 0; s < schemes.size(); ++s) playbacks[s] = schemes[s]->play(0, step, kDefaultAnchorInterval);
  }
  std::vector<double> evaluate_ns(schemes.size(), 0);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = time_of_sample(i, samples);
    reference_normals(segment, faces, t, exact);
    for (std::size_t s = 0; s < schemes.size(); ++s) {
      const auto start = Clock::now();
      if (playbacks[s])
        playbacks[s]->next(result);
      else
        schemes[s]->evaluate(t, result);
      evaluate_ns[s] += nanoseconds_since(start);
      tallies[s].quality.add(exact, result, {segment.index, faces.first, t});
    }
  }
  for (std::size_t s = 0; s < schemes.size(); ++s)
    tallies[s].evaluate_ns.push_back(static_cast<float>(evaluate_ns[s] / elements / static_cast<double>(samples)));
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
  std::vector<SchemeComparison> rows;
  for (const std::string& name : names) {
    auto scheme = make_scheme(name);
    if (!scheme) return scheme.error();
    const auto sequential = scheme.value()->sequential_operations();
    SchemeComparison row;
    row.scheme = name;
    row.sequential = options.access == Access::kSequential && sequential.has_value();
    row.operations = row.sequential ? *sequential : scheme.value()->operations();
    rows.push_back(std::move(row));
  }
  std::size_t linear = static_cast<std::size_t>(std::find(names.begin(), names.end(), "linear") - names.begin());
  if (linear == names.size()) names.emplace_back("linear");

  const std::size_t faces = motion.topology.face_count();
  const std::size_t blocks_per_segment = (faces + kBlockSize - 1) / kBlockSize;
  const std::size_t blocks = blocks_per_segment * motion.segments.size();
  std::vector<Tally> totals(names.size());
  const std::size_t blocks_per_wave = kBlocksPerWaveAndThread * thread_count();
  std::vector<std::vector<Tally>> wave(std::min(blocks, blocks_per_wave));
  for (std::size_t first = 0; first < blocks; first += blocks_per_wave) {
    const std::size_t count = std::min(blocks_per_wave, blocks - first);
    parallel_for(count, [&](std::size_t i) {
      const Segment segment = motion.segment((first + i) / blocks_per_segment);
      const std::size_t first_face = (first + i) % blocks_per_segment * kBlockSize;
      const IndexRange range{first_face, std::min(kBlockSize, faces - first_face)};
      wave[i] = compare_block(segment, range, names, options.samples, options.access);
    });
    // In order, so that sums do not depend on the threads.
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t s = 0; s < names.size(); ++s) totals[s].add(wave[i][s]);
    }
    if (options.progress) options.progress(first + count, blocks);
  }

  Comparison comparison{motion.topology.vertex_count(), faces, motion.segments.size(), options.samples, {}};
  const double elements = static_cast<double>(faces * motion.segments.size());
  const Quality& linear_quality = totals[linear].quality;
  for (std::size_t s = 0; s < options.schemes.size(); ++s) {
    const Tally& total = totals[s];
    SchemeComparison& row = rows[s];
    row.quality = total.quality;
    if (linear_quality.mean() > kNoError) row.relative_to_linear = total.quality.sum / linear_quality.sum;
    row.fallbacks = total.fallbacks;
    row.flagged = total.flagged;
    row.prepare_ns = median(total.prepare_ns);
    row.evaluate_ns = median(total.evaluate_ns);
    row.bytes = total.bytes / elements;
    comparison.schemes.push_back(std::move(row));
  }
  return comparison;
}

}  // namespace chronormal
