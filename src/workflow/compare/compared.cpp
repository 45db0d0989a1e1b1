// Adds up the results of blocks and segments, joins shards, and chooses the cheapest scheme within a tolerance.
#include "workflow/compare/compared.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace chronormal {
namespace {

// The average error of `linear`, in radians, below which this error is only rounding error. The errors of other schemes
// are then not divided by the error of `linear`.
constexpr double kNoError = 1e-6;  // radians

// Returns the cheapest scheme whose error is within `degrees`. Leaves out a scheme for which no normal could be
// compared.
std::optional<std::size_t> cheapest_within(const std::vector<SchemeComparison>& schemes, double degrees) {
  std::optional<std::size_t> cheapest;
  for (std::size_t s = 0; s < schemes.size(); ++s) {
    if (schemes[s].quality.count == 0 || schemes[s].certified->upper * kDegreesPerRadian > degrees) continue;
    if (!cheapest || evaluation_cost(schemes[s]) < evaluation_cost(schemes[*cheapest])) cheapest = s;
  }
  return cheapest;
}

// Returns true if two shards may belong to one comparison: they have the same elements, samples and schemes.
bool are_of_one(const Comparison& a, const Comparison& b) {
  const auto same_scheme = [](const SchemeComparison& one, const SchemeComparison& other) {
    return one.scheme == other.scheme && one.sequential == other.sequential &&
           one.certified.has_value() == other.certified.has_value();
  };
  return a.kind == b.kind && a.vertices == b.vertices && a.faces == b.faces && a.elements == b.elements &&
         a.segments == b.segments && a.samples == b.samples && a.motion == b.motion && a.weighting == b.weighting &&
         a.tolerance == b.tolerance && a.span == b.span &&
         std::equal(a.schemes.begin(), a.schemes.end(), b.schemes.begin(), b.schemes.end(), same_scheme);
}

}  // namespace

void internal::add(CertifiedError& all, const CertifiedError& other) {
  all.lower = std::max(all.lower, other.lower);
  all.unbounded += other.unbounded;
  if (!(other.upper > all.upper)) return;
  all.upper = other.upper;
  all.segment = other.segment;
  all.element = other.element;
  all.from = other.from;
  all.to = other.to;
}

void internal::add(SchemeTally& all, const SchemeTally& other) {
  all.quality.add(other.quality);
  add(all.certified, other.certified);
  all.fallbacks += other.fallbacks;
  all.flagged += other.flagged;
  all.bytes += other.bytes;
}

void internal::conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified,
                        Comparison& comparison) {
  std::vector<SchemeComparison>& rows = comparison.schemes;
  const auto linear_row =
      std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.scheme == "linear"; });
  const Quality& linear = totals[static_cast<std::size_t>(linear_row - rows.begin())].quality;
  const double elements = static_cast<double>(comparison.elements * segments);
  for (std::size_t s = 0; s < rows.size(); ++s) {
    const SchemeTally& total = totals[s];
    SchemeComparison& row = rows[s];
    row.quality = total.quality;
    row.relative_to_linear = {};
    if (linear.mean() > kNoError) row.relative_to_linear = total.quality.sum / linear.sum;
    row.fallbacks = total.fallbacks;
    row.flagged = total.flagged;
    row.bytes = total.bytes / elements;
    if (certified) row.certified = total.certified;
  }
  if (comparison.tolerance) comparison.cheapest = cheapest_within(rows, *comparison.tolerance);
}

Result<Comparison> internal::merge(std::vector<ComparisonShard> shards) {
  const auto compared = join(shards, shards.front().whole.segments, are_of_one, "comparisons");
  if (!compared) return compared.error();
  Comparison all = std::move(shards.front().whole);
  std::vector<SchemeTally> totals(compared.value().front().schemes.size());
  for (const ComparedSegment& segment : compared.value()) {
    for (std::size_t i = 0; i < totals.size(); ++i) add(totals[i], segment.schemes[i]);
  }
  const bool certified = all.schemes.front().certified.has_value();
  for (SchemeComparison& row : all.schemes) row.prepare_ns = row.evaluate_ns = 0;
  conclude(totals, all.segments, certified, all);
  return all;
}

double evaluation_cost(const SchemeComparison& scheme) noexcept {
  const OperationCounts& o = scheme.operations;
  return scheme.bytes + o.add + o.multiply + 4 * (o.divide + o.sqrt) + 20 * o.trigonometric;
}

Result<Choice> choose(const Motion& motion, double tolerance, CompareOptions options) {
  const bool are_faces = options.elements.kind == ElementKind::kFaces;
  if (options.schemes.empty()) {
    for (const SchemeDescription& description : scheme_descriptions()) {
      const auto scheme = make_scheme(description.name);
      if (scheme && (are_faces || !scheme.value()->needs_faces())) options.schemes.emplace_back(description.name);
    }
  }
  options.tolerance = tolerance;
  options.samples = 2;
  Result<Comparison> comparison = compare(motion, options);
  if (!comparison) return comparison.error();
  Choice choice{std::nullopt, std::move(comparison).value()};
  if (choice.comparison.cheapest) choice.scheme = choice.comparison.schemes[*choice.comparison.cheapest].scheme;
  return choice;
}

}  // namespace chronormal
