#include "cli/reports/audit/audit_words.h"

#include <vector>

#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"
#include "workflow/inspect/trouble.h"

namespace chronormal::cli {
namespace {

std::string named(std::string what, const std::string& name) {
  return name.empty() ? what : what.append(" (").append(printable(name, kLongestName)).append(")");
}

}  // namespace

std::string degrees(double value) {
  return value == 0 || value >= 0.005 ? formatted("{:.2f}", value) : formatted("{:.0e}", value);
}

std::string judged_degrees(double value) { return value > kAuditFault ? alarming(degrees(value)) : degrees(value); }

std::string samples(std::size_t count) { return counted(count, "sample", "samples"); }

std::string vertex_words(const Audited& input, const AuditPlace& place) {
  if (!place.mesh || input.document() == nullptr) return formatted("vertex {}", place.vertex);
  return formatted("vertex {} of {}, primitive {}", place.vertex, mesh_label(*input.document(), *place.mesh),
                   place.primitive.value_or(0));
}

std::string node_words(const Audited& input, std::size_t node) {
  return named(formatted("node {}", node), input.document()->nodes()[node].name);
}

std::string target_words(const Audited& input, std::optional<std::size_t> mesh, std::size_t target) {
  std::string name;
  if (mesh && input.document() != nullptr) {
    const std::vector<std::string>& names = input.document()->meshes()[*mesh].target_names;
    if (!names.empty()) name = names[target];
  } else {
    for (const AuditSubject& subject : input.audit.subjects)
      if (subject.target == target) name = subject.name;
  }
  return named(formatted("target {}", target), name);
}

std::string animation_words(const Audited& input, std::size_t animation) {
  return named(formatted("animation {}", animation), input.document()->animations()[animation].name);
}

std::string expression_words(const Audited& input, std::size_t mesh, std::size_t expression) {
  return named(formatted("expression {}", expression), input.document()->meshes()[mesh].expressions[expression].name);
}

std::string subject_words(const Audited& input, const AuditSubject& subject) {
  if (subject.kind == AuditSubject::Kind::kSequence) return "sequence";
  if (subject.kind == AuditSubject::Kind::kTrack)
    return animation_words(input, *subject.animation) + ", " + node_words(input, *subject.node);
  if (subject.kind == AuditSubject::Kind::kExpression)
    return expression_words(input, *subject.mesh, *subject.expression) + " of " +
           mesh_label(*input.document(), *subject.mesh);
  if (subject.kind == AuditSubject::Kind::kOpening)
    return mesh_label(*input.document(), *subject.mesh) + " as the file opens" +
           (subject.node ? " (" + node_words(input, *subject.node) + ")" : "");
  if (subject.kind == AuditSubject::Kind::kPoses)
    return counted(subject.segments, "pose", "poses") + " of " + mesh_label(*input.document(), *subject.mesh);
  const std::string target = target_words(input, subject.mesh, *subject.target);
  return subject.mesh ? target + " of " + mesh_label(*input.document(), *subject.mesh) : target;
}

std::string moment_words(const AuditSubject& subject, double at) {
  if (subject.kind == AuditSubject::Kind::kPoses) return formatted("pose {:.0f}", at);
  return subject.is_weighed() ? formatted("weight {:.4g}", at) : formatted("{:.6g} s", at);
}

std::string place_words(const Audited& input, const AuditSubject& subject, const AuditPlace& place) {
  std::string motion = subject_words(input, subject);
  if (subject.target && subject.mesh) motion = target_words(input, subject.mesh, *subject.target);
  if (subject.expression) motion = expression_words(input, *subject.mesh, *subject.expression);
  if (subject.kind == AuditSubject::Kind::kOpening) return vertex_words(input, place) + ", as the file opens";
  if (subject.kind == AuditSubject::Kind::kPoses)
    return vertex_words(input, place) + ", " + moment_words(subject, place.at);
  return formatted("{}, {} at {}", vertex_words(input, place), motion, moment_words(subject, place.at));
}

}  // namespace chronormal::cli
