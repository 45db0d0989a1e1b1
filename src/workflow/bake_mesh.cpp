#include "workflow/bake_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/normals/end_delta.h"

namespace chronormal {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::size_t kChunk = 1024;

std::string number(double value) {
  char text[32];
  const auto [end, code] = std::to_chars(text, text + sizeof text, static_cast<float>(value));
  return code == std::errc{} ? std::string(text, end) : "0";
}

std::string pointer_of(std::size_t mesh, std::size_t primitive) {
  return std::string("/meshes/").append(std::to_string(mesh)).append("/primitives/").append(std::to_string(primitive));
}

// Which attributes the targets of a primitive have when all is done.
struct Attributes {
  bool positions = false, normals = false, tangents = false;
};

class MeshWriter {
 public:
  MeshWriter(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms, const MeshPlan& plan,
             const BakeOptions& options, ZeroVectors& zeros, GltfEdit& edit, BakedMesh& report)
      : document_(document),
        mesh_(document.meshes()[plan.mesh]),
        shading_(shading),
        terms_(terms),
        plan_(plan),
        options_(options),
        zeros_(zeros),
        edit_(edit),
        report_(report) {}

  Status run(const std::function<void()>& step) {
    for (std::size_t n = 0; n < plan_.extras.size(); ++n)
      report_.extras.push_back({mesh_.target_count + n, plan_.extras[n].i, plan_.extras[n].j});
    report_.encoding = plan_.encoding;
    report_.resampling_error = plan_.left_out;
    if (Status status = take_stored(); !status) return status;
    count();
    attributes_.resize(mesh_.primitives.size());
    for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) attributes_[p] = attributes_of(p);
    for (std::size_t i = 0; i < mesh_.target_count; ++i) {
      write_target(i);
      step();
    }
    for (const WeightProduct& extra : plan_.extras) {
      write_extra(extra);
      step();
    }
    grow_weights();
    write_mark();
    return Success{};
  }

 private:
  [[nodiscard]] const GltfPart* part_of(std::size_t primitive) const {
    for (const GltfPart& part : shading_.parts) {
      if (part.primitive == primitive) return &part;
    }
    return nullptr;
  }
  // Whether its vertices show normals of elements.
  [[nodiscard]] bool is_shaded(std::size_t primitive) const {
    const GltfPrimitive& p = mesh_.primitives[primitive];
    return p.has_faces() && (p.has_normals || options_.smooth);
  }

  [[nodiscard]] Attributes attributes_of(std::size_t p) const {
    Attributes result;
    for (const GltfPrimitive::Target& target : mesh_.primitives[p].targets) {
      result.positions |= target.positions;
      result.normals |= target.normals;
      result.tangents |= target.tangents;
    }
    result.normals |= is_shaded(p);
    // A target with nothing at all is none.
    result.positions |= !result.normals && mesh_.primitives[p].vertex_count > 0;
    return result;
  }

  // The base normals, and new ones where they are asked for.
  Status take_stored() {
    stored_ = shading_.normals;
    for (const GltfPart& part : shading_.parts) {
      const GltfPrimitive& primitive = mesh_.primitives[part.primitive];
      if (!is_shaded(part.primitive) || (primitive.has_normals && !options_.recompute_base)) continue;
      const std::string pointer = pointer_of(plan_.mesh, part.primitive);
      if (primitive.has_normals && primitive.has_draco) {
        return invalid_input(std::string(document_.name()).append(", ").append(pointer),
                             "the base normals are compressed by Draco and cannot be replaced");
      }
      for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) replace_stored(v);
      const std::span<const float> normals(stored_.data() + 3 * part.first_vertex, 3 * part.vertex_count);
      edit_.set(pointer + "/attributes/NORMAL", std::to_string(edit_.add_vectors(normals, {false, true})));
    }
    return Success{};
  }

  void replace_stored(std::size_t vertex) {
    const std::uint32_t element = shading_.element_of_vertex[vertex];
    float* stored = stored_.data() + 3 * vertex;
    const bool has_stored = stored[0] != 0 || stored[1] != 0 || stored[2] != 0;
    Vec3d normal = element == GltfShading::kNoElement ? Vec3d{} : unit(terms_.base()[element]);
    if (max_abs(normal) == 0) {  // a file cannot say that there is none
      if (has_stored) return;
      normal = {0, 0, 1};
    }
    stored[0] = static_cast<float>(normal.x);
    stored[1] = static_cast<float>(normal.y);
    stored[2] = static_cast<float>(normal.z);
  }

  void count() {
    for (const bool shown : plan_.is_shown) report_.elements += shown ? 1 : 0;
    for (const std::uint32_t e : shading_.element_of_vertex) {
      if (e == GltfShading::kNoElement) continue;
      if (!VertexTerms::has_base(terms_.base()[e], plan_.largest[e])) ++report_.without_base;
    }
    for (std::size_t i = 0; i < mesh_.target_count; ++i) {
      if (plan_.is_line[i] && plan_.encoding == BakeEncoding::kExact) ++report_.undriven;
    }
  }

  // Sets the terms of a target, of all elements.
  void take_line(std::size_t i) {
    const BlendTerm linear = terms_.linear(i), square = terms_.pair(i, i);
    std::vector<std::uint32_t> moved;
    std::set_union(linear.elements.begin(), linear.elements.end(), square.elements.begin(), square.elements.end(),
                   std::back_inserter(moved));
    std::vector<Vec3d> squares(moved.size());
    for (std::size_t n = 0, s = 0; n < moved.size() && s < square.elements.size(); ++n) {
      if (moved[n] == square.elements[s]) squares[n] = square.values[s++];
    }
    clear();
    lines_.resize(shading_.groups.size());
    for (std::size_t n = 0; n < linear.elements.size(); ++n) values_[linear.elements[n]] = linear.values[n];
    std::vector<double> errors(moved.size());
    parallel_for((moved.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      for (std::size_t n = chunk * kChunk; n < std::min(moved.size(), (chunk + 1) * kChunk); ++n) {
        const std::uint32_t e = moved[n];
        lines_[e] = control_normals_of(terms_.base()[e], values_[e], squares[n]);
        if (!plan_.is_shown[e]) continue;
        const EndDelta best = best_end_delta(lines_[e]);
        values_[e] = best.delta;
        errors[n] = best.error;
      }
    });
    double error = 0;
    for (const double of_element : errors) error = std::fmax(error, of_element);
    report_.largest_error = std::fmax(report_.largest_error, (error + terms_.bound(i)) * kDegrees);
    is_moved_.assign(shading_.groups.size(), false);
    for (const std::uint32_t e : moved) is_moved_[e] = true;
  }
  void take_term(const BlendTerm& term) {
    clear();
    for (std::size_t n = 0; n < term.elements.size(); ++n) {
      values_[term.elements[n]] = term.values[n];
      is_moved_[term.elements[n]] = true;
    }
  }
  void clear() {
    values_.assign(shading_.groups.size(), {});
    is_moved_.assign(shading_.groups.size(), false);
  }

  // An accessor with the deltas of a part.
  std::size_t deltas_of(const GltfPart& part, bool is_line) {
    std::vector<float> deltas(3 * part.vertex_count);
    bool any = false;
    for (std::size_t n = 0; n < part.vertex_count; ++n) {
      const std::size_t v = part.first_vertex + n;
      const std::uint32_t e = shading_.element_of_vertex[v];
      if (e == GltfShading::kNoElement || !is_moved_[e]) continue;
      const Vec3d stored = to_double(Vec3f{stored_[3 * v], stored_[3 * v + 1], stored_[3 * v + 2]});
      const VertexTerms of_vertex(terms_.base()[e], plan_.largest[e], stored);
      const Vec3d delta = is_line ? of_vertex.end_delta(values_[e], lines_[e]) : of_vertex(values_[e]);
      deltas[3 * n] = static_cast<float>(delta.x);
      deltas[3 * n + 1] = static_cast<float>(delta.y);
      deltas[3 * n + 2] = static_cast<float>(delta.z);
      any = true;
    }
    if (!any) return zeros_.of(part.vertex_count);
    return edit_.add_vectors(deltas, {false, options_.dense_zeros});
  }

  void write_target(std::size_t i) {
    const bool rewritten = moves(shading_, i);
    if (rewritten) {
      if (plan_.is_line[i])
        take_line(i);
      else
        take_term(terms_.linear(i));
      if (!plan_.is_line[i]) report_.largest_error = std::fmax(report_.largest_error, terms_.bound(i) * kDegrees);
    }
    for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
      const GltfPrimitive& primitive = mesh_.primitives[p];
      if (i >= primitive.targets.size()) continue;
      const std::string pointer = pointer_of(plan_.mesh, p) + "/targets/" + std::to_string(i);
      const GltfPrimitive::Target& has = primitive.targets[i];
      if (attributes_[p].positions && !has.positions)
        edit_.set(pointer + "/POSITION", std::to_string(zeros_.of(primitive.vertex_count)));
      if (rewritten && is_shaded(p))
        edit_.set(pointer + "/NORMAL", std::to_string(deltas_of(*part_of(p), plan_.is_line[i])));
      else if (attributes_[p].normals && !has.normals)
        edit_.set(pointer + "/NORMAL", std::to_string(zeros_.of(primitive.vertex_count)));
    }
  }

  void write_extra(const WeightProduct& extra) {
    take_term(terms_.pair(extra.i, extra.j));
    for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
      const Attributes& attributes = attributes_[p];
      const std::size_t count = mesh_.primitives[p].vertex_count;
      std::string target;
      const auto add = [&target](const char* name, std::size_t accessor) {
        target.append(target.empty() ? "{\"" : ",\"").append(name).append("\":").append(std::to_string(accessor));
      };
      if (attributes.positions) add("POSITION", zeros_.of(count));
      if (attributes.normals) add("NORMAL", is_shaded(p) ? deltas_of(*part_of(p), false) : zeros_.of(count));
      if (attributes.tangents) add("TANGENT", zeros_.of(count));
      edit_.append(pointer_of(plan_.mesh, p) + "/targets", target.empty() ? "{}" : target + "}");
    }
  }

  void grow(const std::string& pointer, const std::vector<double>& weights) {
    for (const WeightProduct& extra : plan_.extras) edit_.append(pointer, number(weights[extra.i] * weights[extra.j]));
  }

  void grow_weights() {
    const std::string mesh = std::string("/meshes/").append(std::to_string(plan_.mesh));
    if (edit_.has(mesh + "/weights")) grow(mesh + "/weights", mesh_.weights);
    for (std::size_t n = 0; n < document_.nodes().size(); ++n) {
      const GltfNode& node = document_.nodes()[n];
      if (node.mesh == plan_.mesh && !node.weights.empty())
        grow(std::string("/nodes/").append(std::to_string(n)).append("/weights"), node.weights);
    }
    if (mesh_.target_names.empty()) return;
    for (const GltfExtraTarget& extra : report_.extras)
      edit_.append(mesh + "/extras/targetNames", std::string("\"chronormal ").append(formula_of(extra)).append("\""));
  }

  void write_mark() {
    std::string mark = "{\"version\":1,\"encode\":\"";
    mark += plan_.encoding == BakeEncoding::kExact ? "exact" : "endpoint";
    mark += "\",\"sequence\":false,\"extras\":[";
    for (std::size_t n = 0; n < report_.extras.size(); ++n) {
      const GltfExtraTarget& extra = report_.extras[n];
      mark.append(n > 0 ? ",{\"target\":" : "{\"target\":").append(std::to_string(extra.target));
      mark.append(",\"factors\":[").append(std::to_string(extra.i)).append(",").append(std::to_string(extra.j));
      mark += "]}";
    }
    edit_.set(std::string("/meshes/").append(std::to_string(plan_.mesh)).append("/extras/chronormal"), mark + "]}");
  }

  const GltfDocument& document_;
  const GltfMesh& mesh_;
  const GltfShading& shading_;
  const NormalTerms& terms_;
  const MeshPlan& plan_;
  const BakeOptions& options_;
  ZeroVectors& zeros_;
  GltfEdit& edit_;
  BakedMesh& report_;
  std::vector<float> stored_;           // (V, 3), base normals as they will be
  std::vector<Attributes> attributes_;  // of each primitive
  std::vector<Vec3d> values_;           // of each element: the term or line at hand
  std::vector<bool> is_moved_;          // of each element: it has one
  std::vector<ControlNormals> lines_;   // of each element, for lines
};

}  // namespace

std::size_t ZeroVectors::of(std::size_t vertices) {
  const auto found = accessors_.find(vertices);
  if (found != accessors_.end()) return found->second;
  const std::vector<float> zeros(3 * vertices);
  return accessors_[vertices] = edit_.add_vectors(zeros, {true, dense_});
}

std::string formula_of(const GltfExtraTarget& extra) {
  return std::string("w").append(std::to_string(extra.i)).append("*w").append(std::to_string(extra.j));
}

Status write_mesh(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms,
                  const MeshPlan& plan, const BakeOptions& options, const std::function<void()>& step,
                  ZeroVectors& zeros, GltfEdit& edit, BakedMesh& report) {
  return MeshWriter(document, shading, terms, plan, options, zeros, edit, report).run(step);
}

}  // namespace chronormal
