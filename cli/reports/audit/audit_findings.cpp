// Groups findings into lines. The mesh of a head may have dozens of targets with the same fault, so one line covers all
// these targets, and names the worst target.
#include "cli/reports/audit/audit_findings.h"

#include <algorithm>
#include <vector>

#include "cli/reports/audit/audit_words.h"
#include "cli/terminal/format.h"
#include "cli/terminal/table.h"
#include "workflow/inspect/trouble.h"

namespace chronormal::cli {
namespace {

using Kind = AuditFinding::Kind;

// The findings with the same cause in one mesh.
struct Group {
  const AuditFinding* worst = nullptr;
  std::size_t targets = 0, animations = 0, expressions = 0;
  std::size_t count = 0;  // sum of the counts of all these findings

  [[nodiscard]] std::size_t size() const noexcept { return targets + animations + expressions; }
};

// Returns the groups of faults, the worst first, if `faults` is true. Otherwise returns the groups of notes in the
// order of the file.
std::vector<Group> groups_of(const Audit& audit, bool faults) {
  std::vector<Group> groups;
  for (const AuditFinding& finding : audit.findings) {
    if (finding.is_fault() != faults) continue;
    const auto is_same = [&](const Group& g) {
      return g.worst->kind == finding.kind && g.worst->mesh == finding.mesh && g.worst->viewer == finding.viewer;
    };
    auto group = std::find_if(groups.begin(), groups.end(), is_same);
    if (group == groups.end()) group = groups.insert(groups.end(), Group{&finding});
    if (finding.degrees > group->worst->degrees) group->worst = &finding;
    group->targets += finding.target ? 1U : 0U;
    group->expressions += finding.expression ? 1U : 0U;
    group->animations += finding.target || finding.expression ? 0U : 1U;
    group->count += finding.count;
  }
  if (faults)
    std::stable_sort(groups.begin(), groups.end(),
                     [](const Group& a, const Group& b) { return a.worst->degrees > b.worst->degrees; });
  return groups;
}

std::string of_mesh(const Audited& input, const AuditFinding& finding) {
  return finding.mesh ? mesh_label(*input.document(), *finding.mesh) : "";
}

std::string one_subject(const Audited& input, const AuditFinding& found) {
  const std::string mesh = of_mesh(input, found);
  if (found.target) return target_words(input, found.mesh, *found.target) + (found.mesh ? " of " + mesh : "");
  if (found.expression) return expression_words(input, *found.mesh, *found.expression) + " of " + mesh;
  if (found.animation) return animation_words(input, *found.animation) + ", " + node_words(input, *found.node);
  return found.mesh ? mesh : "sequence";
}

// Names the targets and animations of a group: "57 targets of Head" or "2 targets and 1 animation of Head".
std::string subject_of(const Audited& input, const Group& group) {
  if (group.size() == 1) return one_subject(input, *group.worst);
  std::string text;
  if (group.targets > 0) text = counted(group.targets, "target", "targets");
  if (group.expressions > 0)
    text += (text.empty() ? "" : " and ") + counted(group.expressions, "expression", "expressions");
  if (group.animations > 0)
    text += (text.empty() ? "" : " and ") + counted(group.animations, "animation", "animations");
  return text + (group.worst->mesh ? " of " + of_mesh(input, *group.worst) : "");
}

// Returns the worst error, in degrees, of any single target of the mesh of a finding.
double worst_alone(const Audit& audit, const AuditFinding& found) {
  double worst = 0;
  for (const AuditSubject& subject : audit.subjects)
    if (subject.kind == AuditSubject::Kind::kTarget && subject.mesh == found.mesh)
      worst = std::max(worst, subject.error.worst);
  return worst;
}

std::string group_words(const Audited& input, const Group& group) {
  const AuditFinding& found = *group.worst;
  const bool is_one = group.size() == 1;
  const std::string who = subject_of(input, group), worst = degrees(found.degrees);
  switch (found.kind) {
    case Kind::kUnlit:
      return formatted("{}: the normals of {} would be zero, infinite or NaN in a viewer", who, samples(group.count));
    case Kind::kMissingNormals:
      return formatted("{} {} positions but {} no normals{}; {}", who, is_one ? "moves" : "move",
                       is_one ? "has" : "have",
                       is_one ? " (" + counted(found.count, "primitive", "primitives") + ")" : "",
                       found.is_fault() ? "errors of up to " + worst + " degrees" : "no normal has to change");
    case Kind::kWrongAtKeys:
      return formatted("{}: {} have errors of up to {} degrees at {}", who,
                       input.audit.rule == AuditRule::kFlat ? "faces" : "stored normals", worst,
                       found.target ? "weight 1" : "keyframes");
    case Kind::kWrongBetween:
      return formatted("{}: normals are right at {}, with errors of up to {} degrees in between", who,
                       found.target ? "weights 0 and 1" : "keyframes", worst);
    case Kind::kWrongTogether: {
      const double alone = worst_alone(input.audit, found);
      return alone > kAuditFault
                 ? formatted("{}: errors of up to {} degrees where targets mix, and of up to {} for a target alone",
                             who, worst, degrees(alone))
                 : formatted(
                       "{}: each target alone is right, but where targets mix there are errors of up to {} degrees",
                       who, worst);
    }
    case Kind::kWrongPose:
      return found.node
                 ? formatted("{}: errors of up to {} degrees in the pose in which the file opens",
                             of_mesh(input, found), worst)
                 : formatted("{}: errors of up to {} degrees in the poses of --poses", of_mesh(input, found), worst);
    case Kind::kStaleKeys:
      return formatted(
          "{}: stored normals do not turn with the surface ({}), so true normals are computed from the surface, in the "
          "same way as for the base",
          who, counted(group.count, "vertex", "vertices"));
    case Kind::kUnknownRule:
      return formatted(
          "{}: its normals follow no known weighting, so area weights are used; another --weighting would change true "
          "normals by {} degrees (median)",
          of_mesh(input, found), degrees(found.degrees));
    case Kind::kStaleTangents:
      return formatted("{}: {} up to {} degrees away from a right angle to the true normal", who,
                       counted(group.count, "tangent is", "tangents are"), worst);
    case Kind::kFlat:
      return formatted("{}: {} no normals, and {} rendered flat, which is right", who,
                       counted(found.count, "primitive has", "primitives have"), found.count == 1 ? "is" : "are");
    case Kind::kSkinned:
      return formatted("{}: {} a skin, which was applied; skinning itself turns even true normals by up to {} degrees",
                       of_mesh(input, found), counted(found.count, "node has", "nodes have"), worst);
    case Kind::kUnreadSkin:
      return formatted("{}: {} a skin that cannot be read, so it was not applied ({})", of_mesh(input, found),
                       counted(found.count, "node has", "nodes have"), found.reason->text());
    case Kind::kBaked:
      return formatted("{}: baked by chronormal, with {}", who,
                       counted(found.count, "correction target", "correction targets"));
    case Kind::kEmptied:
      return formatted(
          "{}: {} no effect any more, since another program has computed new normals; bake the ORIGINAL file again",
          who,
          counted(found.count, "correction target of an earlier bake has",
                  "correction targets of an earlier bake have"));
    case Kind::kSequenceTargets:
      return formatted("{}: {} keyframes of a baked sequence, so only animations were judged", who,
                       counted(found.count, "target is one of the", "targets are"));
    case Kind::kBeyondViewer:
      return formatted("{}: {} than {} supports; {}", who, counted(found.count, "target more", "targets more"),
                       found.viewer->title, found.viewer->beyond);
  }
  return "";
}

std::string lines_of(const Audited& input, bool faults) {
  const std::vector<Group> groups = groups_of(input.audit, faults);
  std::string text;
  for (std::size_t g = 0; g < std::min(groups.size(), kMostAuditRows); ++g) {
    const AuditFinding& worst = *groups[g].worst;
    text += "  " + group_words(input, groups[g]);
    if (worst.worst_at) {
      const std::string whose = groups[g].size() > 1 ? "worst: " + one_subject(input, worst) + ", " : "";
      text += " (" + whose + vertex_words(input, *worst.worst_at) + ")";
    }
    text += '\n';
  }
  if (groups.size() > kMostAuditRows)
    text += formatted("  ... and {}{} (--json has all)\n",
                      counted(groups.size() - kMostAuditRows, faults ? "more fault" : "more note",
                              faults ? "more faults" : "more notes"),
                      faults ? ", with smaller errors" : "");
  if (text.empty()) return text;
  return (faults ? "\nFaults:\n" : "\nNotes:\n") + text;
}

}  // namespace

std::size_t count_fault_lines(const Audit& audit) { return groups_of(audit, true).size(); }

std::string fault_lines(const Audited& input) { return lines_of(input, true); }

std::string note_lines(const Audited& input) { return lines_of(input, false); }

}  // namespace chronormal::cli
