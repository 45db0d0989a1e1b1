/// The results of inspect, audit, compare, bake and query as JSON: what the program prints for --json, for whoever has
/// the results and not the program. docs/cli.md has the fields.
///
/// Text       indented by two, with a line end; names that are no UTF-8 get U+FFFD, and numbers that are infinite or no
///            numbers are null.
/// Threads    everything here is pure.
#ifndef CHRONORMAL_WORKFLOW_JSON_JSON_H_
#define CHRONORMAL_WORKFLOW_JSON_JSON_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "chronormal/workflow/compare.h"
#include "workflow/compare/face_figure.h"
#include "chronormal/workflow/inspect.h"
#include "chronormal/workflow/query.h"

namespace chronormal::inline internal {

[[nodiscard]] std::string inspect_json(const Inspected& input);

/// input is the name of what was audited. tolerance: degrees, which `passed` is about; nothing: none was asked for.
[[nodiscard]] std::string audit_json(const std::string& input, const Audit& audit, const AuditLimits& limits);

struct NamedComparison {
  std::string name;
  Comparison comparison;
  TargetNames targets = {};  ///< of a set of targets
};

/// `several` nests the inputs, even if there is only one. Without times the text is the same on every run.
/// inputs must not be empty
[[nodiscard]] std::string compare_json(const std::vector<NamedComparison>& inputs, bool several, bool with_times);

/// input is the name of what the face belongs to.
[[nodiscard]] std::string face_figure_json(const std::string& input, const FaceFigure& figure);

struct NamedBlendComparison {
  std::string name;
  std::string animation;  ///< as it was asked for; empty: random weights
  BlendComparison comparison;
};

[[nodiscard]] std::string blend_json(const NamedBlendComparison& input);

struct NamedTruthComparison {
  std::string name;
  TruthComparison comparison;
};

[[nodiscard]] std::string truth_json(const NamedTruthComparison& input);

/// The audit of the input of a bake, and the audit of the file that it made.
struct BeforeAndAfter {
  Audit before, after;

  [[nodiscard]] bool is_worse() const noexcept { return chronormal::is_worse(after.error, before.error); }
};

/// What is reported of a bake beside its result.
struct BakeReport {
  std::string input, output;  ///< names
  std::optional<std::string> drivers_file;
  std::optional<BeforeAndAfter> audit;
  std::vector<std::string> notes = {};  ///< on the input, as Input::notes() has them
};

[[nodiscard]] std::string bake_json(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// Lists the targets, bytes and errors that each candidate for each mesh would have, as --encode smallest compares them.
[[nodiscard]] std::string plan_json(const GltfBake& bake, const BakeReport& report);

/// input is the name of what was asked about. Columns are arrays, named as in a .npz file.
[[nodiscard]] std::string query_json(const std::string& input, const QueryAnswer& answer);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_JSON_H_
