// Writes and reads parts, the results of shards, as JSON. A struct becomes a list of its members in their order. Sums
// keep their bits, because the shortest text of a double is read back as the same double.
#include "workflow/json/parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "chronormal/schemes/scheme.h"
#include "io/bytes/checksum.h"
#include "io/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {
namespace {

constexpr double kMostCount = 9007199254740992;  // a double holds every integer up to this number

// A reader that returns the numbers of a JSON list one after the other.
class Numbers {
 public:
  explicit Numbers(JsonView list) : list_(std::move(list)) {}

  double real() {
    if (next_ >= list_.size()) {
      list_.complain("the list is too short; make this shard again");
      return 0;
    }
    return list_.item(next_++).as_number();
  }
  std::size_t count() {
    const double value = real();
    if (value >= 0 && value <= kMostCount && value == std::floor(value)) return static_cast<std::size_t>(value);
    list_.complain("number " + std::to_string(next_ - 1) +
                   " of the list must be a whole number of at least 0; make this shard again");
    return 0;
  }
  [[nodiscard]] bool at_end() const { return next_ >= list_.size(); }

 private:
  JsonView list_;
  std::size_t next_ = 0;
};

Json tally_json(const SchemeTally& tally) {
  const Quality& q = tally.quality;
  const CertifiedError& c = tally.certified;
  return {q.sum,         q.sum_of_squares, q.max,        q.max_at.segment, q.max_at.element,
          q.max_at.t,    q.count,          q.degenerate, q.missing,        tally.fallbacks,
          tally.flagged, tally.bytes,      c.lower,      c.upper,          c.segment,
          c.element,     c.from,           c.to,         c.unbounded};
}

SchemeTally read_tally(Numbers numbers) {
  SchemeTally tally;
  Quality& q = tally.quality;
  CertifiedError& c = tally.certified;
  for (double* const value : {&q.sum, &q.sum_of_squares, &q.max}) *value = numbers.real();
  for (std::size_t* const value : {&q.max_at.segment, &q.max_at.element}) *value = numbers.count();
  q.max_at.t = numbers.real();
  for (std::size_t* const value : {&q.count, &q.degenerate, &q.missing, &tally.fallbacks, &tally.flagged})
    *value = numbers.count();
  for (double* const value : {&tally.bytes, &c.lower, &c.upper}) *value = numbers.real();
  for (std::size_t* const value : {&c.segment, &c.element}) *value = numbers.count();
  for (double* const value : {&c.from, &c.to}) *value = numbers.real();
  c.unbounded = numbers.count();
  return tally;
}

// Writes the sums and counts of a MotionError. Most bins of the fine histogram are empty, so only the other bins are
// written, each as its index and its count.
Json error_json(const MotionError& error) {
  Json json = {error.judged,
               error.sum,
               error.sum_of_squares,
               error.worst,
               error.worst_at.vertex,
               error.worst_at.segment,
               error.worst_at.at,
               error.no_normal,
               error.unlit,
               error.unlit_at.vertex,
               error.unlit_at.segment,
               error.unlit_at.at,
               error.faint,
               error.faint_worst,
               error.faint_at.vertex,
               error.faint_at.segment,
               error.faint_at.at,
               error.cancelled,
               error.cancelled_at.vertex,
               error.cancelled_at.segment,
               error.cancelled_at.at};
  for (const std::size_t count : error.histogram) json.push_back(count);
  for (const FineBins::Bin& bin : error.counts.filled()) {
    json.push_back(bin.number());
    json.push_back(bin.count());
  }
  return json;
}

MotionError read_error(const JsonView& list) {
  Numbers numbers(list);
  MotionError error;
  error.judged = numbers.count();
  for (double* const value : {&error.sum, &error.sum_of_squares, &error.worst}) *value = numbers.real();
  const auto read_place = [&numbers](AuditPlace& place) {
    place.vertex = numbers.count();
    place.segment = numbers.count();
    place.at = numbers.real();
  };
  read_place(error.worst_at);
  error.no_normal = numbers.count();
  error.unlit = numbers.count();
  read_place(error.unlit_at);
  error.faint = numbers.count();
  error.faint_worst = numbers.real();
  read_place(error.faint_at);
  error.cancelled = numbers.count();
  read_place(error.cancelled_at);
  for (std::size_t& count : error.histogram) count = numbers.count();
  while (!numbers.at_end()) {
    const std::size_t bin = numbers.count(), count = numbers.count();
    if (bin >= kAuditFineBins)
      list.complain("the list has an unknown bin of errors, " + std::to_string(bin) + "; make this shard again");
    else if (count > FineBins::kMostCount - error.counts[bin])
      list.complain("bin " + std::to_string(bin) + " has a count that is too large; make this shard again");
    else
      error.counts.add(bin, count);
  }
  return error;
}

Json authored_offset_json(const AuthoredOffset& offset) {
  return {static_cast<int>(offset.weighting),
          offset.is_detected ? 1 : 0,
          offset.vertices,
          offset.sum,
          offset.worst,
          offset.worst_at.vertex,
          offset.area_mean,
          static_cast<int>(offset.closest),
          offset.closest_mean,
          offset.closest_worst};
}

Weighting read_weighting(std::size_t number, const JsonView& view) {
  if (number < kAllWeightings.size()) return static_cast<Weighting>(number);
  view.complain("the list has an unknown weighting, " + std::to_string(number) + "; make this shard again");
  return Weighting::kArea;
}

AuthoredOffset read_offset(const JsonView& list) {
  Numbers numbers(list);
  AuthoredOffset offset;
  offset.weighting = read_weighting(numbers.count(), list);
  offset.is_detected = numbers.count() != 0;
  offset.vertices = numbers.count();
  offset.sum = numbers.real();
  offset.worst = numbers.real();
  offset.worst_at.vertex = numbers.count();
  offset.area_mean = numbers.real();
  offset.closest = read_weighting(numbers.count(), list);
  offset.closest_mean = numbers.real();
  offset.closest_worst = numbers.real();
  return offset;
}

Json part_json(const char* command, const std::string& input, std::optional<double> tolerance,
               const TaskChecksums& checksums) {
  Json json = {{"chronormal_part", kPartVersion}, {"command", command}, {"input", input}, {"checksums", checksums}};
  if (tolerance) json["tolerance_degrees"] = {*tolerance};
  return json;
}

std::optional<double> read_tolerance(const JsonView& part) {
  if (!part.has("tolerance_degrees")) return std::nullopt;
  const std::optional<JsonView> list = part.array("tolerance_degrees");
  return list ? std::optional(Numbers(*list).real()) : std::nullopt;
}

std::array<double, 2> read_span(const JsonView& part) {
  const std::optional<JsonView> list = part.array("span");
  if (!list) return {};
  Numbers numbers(*list);
  const double first = numbers.real();
  return {first, numbers.real()};
}

// Writes how the curved paths of vertices were cut into straight pieces, as fields of a part (the file of a shard).
void put_cut(Json& json, const std::optional<CutPath>& cut) {
  if (!cut) return;
  json["path"] = path_name(cut->path.kind);
  json["cut"] = {cut->path.tolerance, cut->segments, cut->pieces, cut->beyond, cut->rounding, cut->bend};
}

std::optional<CutPath> read_cut(const JsonView& part) {
  if (!part.has("path")) return std::nullopt;
  CutPath cut;
  const Result<Path> path = make_path(part.required_text("path"));
  if (path)
    cut.path.kind = path.value().kind;
  else
    part.complain("path", path.error().message);
  if (const std::optional<JsonView> list = part.array("cut")) {
    Numbers numbers(*list);
    cut.path.tolerance = numbers.real();
    cut.segments = numbers.count();
    cut.pieces = numbers.count();
    cut.beyond = numbers.count();
    cut.rounding = numbers.real();
    cut.bend = numbers.real();
  }
  return cut;
}

// Calls each(view) for the items of the list `key` of an object. If the object has no such list, does nothing.
template <class Each>
void each_item(const JsonView& object, const char* key, const Each& each) {
  if (!object.has(key)) return;
  const std::optional<JsonView> list = object.array(key);
  for (std::size_t i = 0; list && i < list->size(); ++i) each(list->item(i));
}

constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max() >> 1U;

Json segment_json(const ComparedSegment& segment) {
  Json tallies = Json::array();
  for (const SchemeTally& tally : segment.schemes) tallies.push_back(tally_json(tally));
  return {{"segment", segment.segment}, {"tallies", std::move(tallies)}};
}

ComparedSegment read_compared(const JsonView& segment) {
  ComparedSegment found{segment.required_count("segment", kMost), {}};
  each_item(segment, "tallies", [&](const JsonView& tally) { found.schemes.push_back(read_tally(Numbers(tally))); });
  return found;
}

Json segment_json(const SegmentErrors& segment) {
  return {{"segment", segment.segment}, {"error", error_json(segment.error)}, {"at_keys", error_json(segment.at_keys)}};
}

SegmentErrors read_measured(const JsonView& segment) {
  SegmentErrors found;
  found.segment = segment.required_count("segment", kMost);
  if (const auto list = segment.array("error")) found.error = read_error(*list);
  if (const auto list = segment.array("at_keys")) found.at_keys = read_error(*list);
  return found;
}

template <class Read>
auto read_segment(std::string_view text, const std::string& name, const Read& read)
    -> Result<decltype(read(std::declval<const JsonView&>()))> {
  const Result<nlohmann::json> json = parse_json(text, name, 0, {});
  if (!json) return json.error();
  JsonComplaint complaint(name);
  auto found = read(JsonView(json.value(), "", complaint));
  if (complaint.first()) return *complaint.first();
  return found;
}

std::string line_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

ComparisonShard read_comparison(const JsonView& part) {
  ComparisonShard shard;
  Comparison& c = shard.whole;
  c.kind = static_cast<ElementKind>(part.required_count("kind", 2));
  c.motion = static_cast<MotionKind>(part.required_count("motion", 2));
  c.vertices = part.required_count("vertices", kMost);
  c.faces = part.required_count("faces", kMost);
  c.elements = part.required_count("elements", kMost);
  c.segments = part.required_count("segment_count", kMost);
  c.samples = part.required_count("samples", kMost);
  c.weighting = static_cast<Weighting>(part.count("weighting", kAllWeightings.size() - 1, 0));
  c.tolerance = read_tolerance(part);
  c.span = read_span(part);
  c.cut = read_cut(part);
  shard.checksums = read_task_checksums(part);
  if (c.segments == 0) part.complain("segment_count", "the shard has no segments; make the shard again");
  const bool is_sequential = part.flag("sequential"), is_certified = part.flag("certified");
  bool has_linear = false;
  each_item(part, "schemes", [&](const JsonView& name) {
    SchemeComparison row;
    row.scheme = name.as_text();
    const auto scheme = make_scheme(row.scheme);
    if (!scheme) return name.complain(scheme.error().message);
    const auto sequential = scheme.value()->sequential_operations();
    row.sequential = is_sequential && sequential.has_value();
    row.operations = row.sequential ? *sequential : scheme.value()->operations();
    if (is_certified) row.certified.emplace();
    has_linear = has_linear || row.scheme == "linear";
    c.schemes.push_back(std::move(row));
  });
  const std::size_t tallies = c.schemes.size() + (has_linear ? 0 : 1);
  each_item(part, "segments", [&](const JsonView& segment) {
    ComparedSegment found = read_compared(segment);
    if (found.schemes.size() != tallies)
      segment.complain(
          "the segment must have sums of errors for each scheme, among them linear; make this shard again");
    shard.found.push_back(std::move(found));
  });
  if (c.schemes.empty()) part.complain("the shard has no schemes; make the shard again");
  if (c.tolerance && !is_certified)
    part.complain("tolerance_degrees", "the shard has a tolerance, but no bounds of errors; make the shard again");
  return shard;
}

AuditShard read_audit(const JsonView& part) {
  AuditShard shard;
  Audit& audit = shard.whole;
  audit.span = read_span(part);
  audit.cut = read_cut(part);
  shard.checksums = read_task_checksums(part);
  audit.rule = static_cast<AuditRule>(part.required_count("rule", static_cast<std::size_t>(AuditRule::kFlat)));
  audit.weighting = read_weighting(part.required_count("weighting", kAllWeightings.size()), part);
  audit.stored = part.flag("stored");
  audit.still = part.required_count("still", kMost);
  each_item(part, "offsets", [&](const JsonView& offset) { audit.offsets.push_back(read_offset(offset)); });
  if (part.required_count("subjects", 1) == 1) {
    AuditSubject subject;
    subject.kind = AuditSubject::Kind::kSequence;
    subject.weighting = *audit.weighting;
    subject.segments = part.required_count("segment_count", kMost);
    subject.samples = part.required_count("samples", kMost);
    subject.vertices = part.required_count("vertices", kMost);
    audit.subjects.push_back(std::move(subject));
  }
  each_item(part, "segments", [&](const JsonView& segment) { shard.found.push_back(read_measured(segment)); });
  return shard;
}

// The parts (files of shards) that were read, and the fields that are equal in all parts. Either the list of
// comparisons or the list of audits is empty.
struct ReadParts {
  std::string name;
  std::optional<double> tolerance;
  std::vector<ComparisonShard> comparisons;
  std::vector<AuditShard> audits;
};

// Returns the checksums that a part contains, together with checksums of its tolerance and of the name of its input.
TaskChecksums checksums_of(const JsonView& part) {
  TaskChecksums checksums = read_task_checksums(part);
  NumberChecksum input, tolerance;
  input.add(part.required_text("input"));
  tolerance.add(read_tolerance(part).value_or(-1));
  checksums["the name of the input"] = input.value();
  checksums["the tolerance"] = tolerance.value();
  return checksums;
}

Result<ReadParts> read_parts(std::span<const Part> parts) {
  ReadParts read;
  KnownParts known_parts;
  for (const Part& part : parts) {
    const Result<nlohmann::json> json = parse_json(part.text, part.name, 0, {});
    if (!json) return json.error();
    JsonComplaint complaint(part.name);
    const JsonView view(json.value(), "", complaint);
    if (!view.is_object() || !view.has("chronormal_part"))
      return invalid_input(part.name,
                           "this file was not written with --shard, so it cannot be merged; give only shards");
    check_part_version(view);
    if (!complaint.first() && !has_its_checksum(part.text)) return invalid_input(part.name, std::string(kDamagedPart));
    const std::string command = view.required_text("command");
    read.name = view.required_text("input");
    read.tolerance = read_tolerance(view);
    if (command == "compare")
      read.comparisons.push_back(read_comparison(view));
    else if (command == "audit")
      read.audits.push_back(read_audit(view));
    else
      view.complain("command", "the command of a shard must be compare or audit");
    const TaskChecksums checksums = checksums_of(view);
    if (complaint.first()) return *complaint.first();
    if (!read.comparisons.empty() && !read.audits.empty())
      return Error{ErrorCode::kUsage, "", "the files are shards of both compare and audit; merge them separately"};
    if (const Status known = known_parts.add(part.name, checksums); !known) return known.error();
  }
  return read;
}

}  // namespace

std::string compare_part(const NamedComparison& shard, const CompareRun& run) {
  const Comparison& c = shard.comparison;
  Json json = part_json("compare", shard.name, c.tolerance, run.checksums);
  json["kind"] = static_cast<int>(c.kind);
  json["motion"] = static_cast<int>(c.motion);
  json["vertices"] = c.vertices;
  json["faces"] = c.faces;
  json["elements"] = c.elements;
  json["segment_count"] = c.segments;
  json["span"] = c.span;
  put_cut(json, c.cut);
  json["samples"] = c.samples;
  if (c.weighting != Weighting::kArea) json["weighting"] = static_cast<int>(c.weighting);
  json["sequential"] = std::any_of(c.schemes.begin(), c.schemes.end(), [](const auto& row) { return row.sequential; });
  json["certified"] = c.schemes.front().certified.has_value();
  for (const SchemeComparison& row : c.schemes) json["schemes"].push_back(row.scheme);
  for (const ComparedSegment& segment : run.found) json["segments"].push_back(segment_json(segment));
  return with_checksum(line_of(json));
}

std::string audit_part(const std::string& input, const Audit& shard, const AuditRun& run,
                       std::optional<double> tolerance) {
  Json json = part_json("audit", input, tolerance, run.checksums);
  json["rule"] = static_cast<int>(shard.rule);
  json["weighting"] = static_cast<int>(shard.weighting.value_or(Weighting::kArea));
  json["stored"] = shard.stored;
  json["still"] = shard.still;
  json["span"] = shard.span;
  put_cut(json, shard.cut);
  for (const AuthoredOffset& offset : shard.offsets) json["offsets"].push_back(authored_offset_json(offset));
  json["subjects"] = shard.subjects.size();
  for (const AuditSubject& subject : shard.subjects) {
    json["segment_count"] = subject.segments;
    json["samples"] = subject.samples;
    json["vertices"] = subject.vertices;
  }
  for (const SegmentErrors& segment : run.found) json["segments"].push_back(segment_json(segment));
  return with_checksum(line_of(json));
}

std::string segment_part(const ComparedSegment& segment) { return line_of(segment_json(segment)); }
std::string segment_part(const SegmentErrors& segment) { return line_of(segment_json(segment)); }

Result<ComparedSegment> read_compared_segment(std::string_view text, const std::string& name) {
  return read_segment(text, name, read_compared);
}

Result<SegmentErrors> read_measured_segment(std::string_view text, const std::string& name) {
  return read_segment(text, name, read_measured);
}

Result<NamedComparison> merge_compare_parts(std::span<const Part> parts) {
  Result<ReadParts> read = read_parts(parts);
  if (!read) return read.error();
  if (read.value().comparisons.empty())
    return Error{ErrorCode::kUsage, "", "the files are shards of audit, not of compare; give the shards of compare"};
  Result<Comparison> all = merge(std::move(read.value().comparisons));
  if (!all) return all.error();
  return NamedComparison{read.value().name, std::move(all).value(), {}};
}

Result<Audit> merge_audit_parts(std::span<const Part> parts) {
  Result<ReadParts> read = read_parts(parts);
  if (!read) return read.error();
  if (read.value().audits.empty())
    return Error{ErrorCode::kUsage, "", "the files are shards of compare, not of audit; give the shards of audit"};
  return merge(std::move(read.value().audits));
}

Result<MergedParts> merge_parts(std::span<const Part> parts) {
  Result<ReadParts> read = read_parts(parts);
  if (!read) return read.error();
  const auto& [name, tolerance, comparisons, audits] = read.value();
  if (audits.empty()) {
    const Result<Comparison> all = merge(comparisons);
    if (!all) return all.error();
    return MergedParts{compare_json({{name, all.value(), {}}}, false, false),
                       !tolerance || all.value().cheapest.has_value()};
  }
  const Result<Audit> all = merge(audits);
  if (!all) return all.error();
  return MergedParts{audit_json(name, all.value(), {tolerance}),
                     !tolerance || (all.value().is_judged() && all.value().is_within(*tolerance))};
}

}  // namespace chronormal::inline internal
