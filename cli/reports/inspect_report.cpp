#include "cli/reports/inspect_report.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"
#include "workflow/inspect/trouble.h"

namespace chronormal::cli {
namespace {

using Align = Table::Align;

constexpr std::size_t kLongestCell = 32;

// The smallest turn of a face that is reported, in radians. Faces that do not turn at all seem to turn a little,
// because their positions are rounded.
constexpr double kRoundedTurn = 1e-4;

std::string size_in_bytes(std::size_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value < 1e3) return counted(bytes, "byte", "bytes");
  if (value < 1e6) return formatted("{:.1f} kB", value / 1e3);
  if (value < 1e9) return formatted("{:.1f} MB", value / 1e6);
  return formatted("{:.1f} GB", value / 1e9);
}

std::string percent(double part, double whole) { return whole > 0 ? formatted("{:.1f}", 100 * part / whole) : "-"; }

std::string face_words(const Inspection& found) {
  const Surface& surface = found.surface;
  if (surface.triangles == found.faces) return counted(found.faces, "triangle", "triangles");
  std::string words = counted(found.faces, "face", "faces");
  words += formatted(" of up to {} corners", surface.most_corners);
  if (surface.triangles > 0) words += formatted(", {}", counted(surface.triangles, "triangle", "triangles"));
  return words;
}

std::string rows_left_out(std::size_t rows, const char* one, const char* many) {
  return rows > kMostRows ? formatted("... and {} (--json has all)\n", counted(rows - kMostRows, one, many)) : "";
}

std::string headline(const Inspected& input) {
  std::string text = heading(printable(input.name())) + ": ";
  if (!input.inspection) return text + "no faces\n";
  const Inspection& found = *input.inspection;
  text += counted(found.vertices, "vertex", "vertices") + ", " +
          counted(found.faces, found.surface.triangles == found.faces ? "triangle" : "face",
                  found.surface.triangles == found.faces ? "triangles" : "faces");
  if (found.segments.empty()) return text + ", no motion\n";
  if (input.has_targets()) return text + ", " + counted(found.segments.size(), "target", "targets") + '\n';
  return text + ", " + counted(found.keyframes, "keyframe", "keyframes") + ", " +
         counted(found.segments.size(), "segment", "segments") + '\n';
}

std::string fact(const char* what, const std::string& value) { return formatted("  {:<10}  {}\n", what, value); }

// Describes the numbers in the names of files: "5, numbered 0 to 0.2 in steps of 0.05, which are seconds".
std::string series_words(const FileSeries& series) {
  std::string words = formatted("{}, numbered {:.10g} to {:.10g} in steps of {:.6g}", grouped(series.count),
                                series.first, series.last, series.least_step);
  if (!series.is_even()) words += formatted(" to {:.6g}", series.most_step);
  return words + (series.are_seconds ? ", which are seconds" : "");
}

std::string facts_of(const Inspected& input) {
  const Inspection& found = *input.inspection;
  const Surface& surface = found.surface;
  std::string text;
  const auto add = [&text](const char* what, const std::string& value) { text += fact(what, value); };
  if (const std::optional<FileSeries>& series = input.opened->series()) add("files", series_words(*series));
  add("faces", face_words(found));
  add("surface",
      formatted("{}, {}; {} open", counted(surface.pieces, "piece", "pieces"), counted(surface.edges, "edge", "edges"),
                surface.open_edges.count == 0 ? "none" : grouped(surface.open_edges.count)));
  add("size", formatted("{:.5g}, the diagonal of the box {:.4g} x {:.4g} x {:.4g}", found.diagonal,
                        found.high.x - found.low.x, found.high.y - found.low.y, found.high.z - found.low.z));
  if (!found.segments.empty()) {
    if (!input.has_targets()) add("time", formatted("{:.6g} s to {:.6g} s", found.first_time, found.last_time));
    if (input.gltf && input.gltf->curve_error > 0)
      add("splines", formatted("cut into straight pieces, within {:.2g} of the true curves", input.gltf->curve_error));
    add("motion", found.motion.value == 0 ? "nothing moves"
                                          : formatted("up to {:.4g}, {} % of the size ({} in {})", found.motion.value,
                                                      percent(found.motion.value, found.diagonal),
                                                      vertex_label(input, found.motion.element),
                                                      segment_label(input, found.motion.segment)));
    add("turning", found.turn.value < kRoundedTurn
                       ? "no face turns"
                       : formatted("up to {:.1f} degrees ({} in {})", found.turn.value * kDegreesPerRadian,
                                   face_label(input, found.turn.element), segment_label(input, found.turn.segment)));
    const std::size_t pairs = found.faces * found.segments.size();
    add("memory", formatted("{} for keyframes, {} for exact normals of faces ({:.1f} bytes for each face and segment)",
                            size_in_bytes(found.keyframe_bytes), size_in_bytes(found.normal_bytes),
                            static_cast<double>(found.normal_bytes) / static_cast<double>(pairs)));
    if (found.flagged > 0)
      add("in double", formatted("{} of {}, for which float32 is not precise enough", grouped(found.flagged),
                                 counted(pairs, "normal", "normals")));
  } else {
    add("memory", size_in_bytes(found.keyframe_bytes) + " for positions");
  }
  return text;
}

std::string target_table(const Inspected& input) {
  const Inspection& found = *input.inspection;
  Table table;
  table.add_column("", "", Align::kRight);
  table.add_column("target", "", Align::kLeft);
  table.add_column("moved", "vertices", Align::kRight);
  table.add_column("motion", "% of size", Align::kRight);
  table.add_column("turning", "degrees", Align::kRight);
  table.add_column("beyond 90", "faces", Align::kRight);
  table.add_column("collapsing", "faces", Align::kRight);
  std::vector<double> turns;
  for (const SegmentInspection& segment : found.segments) turns.push_back(segment.turn.value);
  for (const std::size_t s : indices_of_largest(turns, kMostRows)) {
    const SegmentInspection& segment = found.segments[s];
    table.add_row({formatted("{}", s), printable(input.keyframe_names[input.segments[s].to], kLongestCell),
                   grouped(segment.moved_vertices), percent(segment.motion.value, found.diagonal),
                   formatted("{:.1f}", segment.turn.value * kDegreesPerRadian), grouped(segment.turned_far),
                   grouped(segment.collapses)});
  }
  return '\n' + table.text() + rows_left_out(found.segments.size(), "more that turns less", "more that turn less");
}

const char* mode_name(int mode) {
  constexpr const char* kNames[] = {"points", "lines", "line loop", "line strip", "triangles", "strip", "fan"};
  return mode >= 0 && mode <= 6 ? kNames[mode] : "unknown";
}

// Formats the number of moving targets that also change an attribute: "12 of 20", or "-" if no target moves.
std::string share_of(std::size_t count, std::size_t all) { return all == 0 ? "-" : formatted("{} of {}", count, all); }

std::string primitive_table(const InspectedGltf& gltf) {
  Table table;
  table.add_column("mesh", "primitive", Align::kLeft);
  table.add_column("faces", "", Align::kLeft);
  table.add_column("triangles", "", Align::kRight);
  table.add_column("vertices", "", Align::kRight);
  table.add_column("doubled", "vertices", Align::kRight);
  table.add_column("split", "normals", Align::kRight);
  table.add_column("base has", "", Align::kLeft);
  table.add_column("targets", "", Align::kRight);
  table.add_column("with", "normals", Align::kRight);
  table.add_column("with", "tangents", Align::kRight);
  std::vector<GltfPrimitiveInspection> primitives = gltf.inspection.primitives;
  if (primitives.size() > kMostRows)
    std::stable_partition(primitives.begin(), primitives.end(), [](const auto& each) { return each.moving > 0; });
  for (std::size_t i = 0; i < std::min(primitives.size(), kMostRows); ++i) {
    const GltfPrimitiveInspection& found = primitives[i];
    const GltfMesh& mesh = gltf.document->meshes()[found.mesh];
    const GltfPrimitive& primitive = mesh.primitives[found.primitive];
    const std::string name = mesh.name.empty() ? formatted("mesh {}", found.mesh) : printable(mesh.name, kLongestCell);
    std::string has = primitive.has_normals ? "normals" : "positions";
    if (primitive.has_tangents) has += ", tangents";
    std::string mode = mode_name(primitive.mode);
    if (primitive.has_draco) mode += ", Draco";
    table.add_row({formatted("{} / {}", name, found.primitive), std::move(mode), grouped(found.triangles),
                   grouped(primitive.vertex_count), grouped(found.doubled),
                   primitive.has_normals ? grouped(found.split) : "-", std::move(has), grouped(mesh.target_count),
                   share_of(found.moving_normals, found.moving), share_of(found.moving_tangents, found.moving)});
  }
  return '\n' + table.text() + rows_left_out(primitives.size(), "more primitive", "more primitives");
}

std::string named_or_numbered(const std::string& name, const char* kind, std::size_t number) {
  return name.empty() ? formatted("{} {}", kind, number) : printable(name, kLongestCell);
}

// Formats a weight with two decimals. Exporters compute weights, so a weight of 0 or 1 may be stored as a slightly
// different number.
std::string weight_cell(double weight) {
  std::string text = formatted("{:.2f}", weight);
  return text == "-0.00" ? "0.00" : text;
}

std::string track_table(const InspectedGltf& gltf) {
  const GltfDocument& document = *gltf.document;
  const auto& tracks = gltf.inspection.tracks;
  if (document.animations().empty()) return "";
  const std::size_t silent =
      static_cast<std::size_t>(std::count_if(document.animations().begin(), document.animations().end(),
                                             [](const GltfAnimation& animation) { return animation.tracks.empty(); }));
  std::string rest;
  if (silent > 0)
    rest =
        formatted("{}{} no weights, and {} any morph target\n", tracks.empty() ? "\n" : "",
                  counted(silent, "animation has", "animations have"), silent == 1 ? "does not move" : "do not move");
  if (tracks.empty()) return rest;
  Table table;
  table.add_column("animation", "", Align::kLeft);
  table.add_column("weights of", "node", Align::kLeft);
  table.add_column("interpolation", "", Align::kLeft);
  table.add_column("keys", "", Align::kRight);
  table.add_column("from", "s", Align::kRight);
  table.add_column("to", "s", Align::kRight);
  table.add_column("lowest", "weight", Align::kRight);
  table.add_column("highest", "weight", Align::kRight);
  std::size_t rows = 0;
  for (std::size_t first = 0, next = 0; first < tracks.size(); first = next) {
    // Tracks of one animation that have the same description share a row.
    GltfTrackInspection all = tracks[first];
    const auto described = [&document](const GltfTrackInspection& each) -> const GltfTrack& {
      return document.animations()[each.animation].tracks[each.track];
    };
    const GltfTrack& track = described(all);
    for (next = first + 1; next < tracks.size(); ++next) {
      const GltfTrackInspection& other = tracks[next];
      if (other.animation != all.animation || other.first_time != all.first_time || other.last_time != all.last_time ||
          described(other).key_count != track.key_count || described(other).interpolation != track.interpolation)
        break;
      all.lowest = std::min(all.lowest, other.lowest);
      all.highest = std::max(all.highest, other.highest);
    }
    if (++rows > kMostRows) continue;
    std::string nodes = named_or_numbered(document.nodes()[track.node].name, "node", track.node);
    if (next - first > 1) nodes += formatted(" and {} more", grouped(next - first - 1));
    table.add_row({named_or_numbered(document.animations()[all.animation].name, "animation", all.animation),
                   std::move(nodes), interpolation_name(track.interpolation), grouped(track.key_count),
                   formatted("{:.4g}", all.first_time), formatted("{:.4g}", all.last_time), weight_cell(all.lowest),
                   weight_cell(all.highest)});
  }
  return '\n' + table.text() + rows_left_out(rows, "more row of tracks", "more rows of tracks") + rest;
}

std::string gltf_contents(const InspectedGltf& gltf) {
  const GltfDocument& document = *gltf.document;
  std::size_t primitives = 0, carriers = 0;
  for (const GltfMesh& mesh : document.meshes()) primitives += mesh.primitives.size();
  for (const std::size_t instances : gltf.inspection.instances) carriers += instances;
  return formatted("{}, {}, {} with a mesh, {}", counted(document.meshes().size(), "mesh", "meshes"),
                   counted(primitives, "primitive", "primitives"), counted(carriers, "node", "nodes"),
                   counted(document.animations().size(), "animation", "animations"));
}

std::size_t count_left_out(const InspectedGltf& gltf) {
  std::set<std::pair<std::size_t, std::size_t>> parts;
  for (const GltfPart& part : gltf.parts) parts.emplace(part.mesh, part.primitive);
  return gltf.inspection.primitives.size() - parts.size();
}

std::string extension_list(const GltfDocument& document) {
  std::string text;
  for (const std::string& extension : document.extensions())
    text += (text.empty() ? "" : ", ") + printable(extension, kLongestCell + kLongestCell);
  return text;
}

}  // namespace

std::string inspect_text(const Inspected& input) {
  std::string text = headline(input) + '\n';
  if (input.gltf) {
    text += fact("file", gltf_contents(*input.gltf));
    if (const std::string list = extension_list(*input.gltf->document); !list.empty()) text += fact("extensions", list);
    if (const std::size_t still = count_left_out(*input.gltf); still > 0)
      text += fact("still", counted(still, "primitive", "primitives") + " that do not move, which are left out below");
  }
  if (input.inspection) text += facts_of(input);
  if (input.gltf && !input.gltf->inspection.primitives.empty()) text += primitive_table(*input.gltf);
  if (input.has_targets() && input.inspection) text += target_table(input);
  if (input.gltf) text += track_table(*input.gltf);

  const std::vector<Trouble> troubles = find_trouble(input);
  const std::vector<std::string> notes = input.opened->notes();
  if (!notes.empty()) text += '\n' + heading("How the input was read:") + '\n';
  for (const std::string& note : notes) text += "  " + printable(note) + '\n';
  if (troubles.empty()) return text + (notes.empty() ? "\nno problems found\n" : "");
  text += '\n' + heading("What can make normals wrong:") + '\n';
  for (const Trouble& trouble : troubles) {
    text += "  " + trouble.what;
    if (!trouble.where.empty()) text += formatted(" ({}{})", trouble.count > 1 ? "first: " : "", trouble.where);
    text += "\n    " + trouble.meaning + '\n';
  }
  return text;
}

}  // namespace chronormal::cli
