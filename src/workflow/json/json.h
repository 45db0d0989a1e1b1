/// Makes JSON from the results of inspect, audit, compare, bake and query: the output of the program for --json, for
/// callers that have the results but not the program. docs/cli.md lists the fields.
///
/// Text       indented by two, with a line end; bytes in names that are not UTF-8 become U+FFFD, and numbers that are
///            infinite or NaN become null.
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
#include "chronormal/workflow/inspect.h"
#include "chronormal/workflow/query.h"
#include "workflow/compare/face_figure.h"

namespace chronormal::inline internal {

[[nodiscard]] std::string inspect_json(const Inspected& input);

/// Returns the text of an audit. input is the name of the audited file; `passed` says whether the audit is within
/// limits.
[[nodiscard]] std::string audit_json(const std::string& input, const Audit& audit, const AuditLimits& limits);

struct NamedComparison {
  std::string name;
  Comparison comparison;
  TargetNames targets = {};  ///< if the motion is a set of targets
};

/// Returns the text of comparisons. `several` writes a list of inputs, even if there is only one. Without times the
/// text is the same on every run. inputs must not be empty.
[[nodiscard]] std::string compare_json(const std::vector<NamedComparison>& inputs, bool several, bool with_times);

/// Returns the text of the figures of a face. `input` is the name of the file of the face.
[[nodiscard]] std::string face_figure_json(const std::string& input, const FaceFigure& figure);

struct NamedBlendComparison {
  std::string name;
  std::string animation;  ///< the requested animation; empty for random weights
  BlendComparison comparison;
};

[[nodiscard]] std::string blend_json(const NamedBlendComparison& input);

struct NamedTruthComparison {
  std::string name;
  TruthComparison comparison;
};

[[nodiscard]] std::string truth_json(const NamedTruthComparison& input);

/// The audit of the input of a bake, and the audit of the baked file.
struct BeforeAndAfter {
  Audit before, after;

  [[nodiscard]] bool is_worse() const noexcept { return chronormal::is_worse(after.error, before.error); }
};

/// Facts about a bake that are reported with its result.
struct BakeReport {
  std::string input, output;  ///< names
  std::optional<std::string> drivers_file;
  std::optional<BeforeAndAfter> audit;
  std::vector<std::string> notes = {};  ///< on the input, from Input::notes()
};

[[nodiscard]] std::string bake_json(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// Returns the text that lists the targets, bytes and errors of each candidate for each mesh, as --encode smallest
/// compares them.
[[nodiscard]] std::string plan_json(const GltfBake& bake, const BakeReport& report);

/// Returns the text of an answer; input is the name of the file. Columns are arrays with the same names as in a .npz
/// file.
[[nodiscard]] std::string query_json(const std::string& input, const QueryAnswer& answer);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_JSON_H_
