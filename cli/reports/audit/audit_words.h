/// Names the objects that the reports of `audit` mention, and formats the figures in them.
#ifndef CLI_REPORTS_AUDIT_AUDIT_WORDS_H_
#define CLI_REPORTS_AUDIT_AUDIT_WORDS_H_

#include <cstddef>
#include <optional>
#include <string>

#include "cli/reports/audit/audit_report.h"

namespace chronormal::cli {

/// The largest number of rows in tables and lists of an audit; --json has all rows.
inline constexpr std::size_t kMostAuditRows = 16;

/// Formats an angle in degrees with two decimals, or as a power of ten if two decimals would show zero.
[[nodiscard]] std::string degrees(double value);

/// Formats an angle like degrees(), with emphasis if it is a fault.
[[nodiscard]] std::string judged_degrees(double value);

/// Returns a number of samples in words: "1 sample", "12 samples".
[[nodiscard]] std::string samples(std::size_t count);

/// Name a vertex, a node, a target, an animation or an expression: "vertex 17 of Head, primitive 1", "node 3 (eye)",
/// "target 0 (smile)", "animation 1 (talk)", "expression 0 (happy)".
[[nodiscard]] std::string vertex_words(const Audited& input, const AuditPlace& place);
[[nodiscard]] std::string node_words(const Audited& input, std::size_t node);
[[nodiscard]] std::string target_words(const Audited& input, std::optional<std::size_t> mesh, std::size_t target);
[[nodiscard]] std::string animation_words(const Audited& input, std::size_t animation);
[[nodiscard]] std::string expression_words(const Audited& input, std::size_t mesh, std::size_t expression);

/// Names a subject of an audit: "target 0 (smile) of Head", "animation 1 (talk), node 3 (eye)", "sequence", "expression
/// 0 (happy) of Head".
[[nodiscard]] std::string subject_words(const Audited& input, const AuditSubject& subject);

/// Formats the moment of a sample: "weight 0.55" or "1.25 s".
[[nodiscard]] std::string moment_words(const AuditSubject& subject, double at);

/// Names the vertex, the motion and the moment of a sample: "vertex 17 of Head, primitive 1, target 0 (smile) at weight
/// 0.55".
[[nodiscard]] std::string place_words(const Audited& input, const AuditSubject& subject, const AuditPlace& place);

}  // namespace chronormal::cli

#endif  // CLI_REPORTS_AUDIT_AUDIT_WORDS_H_
