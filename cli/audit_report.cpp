#include "cli/audit_report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "chronormal/normals/weighting.h"
#include "cli/format.h"
#include "cli/inspect_trouble.h"
#include "cli/table.h"
#include "cli/text.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;
using Kind = AuditFinding::Kind;

constexpr std::size_t kMostRows = 16, kLongestName = 32, kLongestBar = 40;
constexpr double kSeen = 0.005;                     // degrees: what two decimals show
constexpr double kMost = 0.99, kNearlyAll = 0.999;  // shares of the pairs
constexpr double kDisplaced = 1e-5;                 // a share of the size that is worth a word

// Two decimals, or the power of ten of what would be none of it.
std::string degrees(double value) {
  return value == 0 || value >= 0.005 ? formatted("{:.2f}", value) : formatted("{:.0e}", value);
}

std::string named(std::string what, const std::string& name) {
  return name.empty() ? what : what.append(" (").append(printable(name, kLongestName)).append(")");
}

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

std::string subject_words(const Audited& input, const AuditSubject& subject) {
  if (subject.kind == AuditSubject::Kind::kSequence) return "sequence";
  if (subject.kind == AuditSubject::Kind::kTrack)
    return animation_words(input, *subject.animation) + ", " + node_words(input, *subject.node);
  const std::string target = target_words(input, subject.mesh, *subject.target);
  return subject.mesh ? target + " of " + mesh_label(*input.document(), *subject.mesh) : target;
}

std::string moment_words(const AuditSubject& subject, double at) {
  return subject.kind == AuditSubject::Kind::kTarget ? formatted("weight {:.4g}", at) : formatted("{:.6g} s", at);
}

// A vertex of a motion at a moment.
std::string place_words(const Audited& input, const AuditSubject& subject, const AuditPlace& place) {
  const std::string motion = subject.kind == AuditSubject::Kind::kTarget && subject.mesh
                                 ? target_words(input, subject.mesh, *subject.target)
                                 : subject_words(input, subject);
  return formatted("{}, {} at {}", vertex_words(input, place), motion, moment_words(subject, place.at));
}

std::string pairs(std::size_t count) { return counted(count, "pair", "pairs"); }

std::string verdict(const Audited& input) {
  const std::vector<HostAudit>& hosts = input.audit.hosts;
  if (hosts.empty()) return formatted("{} {} degrees", input.passed() ? "within" : "beyond", *input.tolerance);
  const auto within = std::count_if(hosts.begin(), hosts.end(), [&](const HostAudit& h) { return input.passed(h); });
  return formatted("within {} degrees in {} of {}", *input.tolerance, within, counted(hosts.size(), "host", "hosts"));
}

std::string headline(const Audited& input) {
  const Audit& audit = input.audit;
  std::string text = printable(input.name()) + ": ";
  if (audit.subjects.empty()) return text + "nothing to judge: no target and no animation moves stored normals\n";
  text += formatted("worst {} degrees, mean {}, 99 % {}, 99.9 % {}", degrees(audit.error.worst),
                    degrees(audit.error.mean()), degrees(audit.error.percentile(kMost)),
                    degrees(audit.error.percentile(kNearlyAll)));
  if (input.tolerance) text += ", " + verdict(input);
  text += '\n';
  if (audit.worst) text += "  the worst is at " + worst_label(input) + '\n';
  const char* source =
      audit.stored ? "the stored normals" : "normals that a host computes at keyframes, where none are stored";
  if (audit.rule == AuditRule::kFlat) source = "the faces";
  text += formatted("  shown by the rule {}, from {}; {} judged in {}\n", audit_rule_name(audit.rule), source,
                    pairs(audit.error.judged), counted(audit.subjects.size(), "motion", "motions"));
  if (audit.still > 0)
    text += formatted("  {} nothing that could be judged\n",
                      counted(audit.still, "target or track moves", "targets or tracks move"));
  if (audit.error.no_normal > 0)
    text += formatted("  {} without a right direction: the normal of the geometry all but vanishes there\n",
                      pairs(audit.error.no_normal));
  if (audit.error.unlit > 0)
    text += formatted("  {} cannot be lit, which counts as 180 degrees: the first is at {}\n", pairs(audit.error.unlit),
                      unlit_label(input));
  return text;
}

std::string subject_table(const Audited& input) {
  const std::vector<AuditSubject>& subjects = input.audit.subjects;
  std::vector<double> errors;
  for (const AuditSubject& subject : subjects) errors.push_back(subject.error.worst);
  Table table;
  table.add_column("motion", "", Align::kLeft);
  table.add_column("worst", "degrees", Align::kRight);
  table.add_column("mean", "degrees", Align::kRight);
  table.add_column("99 %", "degrees", Align::kRight);
  table.add_column("99.9 %", "degrees", Align::kRight);
  table.add_column("at keys", "degrees", Align::kRight);
  table.add_column("worst at", "vertex", Align::kRight);
  table.add_column("", "", Align::kLeft);
  table.add_column("vertices", "that move", Align::kRight);
  table.add_column("samples", "", Align::kRight);
  for (const std::size_t s : indices_of_largest(errors, kMostRows)) {
    const AuditSubject& subject = subjects[s];
    const bool some = subject.error.worst > 0;
    table.add_row({subject_words(input, subject), degrees(subject.error.worst), degrees(subject.error.mean()),
                   degrees(subject.error.percentile(kMost)), degrees(subject.error.percentile(kNearlyAll)),
                   degrees(subject.at_keys.worst), some ? formatted("{}", subject.error.worst_at.vertex) : "-",
                   some ? moment_words(subject, subject.error.worst_at.at) : "", grouped(subject.vertices),
                   subject.segments > 1 ? formatted("{} x {}", grouped(subject.segments), subject.samples)
                                        : formatted("{}", subject.samples)});
  }
  std::string text = table.text();
  if (subjects.size() > kMostRows)
    text += formatted("... and {} more with smaller errors (--json has all)\n", grouped(subjects.size() - kMostRows));
  return text;
}

// What each host shows, the specification first, which the tables below are about.
std::string host_table(const Audited& input) {
  const Audit& audit = input.audit;
  if (audit.hosts.empty()) return "";
  Table table;
  table.add_column("host", "", Align::kLeft);
  for (const char* const title : {"mean", "99 %", "99.9 %", "worst"}) table.add_column(title, "degrees", Align::kRight);
  table.add_column("unlit", "pairs", Align::kRight);
  table.add_column("displaced", "% of size", Align::kRight);
  table.add_column("", "", Align::kLeft);
  const auto add_row = [&](std::string_view title, const MotionError& error, const std::string& displaced,
                           const std::string& note) {
    table.add_row({std::string(title), degrees(error.mean()), degrees(error.percentile(kMost)),
                   degrees(error.percentile(kNearlyAll)), degrees(error.worst), grouped(error.unlit), displaced, note});
  };
  add_row("(specification)", audit.error, "-", "");
  for (const HostAudit& found : audit.hosts) {
    std::string note = found.beyond > 0 ? "too many targets" : "";
    if (note.empty() && !input.passed(found)) note = "beyond the tolerance";
    add_row(found.host.title, found.error,
            found.displaced > kDisplaced ? formatted("{:.2g}", 100 * found.displaced) : "-", note);
  }
  return '\n' + table.text();
}

std::string bin_words(std::size_t bin) {
  if (bin == 0) return formatted("below {:g}", kAuditBinEdges.front());
  if (bin == kAuditBinEdges.size()) return formatted("{:g} and more", kAuditBinEdges.back());
  return formatted("{:g} to {:g}", kAuditBinEdges[bin - 1], kAuditBinEdges[bin]);
}

std::string histogram(const MotionError& error) {
  Table table;
  table.add_column("error", "degrees", Align::kRight);
  table.add_column("pairs", "", Align::kRight);
  table.add_column("share", "%", Align::kRight);
  table.add_column("", "", Align::kLeft);
  const std::size_t most = *std::max_element(error.histogram.begin(), error.histogram.end());
  for (std::size_t bin = 0; bin < kAuditBins; ++bin) {
    const double count = static_cast<double>(error.histogram[bin]);
    const auto bar =
        most > 0 ? static_cast<std::size_t>(std::lround(kLongestBar * count / static_cast<double>(most))) : 0;
    const double share = error.judged > 0 ? 100 * count / static_cast<double>(error.judged) : 0;
    table.add_row({bin_words(bin), grouped(error.histogram[bin]), formatted("{:.1f}", share),
                   std::string(error.histogram[bin] > 0 ? std::max<std::size_t>(bar, 1) : 0, '#')});
  }
  return table.text();
}

std::string offset_lines(const Audited& input) {
  std::string text;
  std::size_t rows = 0, more = 0;
  for (const AuthoredOffset& offset : input.audit.offsets) {
    if (offset.vertices == 0) continue;
    if (rows++ >= kMostRows) {
      ++more;
      continue;
    }
    text += formatted("  {}: mean {}, worst {} degrees from {}-weighted normals",
                      offset.mesh ? mesh_label(*input.document(), *offset.mesh) : "keyframe 0", degrees(offset.mean()),
                      degrees(offset.worst), weighting_name(input.audit.weighting));
    if (offset.worst >= kSeen) text += " (" + vertex_words(input, offset.worst_at) + ")";
    if (offset.mean() >= kSeen && offset.closest_mean < offset.mean() / 2)
      text += formatted("; --weighting {} is closer: mean {}, worst {}", weighting_name(offset.closest),
                        degrees(offset.closest_mean), degrees(offset.closest_worst));
    text += '\n';
  }
  if (more > 0) text += formatted("  ... and {} more (--json has all)\n", grouped(more));
  return text.empty() ? text : "\nAuthored offset, which is no fault:\n" + text;
}

std::string finding_words(const Audited& input, const AuditFinding& found) {
  const std::string mesh = found.mesh ? mesh_label(*input.document(), *found.mesh) : "";
  std::string who = mesh;
  if (found.target) {
    who = target_words(input, found.mesh, *found.target);
    if (found.mesh) who += " of " + mesh;
  } else if (found.animation) {
    who = animation_words(input, *found.animation) + ", " + node_words(input, *found.node);
  } else if (!found.mesh) {
    who = "sequence";
  }
  const std::string worst = degrees(found.degrees);
  switch (found.kind) {
    case Kind::kUnlit:
      return formatted("{}: {} cannot be lit: what is shown is zero, infinite or no number", who, pairs(found.count));
    case Kind::kMissingNormals:
      return formatted("{} moves positions and no normals ({}): {}", who,
                       counted(found.count, "primitive", "primitives"),
                       found.is_fault() ? "off by up to " + worst + " degrees" : "none has to turn");
    case Kind::kWrongAtKeys:
      return formatted("{}: {} contradict the geometry at {}, by up to {} degrees", who,
                       input.audit.rule == AuditRule::kFlat ? "faces" : "stored normals",
                       found.target ? "weight 1" : "keyframes", worst);
    case Kind::kWrongBetween:
      return formatted("{}: right at {}, and off by up to {} degrees on the way", who,
                       found.target ? "weights 0 and 1" : "keyframes", worst);
    case Kind::kWrongTogether:
      return formatted("{}: each target alone is right, together they are off by up to {} degrees", who, worst);
    case Kind::kStaleTangents:
      return formatted("{}: {} up to {} degrees from perpendicular to the right normal", who,
                       counted(found.count, "tangent is", "tangents are"), worst);
    case Kind::kFlat:
      return formatted("{}: {} no normals, and {} shown flat, which is right", who,
                       counted(found.count, "primitive has", "primitives have"), found.count == 1 ? "is" : "are");
    case Kind::kSkinned:
      return formatted("{}: {} a skin, which turns shown and right normals alike", who,
                       counted(found.count, "node has", "nodes have"));
    case Kind::kBaked:
      return formatted("{}: baked by chronormal, with {}", who, counted(found.count, "extra target", "extra targets"));
    case Kind::kSequenceTargets:
      return formatted("{}: {} baked keyframes: only animations were judged", who,
                       counted(found.count, "target is one of its", "targets are"));
    case Kind::kBeyondHost:
      return formatted("{}: {} more than {} takes: {}", who, counted(found.count, "target", "targets"),
                       found.host->title, found.host->beyond);
  }
  return "";
}

std::string finding_lines(const Audited& input, bool faults) {
  std::string text;
  std::size_t rows = 0;
  for (const AuditFinding& found : input.audit.findings) {
    if (found.is_fault() != faults || rows++ >= kMostRows) continue;
    text += "  " + finding_words(input, found);
    if (found.worst_at) text += " (" + vertex_words(input, *found.worst_at) + ")";
    text += '\n';
  }
  if (rows > kMostRows) text += formatted("  ... and {} more (--json has all)\n", grouped(rows - kMostRows));
  if (text.empty()) return text;
  return (faults ? "\nFaults:\n" : "\nNotes:\n") + text;
}

std::string advice(const Audited& input) {
  if (input.audit.subjects.empty()) return "";
  if (input.audit.error.worst <= kAuditFault)
    return formatted("\nnothing to do: no normal is off by more than {:g} degree\n", kAuditFault);
  const auto& findings = input.audit.findings;
  const auto is_mark = [](const AuditFinding& found) {
    return found.kind == AuditFinding::Kind::kBaked || found.kind == AuditFinding::Kind::kSequenceTargets;
  };
  const auto has_extras = [&](const AuditFinding& found) { return is_mark(found) && found.count > 0; };
  if (std::any_of(findings.begin(), findings.end(), has_extras))
    return "\nthe file was baked before: what is off is not between keyframes; bake the original in another way\n";
  if (std::any_of(findings.begin(), findings.end(), is_mark))
    return "\nthe file was baked before, with one delta per target, which cannot be right throughout: bake the "
           "original "
           "with --encode exact\n";
  if (input.bake.empty())
    return "\nto have right normals at every instant: put the targets into a glTF file, and bake that\n";
  return formatted("\nto write normals that are right at every instant: chronormal bake {} -o baked.glb\n", input.bake);
}

}  // namespace

std::string worst_label(const Audited& input) {
  if (!input.audit.worst) return "";
  const AuditSubject& subject = input.audit.subjects[*input.audit.worst];
  return place_words(input, subject, subject.error.worst_at);
}

std::string worst_label(const Audited& input, const HostAudit& host) {
  return host.worst ? place_words(input, input.audit.subjects[*host.worst], host.error.worst_at) : "";
}

std::string unlit_label(const Audited& input) {
  const std::vector<AuditSubject>& subjects = input.audit.subjects;
  const auto first =
      std::find_if(subjects.begin(), subjects.end(), [](const AuditSubject& s) { return s.error.unlit > 0; });
  return first == subjects.end() ? "" : place_words(input, *first, first->error.unlit_at);
}

std::string audit_text(const Audited& input) {
  std::string text = headline(input);
  if (!input.audit.subjects.empty())
    text += host_table(input) + '\n' + subject_table(input) + '\n' + histogram(input.audit.error);
  return text + offset_lines(input) + finding_lines(input, true) + finding_lines(input, false) + advice(input);
}

}  // namespace chronormal::cli
