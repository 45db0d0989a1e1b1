#include "cli/bake_report.h"

#include <fmt/core.h>

#include "cli/json.h"
#include "cli/table.h"
#include "cli/text.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kLongestName = 32;

std::string headline(const BakeReport& report) {
  return fmt::format("{} -> {}\n", printable(report.input), printable(report.output));
}

// The error that a mesh is left with: that of its targets, and of what its animations were brought into.
double stated_error(const BakedMesh& mesh) { return mesh.largest_error + mesh.resampling_error; }

void add_row(const BakedMesh& mesh, Table& table) {
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", mesh.mesh) : printable(mesh.name, kLongestName);
  if (mesh.already_baked) {
    table.add_row({name, "baked before", "", "", "", ""});
  } else if (mesh.elements == 0) {
    table.add_row({name, "stays flat", "", "", "", ""});
  } else {
    table.add_row({name, std::string(name_of(mesh.encoding)), grouped(mesh.elements), grouped(mesh.extras.size()),
                   grouped(mesh.bytes), four_decimals(stated_error(mesh))});
  }
}

std::string lines_after(const BakeReport& report) {
  std::string text;
  if (report.drivers_file)
    text += fmt::format("what a host must compute for the extra targets is in {}\n", printable(*report.drivers_file));
  if (report.audit) {
    const auto& [before, after] = *report.audit;
    text += fmt::format("by audit: worst {} -> {}, mean {} -> {} degrees\n", four_decimals(before.worst),
                        four_decimals(after.worst), four_decimals(before.mean()), four_decimals(after.mean()));
  }
  return text;
}

Json common_json(const BakeReport& report) {
  Json json = json_of_command("bake");
  json["input"] = {{"name", report.input}};
  json["output"] = report.output;
  return json;
}

Json mesh_json(const BakedMesh& mesh) {
  Json extras = Json::array();
  for (const GltfExtraTarget& extra : mesh.extras)
    extras.push_back({{"target", extra.target}, {"factors", {extra.i, extra.j}}});
  return {{"mesh", mesh.mesh},
          {"name", mesh.name},
          {"encoding", name_of(mesh.encoding)},
          {"already_baked", mesh.already_baked},
          {"different_normals", mesh.elements},
          {"extra_targets", std::move(extras)},
          {"bytes", mesh.bytes},
          {"undriven_targets", mesh.undriven},
          {"flat_primitives", mesh.left_flat},
          {"vertices_without_base", mesh.without_base},
          {"vertices_without_stored_normal", mesh.without_stored},
          {"fitted_normals", mesh.fitted_elements},
          {"target_error_degrees", mesh.largest_error},
          {"track_error_degrees", mesh.resampling_error}};
}

void add_audit(const BakeReport& report, Json& json) {
  if (!report.audit) return;
  const auto& [before, after] = *report.audit;
  json["audit"] = {{"worst_degrees_before", before.worst},
                   {"worst_degrees_after", after.worst},
                   {"mean_degrees_before", before.mean()},
                   {"mean_degrees_after", after.mean()}};
}

}  // namespace

std::string bake_text(const GltfBake& bake, const BakeReport& report) {
  std::string text = headline(report);
  if (!bake.changed) {
    bool any_baked = false;
    for (const BakedMesh& mesh : bake.meshes) any_baked |= mesh.already_baked;
    if (any_baked) {
      return text +
             "nothing to bake: it was baked before; the output is as the input. To bake it in another way, start from "
             "the original\n";
    }
    return text + (bake.meshes.empty()
                       ? "nothing to bake: no morph target moves a vertex of a face; the output is as the input\n"
                       : "nothing to bake: the output is as the input\n");
  }
  Table table;
  table.add_column("mesh", "", Table::Align::kLeft);
  table.add_column("encoding", "", Table::Align::kLeft);
  table.add_column("normals", "", Table::Align::kRight);
  table.add_column("extra targets", "", Table::Align::kRight);
  table.add_column("deltas", "bytes", Table::Align::kRight);
  table.add_column("error", "degrees", Table::Align::kRight);
  for (const BakedMesh& mesh : bake.meshes) add_row(mesh, table);
  text.append("\n").append(table.text()).append("\n");
  text += fmt::format("{} and {} were added", counted(bake.added_targets, "target", "targets"),
                      counted(bake.added_bytes, "byte of arrays", "bytes of arrays"));
  if (bake.converted_tracks > 0)
    text += fmt::format("; {} now", counted(bake.converted_tracks, "weight track is a cubic spline",
                                            "weight tracks are cubic splines"));
  text += '\n';
  std::size_t fitted = 0;
  for (const BakedMesh& mesh : bake.meshes) fitted += mesh.fitted_elements;
  if (fitted > 0)
    text += counted(fitted, "normal that several targets move at once has deltas",
                    "normals that several targets move at once have deltas") +
            " fitted to the weights of the file\n";
  return text + lines_after(report);
}

std::string bake_text(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report) {
  std::string text = headline(report);
  text += fmt::format("{}, {}: {} and {}, {}\n", counted(bake.keyframes, "keyframe", "keyframes"),
                      counted(bake.vertices, "vertex", "vertices"), counted(bake.targets, "target", "targets"),
                      counted(bake.extra_targets, "extra one", "extra ones"), counted(bake.bytes, "byte", "bytes"));
  if (encoding == BakeEncoding::kExact && bake.largest_error == 0)
    text += "exact at every instant\n";
  else
    text +=
        fmt::format("{}: at most {} degrees from the right normals, as far as can be proven\n",
                    encoding == BakeEncoding::kExact ? "fitted" : name_of(encoding), four_decimals(bake.largest_error));
  return text + lines_after(report);
}

std::string bake_json(const GltfBake& bake, const BakeReport& report) {
  Json json = common_json(report);
  json["changed"] = bake.changed;
  Json meshes = Json::array();
  for (const BakedMesh& mesh : bake.meshes) meshes.push_back(mesh_json(mesh));
  json["meshes"] = std::move(meshes);
  json["added_targets"] = bake.added_targets;
  json["added_bytes"] = bake.added_bytes;
  json["converted_tracks"] = bake.converted_tracks;
  json["pointers"] = bake.pointers;
  json["warnings"] = bake.warnings;
  json["drivers"] = or_null(report.drivers_file);
  add_audit(report, json);
  return json_text(json);
}

std::string bake_json(const SequenceBake& bake, BakeEncoding encoding, const BakeReport& report) {
  Json json = common_json(report);
  json["encoding"] = name_of(encoding);
  json["keyframes"] = bake.keyframes;
  json["vertices"] = bake.vertices;
  json["targets"] = bake.targets;
  json["extra_targets"] = bake.extra_targets;
  json["bytes"] = bake.bytes;
  json["error_degrees"] = bake.largest_error;
  json["without_normals"] = bake.without_normals;
  json["warnings"] = bake.warnings;
  add_audit(report, json);
  return json_text(json);
}

}  // namespace chronormal::cli
