#include "cli/reports/audit/audit_advice.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/bake.h"
#include "cli/reports/audit/audit_words.h"
#include "cli/terminal/format.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

// The remedies for the errors that an audit finds. The last line of the report recommends one of them.
enum class Remedy {
  kNone,  // no normal is wrong
  // No judged normal is wrong, but some normals could not be judged, or no normal was judged at all.
  kUnknown,
  // The normals are right but tangents are wrong. bake computes new tangents; a file that bake does not accept needs
  // another export.
  kTangents,
  kViewers,   // normals are right by the specification, but wrong in viewers that differ from it
  kRule,      // the requested rule is not the one that viewers use for glTF files
  kOriginal,  // the meshes with errors were baked before; bake does not bake a mesh twice
  kTargets,   // bake does not accept targets over a base
  kBake,
};

// Returns the error in degrees above which a normal is reported: kAuditFault, or the requested tolerance if it is
// smaller.
double limit_of(const Audited& input) { return std::min(kAuditFault, input.limits.degrees.value_or(kAuditFault)); }

bool is_wrong(const AuditSubject& subject, double limit) { return !subject.error.is_within(limit); }

// Returns true if there is a mesh and the mesh was baked before.
bool was_baked(const Audited& input, std::optional<std::size_t> mesh) {
  return input.document() != nullptr && mesh && input.document()->meshes()[*mesh].mark.has_value();
}

// Returns true if the subject is a target whose weight an animation drives. A subject that is not a target counts as
// driven.
bool is_driven(const Audited& input, const AuditSubject& subject) {
  if (subject.kind != AuditSubject::Kind::kTarget) return true;
  const auto drives = [&](const AuditSubject& other) {
    return other.mesh == subject.mesh &&
           std::find(other.driven.begin(), other.driven.end(), *subject.target) != other.driven.end();
  };
  return std::any_of(input.audit.subjects.begin(), input.audit.subjects.end(), drives);
}

// Lists the subjects with errors. If `baked` is true, lists only subjects of meshes that were baked before; otherwise
// lists only subjects of other meshes.
std::vector<const AuditSubject*> wrong_subjects(const Audited& input, bool baked) {
  std::vector<const AuditSubject*> result;
  for (const AuditSubject& subject : input.audit.subjects)
    if (is_wrong(subject, limit_of(input)) && was_baked(input, subject.mesh) == baked) result.push_back(&subject);
  return result;
}

// Returns the titles of the viewers in which some normal is wrong, separated by commas.
std::string wrong_viewers(const Audited& input) {
  std::string titles;
  for (const ViewerAudit& viewer : input.audit.viewers) {
    if (!viewer.error.is_within(limit_of(input))) titles.append(titles.empty() ? "" : ", ").append(viewer.viewer.title);
  }
  return titles;
}

// Returns true if bake accepts the file, and some mesh with wrong tangents was not baked before.
bool can_bake_tangents(const Audited& input) {
  const auto& findings = input.audit.findings;
  return !input.bake.empty() && std::any_of(findings.begin(), findings.end(), [&](const AuditFinding& finding) {
    return finding.is_fault() && !was_baked(input, finding.mesh);
  });
}

Remedy remedy_of(const Audited& input) {
  const Audit& audit = input.audit;
  const bool any_fresh = !wrong_subjects(input, false).empty(), any_baked = !wrong_subjects(input, true).empty();
  if (!any_fresh && !any_baked) {
    if (!wrong_viewers(input).empty()) return Remedy::kViewers;
    const bool any_fault = std::any_of(audit.findings.begin(), audit.findings.end(),
                                       [](const AuditFinding& finding) { return finding.is_fault(); });
    if (any_fault) return Remedy::kTangents;
    return audit.is_judged() && audit.error.cancelled == 0 ? Remedy::kNone : Remedy::kUnknown;
  }
  if (input.document() != nullptr && audit.rule != AuditRule::kGltf) return Remedy::kRule;
  if (!any_fresh) return Remedy::kOriginal;
  return input.bake.empty() ? Remedy::kTargets : Remedy::kBake;
}

// Returns the weightings of the subjects with wrong normals, in words: "angle-weighted", "angle- and max-weighted".
std::string weighting_words(const std::vector<const AuditSubject*>& subjects) {
  std::string text;
  for (const WeightingInfo& info : kAllWeightings) {
    const auto has = [&](const AuditSubject* subject) { return subject->weighting == info.weighting; };
    if (std::any_of(subjects.begin(), subjects.end(), has))
      text += (text.empty() ? "" : "- and ") + std::string(info.name);
  }
  return text + "-weighted";
}

// Says in words what `chronormal bake` will do to this file, as far as the audit can predict that.
std::string outcome(const Audited& input) {
  if (input.document() == nullptr) return "makes a glTF file with true normals at every instant";
  const std::vector<const AuditSubject*> wrong = wrong_subjects(input, false);
  const auto driven = static_cast<std::size_t>(std::count_if(
      wrong.begin(), wrong.end(), [&](const AuditSubject* subject) { return is_driven(input, *subject); }));
  const bool by_area = std::all_of(wrong.begin(), wrong.end(),
                                   [](const AuditSubject* subject) { return subject->weighting == Weighting::kArea; });
  std::string text = formatted("corrects these normals to within {:g} degrees where it can", kHarmlessTolerance);
  if (driven == wrong.size() && by_area && input.audit.error.unlit == 0)
    text += "; for viewers that add up targets as glTF says, --encode exact comes within about 0.01 degrees";
  return text;
}

std::string original_words(const Audited& input) {
  bool all_single = true, any_driven = false, all_fitted = true, any_harmless = false;
  const std::vector<const AuditSubject*> wrong = wrong_subjects(input, true);
  for (const AuditSubject* subject : wrong) {
    const BakeEncoding encoding = input.document()->meshes()[*subject->mesh].mark->encoding;
    all_fitted = all_fitted && subject->weighting != Weighting::kArea;
    all_single = all_single && encoding == BakeEncoding::kEndpoint;
    any_harmless = any_harmless || encoding == BakeEncoding::kHarmless || encoding == BakeEncoding::kSmallest;
    any_driven = any_driven || is_driven(input, *subject);
  }
  const std::string baked = "the meshes with errors were baked before, and bake does not change a baked mesh; ";
  if (any_harmless && any_driven)
    return baked +
           "for smaller errors, bake the ORIGINAL file with --for VIEWER, a smaller --tolerance, or --encode exact";
  if (any_harmless)
    return baked +
           "bake cannot make errors of targets that no animation moves smaller, since only animations drive correction "
           "targets";
  if (!all_single && all_fitted)
    return formatted("the errors remain because {} normals can only be approximated, and bake cannot come closer",
                     weighting_words(wrong));
  if (!all_single)
    return baked + "the meshes have changed since that bake, or --weighting differs; bake the ORIGINAL file again";
  if (any_driven)
    return baked +
           "a single delta for each target cannot be right everywhere; bake the ORIGINAL file with --encode exact";
  return baked +
         "bake cannot make errors of targets that no animation moves smaller, since only animations drive correction "
         "targets";
}

}  // namespace

std::string advice(const Audited& input) {
  if (input.audit.subjects.empty()) return "";
  switch (remedy_of(input)) {
    case Remedy::kNone:
      return formatted("\nthere is nothing to do, since no error is larger than {}\n",
                       with_degrees(with_digits(limit_of(input), 6)));
    case Remedy::kUnknown:
      return input.audit.error.cancelled > 0 ? "\nat some vertices the normals of the faces cancel each other, so no "
                                               "vertex normal is right;\ngive each side of a sheet its own vertices\n"
                                             : "\nnothing could be judged, since no face that moves has an area; run "
                                               "chronormal inspect to list faces without area\n";
    case Remedy::kTangents:
      if (!can_bake_tangents(input)) {
        return "\nthe normals are right, but the tangents are not; export tangents for all targets, or for none, so "
               "that viewers\ncompute tangents\n";
      }
      return formatted("\nchronormal bake {} -o baked.glb computes new tangents; the normals are right\n", input.bake);
    case Remedy::kViewers:
      return formatted(
          "\nthe normals are right in viewers that add up targets as glTF says, but not in {};\nto correct the file "
          "for such a viewer, bake the original file with --for\n",
          wrong_viewers(input));
    case Remedy::kRule:
      return formatted("\nviewers do not render glTF files by the rule {}; leave --rule out to see what bake can do\n",
                       audit_rule_name(input.audit.rule));
    case Remedy::kOriginal:
      return '\n' + original_words(input) + '\n';
    case Remedy::kTargets:
      return "\nto correct these normals, write the base and its targets as a .glb with chronormal convert, and bake "
             "that file\n";
    case Remedy::kBake:
      return formatted("\nchronormal bake {} -o baked.glb {}\n", input.bake, outcome(input));
  }
  return "";
}

std::string verdict(const Audited& input) {
  if (input.audit.subjects.empty()) return "nothing moves";
  if (input.limits.any()) return input.passed() ? "within the limits" : "beyond the limits";
  switch (remedy_of(input)) {
    case Remedy::kNone:
      return "right";
    case Remedy::kUnknown:
      return "could not be judged";
    case Remedy::kTangents:
      return "tangents wrong";
    case Remedy::kViewers:
      return "wrong in some viewers";
    case Remedy::kRule:
    case Remedy::kTargets:
      return "wrong";
    case Remedy::kOriginal:
      return "wrong, baked before";
    case Remedy::kBake:
      return "wrong, bake it";
  }
  return "";
}

}  // namespace chronormal::cli
