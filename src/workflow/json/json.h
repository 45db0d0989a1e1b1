/// Makes JSON from the results of inspect, audit, compare, bake and query. The text is the output of the program for
/// --json. This header is for callers that have the results but do not run the program. docs/cli.md lists the fields.
///
/// Text       Lines are indented by two spaces, and the text ends with a line end. Bytes in names that are not UTF-8
///            become U+FFFD. Numbers that are infinite or NaN become null.
/// Threads    All functions are pure.
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

/// Returns the JSON text of an audit. input is the name of the audited file. The field `passed` tells whether the
/// errors are within the limits.
[[nodiscard]] std::string audit_json(const std::string& input, const Audit& audit, const AuditLimits& limits);

struct NamedComparison {
  std::string name;
  Comparison comparison;
  TargetNames targets = {};  ///< the names of targets; set if the motion consists of targets
};

/// Returns the JSON text of comparisons. If several is true, writes a list of inputs even if there is only one input.
/// If with_times is false, the text is the same on every run. inputs must not be empty.
[[nodiscard]] std::string compare_json(const std::vector<NamedComparison>& inputs, bool several, bool with_times);

/// Returns the JSON text of the figures of a face. `input` is the name of the file that has the face.
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

/// The audit of the input of a bake, and the audit of the file that the bake wrote.
struct BeforeAndAfter {
  Audit before, after;

  [[nodiscard]] bool is_worse() const noexcept { return chronormal::is_worse(after.error, before.error); }
};

/// Facts about a bake that are reported with its result.
struct BakeReport {
  std::string input, output;  ///< the names of the files
  std::optional<std::string> drivers_file;
  std::optional<BeforeAndAfter> audit;
  std::vector<std::string> notes = {};  ///< notes on the input, from Input::notes()
};

[[nodiscard]] std::string bake_json(const GltfBake& bake, const BakeReport& report);
[[nodiscard]] std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report);

/// Returns the JSON text that lists, for each mesh, the targets, bytes and errors of every candidate. The option
/// --encode smallest compares these figures.
[[nodiscard]] std::string plan_json(const GltfBake& bake, const BakeReport& report);

/// Returns the JSON text of the answer to a query. input is the name of the queried file. Each column is an array with
/// the name that it has in a .npz file.
[[nodiscard]] std::string query_json(const std::string& input, const QueryAnswer& answer);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_JSON_H_
