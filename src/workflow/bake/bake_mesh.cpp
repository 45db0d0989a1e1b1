#include "workflow/bake/bake_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/end_delta.h"
#include "core/blocks.h"

namespace chronormal {
namespace {

constexpr std::size_t kChunk = 1024;
// Stored base normals must have length 1; hosts can show nothing right with those that are shorter than this.
constexpr double kShortest = 1e-3;

// As text; what is beyond float32, which JSON has no word for, becomes the largest float.
std::string number(double value) {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  char text[32];
  const auto [end, code] =
      std::to_chars(text, text + sizeof text, static_cast<float>(std::clamp(value, -kMost, kMost)));
  return code == std::errc{} ? std::string(text, end) : "0";
}

std::string pointer_of(std::size_t mesh, std::size_t primitive) {
  return std::string("/meshes/").append(std::to_string(mesh)).append("/primitives/").append(std::to_string(primitive));
}

// Which attributes the targets of a primitive have when all is done.
struct Attributes {
  bool positions = false, normals = false, tangents = false;
};

// The largest angle of the best single delta, over the weights of a file.
double error_within(const WeightRange& range, const ControlNormals& normals, const EndDelta& best) {
  if (range.low == 0 && range.high == 1) return best.error;
  const Vec3d base = unit_normal_at(normals, 0).vector;
  const Vec3d from = base + range.low * best.delta, to = base + range.high * best.delta;
  if (max_abs(from) == 0 || max_abs(to) == 0) return std::numbers::pi;
  return largest_line_error(normals_between(normals, range.low, range.high), from, to);
}

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
    report_.largest_error = plan_.lines.largest_error() * kDegreesPerRadian;
    report_.fitted_elements = plan_.lines.elements();
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
    for (const GltfPart& part : shading_.parts) {
      const GltfPrimitive& primitive = mesh_.primitives[part.primitive];
      if (!is_shaded(part.primitive) || (primitive.has_normals && !options_.recompute_base)) continue;
      const std::string pointer = pointer_of(plan_.mesh, part.primitive);
      if (primitive.has_normals && primitive.has_draco) {
        return invalid_input(std::string(document_.name()).append(", ").append(pointer),
                             "the base normals are compressed by Draco and cannot be replaced");
      }
      if (replaced_.empty()) replaced_ = shading_.normals;
      for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) replace_stored(v);
      const std::span<const float> normals(replaced_.data() + 3 * part.first_vertex, 3 * part.vertex_count);
      edit_.set(pointer + "/attributes/NORMAL", std::to_string(edit_.add_vectors(normals, {false, true})));
    }
    return Success{};
  }

  void replace_stored(std::size_t vertex) {
    const std::uint32_t element = shading_.element_of_vertex[vertex];
    float* stored = replaced_.data() + 3 * vertex;
    const bool has_stored = stored[0] != 0 || stored[1] != 0 || stored[2] != 0;
    Vec3d normal = element == GltfShading::kNoElement ? Vec3d{} : unit(terms_.base_of(element));
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
    const std::vector<std::uint32_t>& elements = shading_.element_of_vertex;
    std::vector<std::size_t> without(block_count(elements.size(), kChunk)),
        unstored(block_count(elements.size(), kChunk));
    numbered_blocks(elements.size(), kChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) {
        const std::uint32_t e = elements[v];
        if (e == GltfShading::kNoElement) continue;
        if (!VertexTerms::has_base(terms_.base_of(e), plan_.largest[e])) ++without[chunk];
        if (length(stored(v)) < kShortest) ++unstored[chunk];
      }
    });
    for (const std::size_t of_chunk : without) report_.without_base += of_chunk;
    for (const std::size_t of_chunk : unstored) report_.without_stored += of_chunk;
    for (std::size_t i = 0; i < mesh_.target_count; ++i) {
      if (plan_.is_line[i] && plan_.encoding == BakeEncoding::kExact) ++report_.undriven;
    }
  }

  [[nodiscard]] Vec3d stored(std::size_t vertex) const {
    const float* const n = (replaced_.empty() ? shading_.normals : replaced_).data() + 3 * vertex;
    return to_double(Vec3f{n[0], n[1], n[2]});
  }

  // What find(element, vertex terms, delta) says of each vertex of a part that shows something, as an accessor; zeros
  // where it says false of all of them.
  template <class Find>
  std::size_t deltas_of(const GltfPart& part, const Find& find) {
    std::vector<float> deltas(3 * part.vertex_count);
    std::vector<char> any(block_count(part.vertex_count, kChunk));
    numbered_blocks(part.vertex_count, kChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) {
        const std::size_t v = part.first_vertex + n;
        const std::uint32_t e = shading_.element_of_vertex[v];
        Vec3d delta;
        if (e == GltfShading::kNoElement || !find(e, v, chunk, delta)) continue;
        deltas[3 * n] = static_cast<float>(delta.x);
        deltas[3 * n + 1] = static_cast<float>(delta.y);
        deltas[3 * n + 2] = static_cast<float>(delta.z);
        any[chunk] = 1;
      }
    });
    if (std::find(any.begin(), any.end(), 1) == any.end()) return zeros_.of(part.vertex_count);
    return edit_.add_vectors(deltas, {false, options_.dense_zeros});
  }

  std::size_t deltas_of_term(const GltfPart& part, const NormalTerms::Term& term) {
    return deltas_of(part, [&](std::uint32_t e, std::size_t v, std::size_t, Vec3d& delta) {
      Vec3d value;
      if (!term.find(e, value)) return false;
      delta = VertexTerms(terms_.base_of(e), plan_.largest[e], stored(v))(value);
      return true;
    });
  }

  // The best single deltas of a target.
  std::size_t deltas_of_line(const GltfPart& part, std::size_t target, const NormalTerms::Term& linear,
                             const NormalTerms::Term& square) {
    std::vector<double> errors(block_count(part.vertex_count, kChunk));
    const auto find = [&](std::uint32_t e, std::size_t v, std::size_t chunk, Vec3d& delta) {
      Vec3d a, c;
      const bool has_linear = linear.find(e, a), has_square = square.find(e, c);
      if (!has_linear && !has_square) return false;
      const Vec3d base = terms_.base_of(e);
      const VertexTerms vertex(base, plan_.largest[e], stored(v));
      if (plan_.lines.find(target, e, delta)) {
        delta = vertex.fitted_delta(delta);
        return true;
      }
      const ControlNormals normals = of_powers(base, a, c);
      const EndDelta best = best_end_delta(normals);
      errors[chunk] = std::fmax(errors[chunk], error_within(plan_.ranges[target], normals, best));
      delta = vertex.end_delta(best.delta, normals);
      return true;
    };
    const std::size_t accessor = deltas_of(part, find);
    double error = 0;
    for (const double of_chunk : errors) error = std::fmax(error, of_chunk);
    report_.largest_error = std::fmax(report_.largest_error, (error + terms_.bound(target)) * kDegreesPerRadian);
    return accessor;
  }

  void write_target(std::size_t i) {
    const bool rewritten = moves(shading_, i);
    std::optional<NormalTerms::Term> linear, square;
    if (rewritten) {
      linear.emplace(terms_.linear_by_element(i));
      if (plan_.is_line[i]) square.emplace(terms_.pair_by_element(i, i));
      report_.largest_error = std::fmax(report_.largest_error, terms_.bound(i) * kDegreesPerRadian);
    }
    const auto deltas = [&](const GltfPart& part) {
      return square ? deltas_of_line(part, i, *linear, *square) : deltas_of_term(part, *linear);
    };
    for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
      const GltfPrimitive& primitive = mesh_.primitives[p];
      if (i >= primitive.targets.size()) continue;
      const std::string pointer = pointer_of(plan_.mesh, p) + "/targets/" + std::to_string(i);
      const GltfPrimitive::Target& has = primitive.targets[i];
      if (attributes_[p].positions && !has.positions)
        edit_.set(pointer + "/POSITION", std::to_string(zeros_.of(primitive.vertex_count)));
      if (rewritten && is_shaded(p))
        edit_.set(pointer + "/NORMAL", std::to_string(deltas(*part_of(p))));
      else if (attributes_[p].normals && !has.normals)
        edit_.set(pointer + "/NORMAL", std::to_string(zeros_.of(primitive.vertex_count)));
    }
  }

  void write_extra(const WeightProduct& extra) {
    const NormalTerms::Term term = terms_.pair_by_element(extra.i, extra.j);
    for (std::size_t p = 0; p < mesh_.primitives.size(); ++p) {
      const Attributes& attributes = attributes_[p];
      const std::size_t count = mesh_.primitives[p].vertex_count;
      std::string target;
      const auto add = [&target](const char* name, std::size_t accessor) {
        target.append(target.empty() ? "{\"" : ",\"").append(name).append("\":").append(std::to_string(accessor));
      };
      if (attributes.positions) add("POSITION", zeros_.of(count));
      if (attributes.normals) add("NORMAL", is_shaded(p) ? deltas_of_term(*part_of(p), term) : zeros_.of(count));
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
  std::vector<float> replaced_;         // (V, 3), base normals as they will be, where some are replaced
  std::vector<Attributes> attributes_;  // of each primitive
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
