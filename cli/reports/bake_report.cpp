// Formats the result of `bake` as tables and lists.
#include "cli/reports/bake_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/weighting.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

std::string headline(const BakeReport& report) {
  return formatted("{} -> {}\n", heading(printable(report.input)), heading(printable(report.output)));
}

std::string mesh_name(const BakedMesh& mesh) {
  return mesh.name.empty() ? formatted("mesh {}", mesh.mesh) : printable(mesh.name, kLongestName);
}

// Returns the largest error, in degrees, of the deltas against the normals that they encode. The bake computes this
// error for its targets and its resampled animations. An audit, in contrast, judges everything that is rendered.
double fit_error(const BakedMesh& mesh) { return mesh.largest_error + mesh.resampling_error; }

// Returns the cells of a table row for a mesh: its worst errors before and after the bake. If there was no audit,
// returns one cell with the error of the deltas.
std::vector<std::string> error_cells(const BakedMesh& mesh, const BakeReport& report) {
  if (!report.audit) return {mesh.elements == 0 ? "" : four_decimals(fit_error(mesh))};
  const MotionError before = error_of_mesh(report.audit->before, mesh.mesh),
                    after = error_of_mesh(report.audit->after, mesh.mesh);
  return {four_decimals(before.worst), four_decimals(after.worst)};
}

void add_row(const BakedMesh& mesh, const BakeReport& report, Table& table) {
  std::vector<std::string> cells = {mesh_name(mesh)};
  if (mesh.already_baked)
    cells.insert(cells.end(), {"baked before", "", "", ""});
  else if (mesh.elements == 0)
    cells.insert(cells.end(), {"stays flat", "", "", ""});
  else
    cells.insert(cells.end(), {std::string(name_of(mesh.encoding)), grouped(mesh.elements), grouped(mesh.extras.size()),
                               grouped(mesh.bytes)});
  for (std::string& cell : error_cells(mesh, report)) cells.push_back(std::move(cell));
  table.add_row(std::move(cells));
}

std::string change(double before, double after) { return four_decimals(before) + " -> " + four_decimals(after); }

// Returns the errors before and after the bake in words, "on average 3.2000 -> 0.0001, at worst 12.3000 -> 0.0010
// degrees", and the number of normals that a viewer cannot light.
std::string change_words(const BeforeAndAfter& audit) {
  const MotionError &before = audit.before.error, &after = audit.after.error;
  std::string text = formatted("on average {}, at worst {} degrees", change(before.mean(), after.mean()),
                               change(before.worst, after.worst));
  if (before.unlit + after.unlit > 0)
    text += formatted(", {} -> {} that are zero, infinite or NaN", grouped(before.unlit),
                      counted(after.unlit, "normal", "normals"));
  return text;
}

// Returns lines that list the meshes whose baked normals have a weighting other than area.
std::string weighting_lines(const GltfBake& bake) {
  std::string text;
  for (const WeightingInfo& info : kAllWeightings) {
    std::string names;
    std::size_t count = 0;
    constexpr std::size_t kMostNamed = 4;
    for (const BakedMesh& mesh : bake.meshes) {
      if (mesh.already_baked || mesh.elements == 0 || mesh.weighting != info.weighting) continue;
      if (++count <= kMostNamed) names.append(count > 1 ? ", " : "").append(mesh_name(mesh));
    }
    if (count == 0 || info.weighting == Weighting::kArea) continue;
    if (count > kMostNamed) names += " and " + counted(count - kMostNamed, "more mesh", "more meshes");
    text += formatted(
        "{}: normals are {}-weighted, and could only be approximated; only area-weighted normals (--weighting area) "
        "can be exact\n",
        names, info.name);
  }
  return text;
}

void add_errors(const ShownErrors& of_mesh, ShownErrors& all) {
  const double sum = all.mean * static_cast<double>(all.judged) + of_mesh.mean * static_cast<double>(of_mesh.judged);
  all.judged += of_mesh.judged;
  all.mean = all.judged > 0 ? sum / static_cast<double>(all.judged) : 0;
  all.most = std::max(all.most, of_mesh.most);
  all.worst = std::max(all.worst, of_mesh.worst);
  for (std::size_t k = 0; k < all.tears.size(); ++k) all.tears[k] += of_mesh.tears[k];
  all.poses += of_mesh.poses;
}

// Returns true if the chosen candidate of a mesh has deltas that are fitted to the animations.
bool is_of_animations(const BakedMesh& mesh) {
  return std::any_of(mesh.candidates.begin(), mesh.candidates.end(),
                     [](const BakedCandidate& choice) { return choice.chosen && choice.animations_only; });
}

// The errors that one viewer shows, over all samples: average and largest error in degrees, and torn edges.
struct Shown {
  double mean = 0, worst = 0, torn_edges = 0;
};

Shown shown_of(const MotionError& error) { return {error.mean(), error.worst, error.torn_edges()}; }

Shown shown_of(const ShownErrors& errors) { return {errors.mean, errors.worst, errors.torn_edges()}; }

// The errors of one viewer before and after the bake.
struct ViewerRow {
  const Viewer* viewer = nullptr;
  Shown before, after;
  bool is_named = true, is_better = false;
};

// Returns the errors that bake itself measured for each viewer, over the poses of some meshes: if of_animations is
// true, the meshes whose deltas are fitted to the animations, otherwise all other meshes. The averages cover fewer
// samples than those of an audit.
std::vector<ViewerRow> measured_rows(const GltfBake& bake, bool of_animations) {
  std::vector<ViewerRow> rows;
  for (const Viewer& viewer : kViewers) {
    ViewerRow row{&viewer, {}, {}};
    ShownErrors before, after;
    for (const BakedMesh& mesh : bake.meshes) {
      for (const ViewerChange& change : mesh.viewers) {
        if (change.viewer != viewer.name || is_of_animations(mesh) != of_animations) continue;
        for (const ViewerChange::Errors& of_kind : change.poses) {
          if (of_kind.before.judged == 0) continue;
          add_errors(of_kind.before, before);
          add_errors(of_kind.after, after);
        }
        row.is_named = change.is_named;
        row.is_better |= change.is_better;
      }
    }
    row.before = shown_of(before);
    row.after = shown_of(after);
    if (before.judged > 0) rows.push_back(row);
  }
  return rows;
}

// Returns for each viewer the errors by which the report judges the baked file: the errors of the audits, if there are
// audits and no deltas are fitted to the animations alone, or else the errors that bake measured.
std::vector<ViewerRow> viewer_rows(const GltfBake& bake, const BakeReport& report, bool of_animations) {
  std::vector<ViewerRow> rows = measured_rows(bake, of_animations);
  if (!report.audit || any_of_animations(bake)) return rows;
  const std::vector<ViewerAudit>&before = report.audit->before.viewers, &after = report.audit->after.viewers;
  for (ViewerRow& row : rows) {
    for (std::size_t h = 0; h < std::min(before.size(), after.size()); ++h) {
      if (before[h].viewer.name != row.viewer->name) continue;
      row.before = shown_of(before[h].error);
      row.after = shown_of(after[h].error);
    }
  }
  return rows;
}

// Formats an average number of torn edges in a pose: "1,234", or "0.7" if there are few.
std::string torn(double edges) {
  if (edges < 10 && edges > 0) return formatted("{:.1g}", std::max(edges, 0.1));
  return grouped(static_cast<std::size_t>(std::lround(edges)));
}

// Returns true if the correction targets of a mesh follow its own weights. An audit of a single slider then takes them
// as driven, which only a program does.
bool any_to_drive(const GltfBake& bake) {
  return std::any_of(bake.meshes.begin(), bake.meshes.end(), [](const BakedMesh& mesh) {
    return mesh.encoding != BakeEncoding::kSmallest &&
           std::any_of(mesh.extras.begin(), mesh.extras.end(),
                       [](const GltfExtraTarget& extra) { return !extra.linear.empty() || !extra.quadratic.empty(); });
  });
}

std::string poses_words(const GltfBake& bake, bool of_animations) {
  if (of_animations) return "in the animations of the file (--animations-only does not correct single sliders)";
  std::string text = "in the animations of the file, and with each slider alone";
  if (any_to_drive(bake)) text += " while a program drives the correction targets";
  return text;
}

std::string viewers_table(const GltfBake& bake, const BakeReport& report, bool of_animations) {
  const std::vector<ViewerRow> rows = viewer_rows(bake, report, of_animations);
  if (rows.empty()) return "";
  Table table;
  table.add_column("viewer", "", Table::Align::kLeft);
  table.add_column("average", "degrees", Table::Align::kRight);
  table.add_column("after", "", Table::Align::kRight);
  table.add_column("worst", "", Table::Align::kRight);
  table.add_column("after", "", Table::Align::kRight);
  table.add_column("torn edges", "", Table::Align::kRight);
  table.add_column("after", "", Table::Align::kRight);
  for (const ViewerRow& row : rows)
    table.add_row({std::string(row.viewer->title), four_decimals(row.before.mean), four_decimals(row.after.mean),
                   four_decimals(row.before.worst), four_decimals(row.after.worst), torn(row.before.torn_edges),
                   torn(row.after.torn_edges)});
  return formatted("\nerrors {}:\n\n{}\n", poses_words(bake, of_animations), table.text());
}

std::string viewers_text(const GltfBake& bake, const BakeReport& report) {
  return viewers_table(bake, report, false) + viewers_table(bake, report, true);
}

std::string titles_of(const std::vector<ViewerRow>& rows) {
  std::string text;
  for (const ViewerRow& row : rows) text.append(text.empty() ? "" : ", ").append(row.viewer->title);
  return text;
}

// Returns the row with the largest average error after the bake.
const ViewerRow& worst_of(const std::vector<ViewerRow>& rows) {
  return *std::max_element(rows.begin(), rows.end(),
                           [](const ViewerRow& a, const ViewerRow& b) { return a.after.mean < b.after.mean; });
}

std::string rounded_change(double before, double after) { return formatted("{:.3g} -> {:.3g}", before, after); }

// Returns the first lines of the report: how much better the file is and in which viewers, and how much larger.
std::string verdict(const GltfBake& bake, const BakeReport& report) {
  std::vector<ViewerRow> better, left_out, others;
  for (const bool of_animations : {false, true})
    for (const ViewerRow& row : viewer_rows(bake, report, of_animations))
      (!row.is_named ? others : row.is_better ? better : left_out).push_back(row);
  if (better.empty()) return "";
  const Shown before = worst_of(better).before, after = worst_of(better).after;
  std::string text = formatted("errors in {}: on average {} degrees, at worst {}", titles_of(better),
                               rounded_change(before.mean, after.mean), rounded_change(before.worst, after.worst));
  if (before.torn_edges + after.torn_edges > 0)
    text += after.torn_edges == 0 ? ", no torn edges left"
                                  : formatted(", torn edges {} -> {}", torn(before.torn_edges), torn(after.torn_edges));
  if (bake.bytes_of_file > 0) {
    const auto size = static_cast<double>(bake.bytes_of_file + bake.added_bytes - bake.left_out_bytes);
    text += formatted("; the file is {:.2f} times as large", size / static_cast<double>(bake.bytes_of_file));
  }
  text += '\n';
  // Viewers with the same figures share a line.
  const auto add_others = [&](const std::vector<ViewerRow>& rows, const char* words) {
    std::vector<std::pair<std::string, std::vector<ViewerRow>>> lines;
    for (const ViewerRow& row : rows) {
      const std::string figures =
          formatted("on average {} degrees, at worst {}", rounded_change(row.before.mean, row.after.mean),
                    rounded_change(row.before.worst, row.after.worst));
      const auto line =
          std::find_if(lines.begin(), lines.end(), [&](const auto& other) { return other.first == figures; });
      (line == lines.end() ? lines.emplace_back(figures, std::vector<ViewerRow>{}) : *line).second.push_back(row);
    }
    for (const auto& [figures, alike] : lines) text += formatted("{}{}: {}\n", words, titles_of(alike), figures);
  };
  add_others(others, "errors in ");
  add_others(left_out, "not all errors became smaller in ");
  others.insert(others.end(), left_out.begin(), left_out.end());
  std::erase_if(others, [](const ViewerRow& row) {
    constexpr double kManyMore = 1.1;
    return row.after.mean <= row.before.mean + kHarmlessTolerance &&
           row.after.torn_edges <= kManyMore * row.before.torn_edges + 1;
  });
  if (!others.empty())
    text += formatted(
        "the average error or the number of torn edges grew in {}; if the file is shown there, bake the original file "
        "with --for {}\n",
        titles_of(others), others.front().viewer->name);
  return text;
}

// Returns a text about the errors that remain in the viewers for which the file is made, with a remedy.
std::string left_over(const GltfBake& bake) {
  double worst = 0;
  for (const BakedMesh& mesh : bake.meshes)
    for (const BakedCandidate& choice : mesh.candidates)
      for (const ViewerChange& change : choice.viewers)
        if (choice.chosen && !choice.within && change.is_named && change.is_better)
          worst = std::max(worst, change.poses[0].after.worst);
  if (worst <= kHarmlessTolerance) return "";
  return formatted(
      "errors of up to {} remain in the animations; --tolerance {} spends the bytes that smaller errors need\n",
      with_degrees(with_digits(worst, 3)), kHarmlessTolerance);
}

// Returns a text about the number of correction targets that bake left out, and the reason.
std::string left_text(const GltfBake& bake) {
  std::size_t left_out = 0;
  for (const BakedMesh& mesh : bake.meshes) left_out += mesh.left_out;
  std::string text;
  if (left_out > 0)
    text += counted(left_out,
                    "correction target that would help least was left out, since one of the viewers that the file is "
                    "made for has no room for more\n",
                    "correction targets that would help least were left out, since one of the viewers that the file is "
                    "made for has no room for more\n");
  return text;
}

// Returns true if bake found a candidate within the tolerance for every mesh.
bool are_all_within(const GltfBake& bake) {
  return std::all_of(bake.meshes.begin(), bake.meshes.end(), [](const BakedMesh& mesh) {
    return std::any_of(mesh.candidates.begin(), mesh.candidates.end(),
                       [](const BakedCandidate& choice) { return choice.chosen && choice.within; });
  });
}

std::string title_of_viewer(const std::string& name) {
  for (const Viewer& viewer : kViewers)
    if (viewer.name == name) return std::string(viewer.title);
  return name;
}

std::string name_of(const BakedCandidate& choice) {
  return std::string(choice.name) + (choice.animations_only ? ", animations only" : "");
}

// Returns a table with a row for each viewer and each candidate. If of_animations is true, the candidates are those
// whose deltas are fitted to the animations, otherwise all other candidates.
std::string plan_of_viewers(const GltfBake& bake, bool of_animations) {
  Table table;
  table.add_column("mesh", "", Table::Align::kLeft);
  table.add_column("candidate", "", Table::Align::kLeft);
  table.add_column("viewer", "", Table::Align::kLeft);
  table.add_column("average", "degrees", Table::Align::kRight);
  table.add_column("99.9 %", "", Table::Align::kRight);
  table.add_column("worst", "", Table::Align::kRight);
  bool any = false;
  for (const BakedMesh& mesh : bake.meshes) {
    for (const BakedCandidate& choice : mesh.candidates) {
      if (choice.animations_only != of_animations) continue;
      for (const ViewerChange& viewer : choice.viewers) {
        ShownErrors errors;
        for (const ViewerChange::Errors& of_kind : viewer.poses)
          if (of_kind.before.judged > 0 || !choice.animations_only) add_errors(of_kind.after, errors);
        table.add_row({mesh_name(mesh), name_of(choice), title_of_viewer(viewer.viewer), four_decimals(errors.mean),
                       four_decimals(errors.most), four_decimals(errors.worst)});
        any = true;
      }
    }
  }
  return any ? formatted("\nerrors {}:\n\n{}", poses_words(bake, of_animations), table.text()) : "";
}

// Returns in words the respects in which the errors after a bake are worse or better, with figures: "on average (0.6400
// degrees, before 3.3200)".
std::string respects_text(const WorseRespects& respects, const BeforeAndAfter& audit) {
  const MotionError &before = audit.before.error, &after = audit.after.error;
  std::string text;
  const auto add = [&](const std::string& words) { text.append(text.empty() ? "" : ", and ").append(words); };
  if (respects.mean)
    add(formatted("on average ({} degrees, before {})", four_decimals(after.mean()), four_decimals(before.mean())));
  if (respects.worst)
    add(formatted("in its worst error ({} degrees, before {})", four_decimals(after.worst),
                  four_decimals(before.worst)));
  if (respects.torn)
    add(formatted("in its torn edges ({}, before {})", torn(after.torn_edges()), torn(before.torn_edges())));
  if (respects.unlit)
    add(formatted("in its normals that are zero, infinite or NaN ({}, before {})", grouped(after.unlit),
                  grouped(before.unlit)));
  return text;
}

std::string lines_after(const BakeReport& report) {
  std::string text;
  if (report.drivers_file)
    text += formatted("{} says how to drive the correction targets\n", printable(*report.drivers_file));
  if (!report.audit) return text;
  text += formatted("all errors before -> after: {}\n", change_words(*report.audit));
  double skinning = 0;
  for (const AuditFinding& finding : report.audit->after.findings)
    if (finding.kind == AuditFinding::Kind::kSkinned) skinning = std::max(skinning, finding.degrees);
  if (skinning > kAuditFault)
    text +=
        formatted("skinning turns even true normals by up to {:.2f} degrees, which no file can correct\n", skinning);
  return text;
}

// Returns words that limit a claim about true normals. The claim is about the normals of the straight pieces, which
// differ from those of the original curves by up to the tolerance of the cut.
std::string beside_curves(const SequenceBake& bake) {
  if (!bake.cut) return "";
  return formatted(" of the straight pieces, which are within {} of the curves",
                   with_degrees(with_digits(bake.cut->path.tolerance, 6)));
}

}  // namespace

std::string worse_text(const BeforeAndAfter& audit, bool of_animations) {
  const MotionError &before = audit.before.error, &after = audit.after.error;
  const WorseRespects worse = find_worse(after, before), better = find_worse(before, after);
  std::string text = "the result is ";
  if (better.any()) text += "better than the input " + respects_text(better, audit) + ", but ";
  text += (better.any() ? "worse " : "worse than the input ") + respects_text(worse, audit);
  if (of_animations) text += "; these errors include single sliders, which --animations-only does not correct";
  return text;
}

bool any_of_animations(const GltfBake& bake) {
  return std::any_of(bake.meshes.begin(), bake.meshes.end(), is_of_animations);
}

std::string bake_text(const GltfBake& bake, const BakeReport& report) {
  std::string text = headline(report);
  if (!bake.changed) {
    bool any_baked = false;
    for (const BakedMesh& mesh : bake.meshes) any_baked |= mesh.already_baked;
    if (any_baked) {
      return text +
             "nothing was changed, since this file was baked before. For smaller errors, bake the ORIGINAL file\n";
    }
    if (bake.meshes.empty())
      return text +
             "nothing was changed, since no morph target moves a face; if one should, export the model again with "
             "morph targets\n";
    return text + (are_all_within(bake)
                       ? "nothing was changed, since all normals are within the tolerance\n"
                       : "nothing was changed, since every candidate makes some error larger; --plan lists the "
                         "candidates, and --for VIEWER or --encode endpoint may help\n");
  }
  text += verdict(bake, report);
  Table table;
  table.add_column("mesh", "", Table::Align::kLeft);
  table.add_column("encoding", "", Table::Align::kLeft);
  table.add_column("normals", "", Table::Align::kRight);
  table.add_column("correction", "targets", Table::Align::kRight);
  table.add_column("deltas", "bytes", Table::Align::kRight);
  if (report.audit) {
    table.add_column("before", "degrees", Table::Align::kRight);
    table.add_column("after", "at worst", Table::Align::kRight);
  } else {
    table.add_column("fit", "degrees", Table::Align::kRight);
  }
  for (const BakedMesh& mesh : bake.meshes) add_row(mesh, report, table);
  text.append("\n").append(table.text()).append("\n");
  text += formatted("{} and {} were added", counted(bake.added_targets, "target", "targets"),
                    counted(bake.added_bytes, "byte of data", "bytes of data"));
  if (bake.left_out_bytes > 0)
    text += formatted("; {} left out", counted(bake.left_out_bytes, "byte of data that is no longer used was",
                                               "bytes of data that are no longer used were"));
  if (bake.converted_tracks > 0)
    text += formatted("; {} now", counted(bake.converted_tracks, "animation of weights is a cubic spline",
                                          "animations of weights are cubic splines"));
  text += '\n';
  text += weighting_lines(bake);
  std::size_t fitted = 0;
  for (const BakedMesh& mesh : bake.meshes) fitted += mesh.fitted_elements;
  if (fitted > 0)
    text += "the deltas of " +
            counted(fitted, "normal that several targets move at once", "normals that several targets move at once") +
            " were fitted to the weights that the file uses\n";
  std::size_t tangents = 0;
  for (const BakedMesh& mesh : bake.meshes) tangents += mesh.new_tangents;
  if (tangents > 0)
    text += counted(tangents, "target has new tangents, since the", "targets have new tangents, since the") +
            " old tangents did not fit the normals\n";
  return text + left_text(bake) + viewers_text(bake, report) + left_over(bake) + lines_after(report);
}

std::string plan_text(const GltfBake& bake, const BakeReport& report) {
  Table table;
  table.add_column("mesh", "", Table::Align::kLeft);
  table.add_column("candidate", "", Table::Align::kLeft);
  table.add_column("targets", "", Table::Align::kRight);
  table.add_column("deltas", "bytes", Table::Align::kRight);
  table.add_column("average", "degrees", Table::Align::kRight);
  table.add_column("worst", "", Table::Align::kRight);
  table.add_column("", "", Table::Align::kLeft);
  for (const BakedMesh& mesh : bake.meshes) {
    for (const BakedCandidate& choice : mesh.candidates) {
      const bool is_smallest = choice.chosen && choice.within;
      table.add_row({mesh_name(mesh), name_of(choice), grouped(choice.targets), grouped(choice.bytes),
                     four_decimals(choice.played.mean), four_decimals(choice.played.worst),
                     is_smallest     ? "recommended"
                     : choice.chosen ? "closest"
                                     : ""});
    }
  }
  return formatted("{}: bake can choose from these candidates, which --plan lists without writing a file\n\n",
                   printable(report.input)) +
         table.text() + plan_of_viewers(bake, false) + plan_of_viewers(bake, true);
}

std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report) {
  std::string text = headline(report);
  text += formatted("{}, {}: {} and {}, {}\n", counted(bake.keyframes, "keyframe", "keyframes"),
                    counted(bake.vertices, "vertex", "vertices"), counted(bake.targets, "target", "targets"),
                    counted(bake.extra_targets, "correction target", "correction targets"),
                    counted(bake.bytes, "byte", "bytes"));
  if (bake.weighting != Weighting::kArea)
    text += formatted("normals are {}-weighted, like the stored normals\n", weighting_name(bake.weighting));
  if (bake.has_offsets)
    text += "where the stored normals of keyframe 0 differ from the surface, that difference is kept\n";
  if (bake.keys) {
    text += formatted("{}, {} of them between keyframes; {} left out; at equal steps of time, {} would be needed\n",
                      counted(bake.keys->count, "key", "keys"), grouped(bake.keys->in_between),
                      counted(bake.keys->left_out, "keyframe was", "keyframes were"),
                      counted(bake.keys->even, "key", "keys"));
    text += formatted("the error is at most {} degrees{} at every instant{} (certified)\n",
                      four_decimals(bake.largest_error), bake.cut ? " from the straight pieces" : "",
                      bake.keys->beyond > 0 ? ", except where a normal vanishes or turns too fast" : "");
    if (bake.cut)
      text += formatted(
          "normals are at most {} degrees from the normals on the curved paths, except where faces almost vanish\n",
          four_decimals(bake.largest_error + bake.cut->path.tolerance));
  } else if (encoding == BakeEncoding::kExact && bake.largest_error == 0) {
    bool are_all_known = bake.without_normals == 0;
    if (report.audit) {
      const Audit& after = report.audit->after;
      are_all_known = after.is_judged() && after.error.cancelled == 0 && after.error.unlit == 0;
    }
    text += are_all_known ? "the normals are exact at every instant" + beside_curves(bake) + '\n'
                          : "the normals are exact, except around some vertices where the normals of faces cancel each "
                            "other or no face has an area\n";
  } else
    text +=
        formatted("{}: the error is at most {} degrees, {}\n",
                  encoding == BakeEncoding::kExact ? "fitted" : name_of(encoding), four_decimals(bake.largest_error),
                  encoding == BakeEncoding::kHarmless ? "measured at 40 moments of each segment" : "which is proven");
  return text + lines_after(report);
}

}  // namespace chronormal::cli
