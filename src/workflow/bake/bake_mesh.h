/// The bake of one mesh as edits: deltas of normals, extra targets, and what has to grow with them. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_BAKE_MESH_H_
#define CHRONORMAL_WORKFLOW_BAKE_BAKE_MESH_H_

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/bake_plan.h"

namespace chronormal {

/// Accessors of zeros, one for each number of vertices.
class ZeroVectors {
 public:
  ZeroVectors(GltfEdit& edit, bool dense) : edit_(edit), dense_(dense) {}
  [[nodiscard]] std::size_t of(std::size_t vertices);

 private:
  GltfEdit& edit_;
  bool dense_;
  std::map<std::size_t, std::size_t> accessors_;
};

/// Writes what the plan says, and fills in the report. Tracks of weights are left to write_tracks().
/// step() is called for each target that is done. Errors: kInvalidInput where base normals cannot be replaced.
[[nodiscard]] Status write_mesh(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms,
                                const MeshPlan& plan, const BakeOptions& options, const std::function<void()>& step,
                                ZeroVectors& zeros, GltfEdit& edit, BakedMesh& report);

/// Extends the tracks of all animations that drive these meshes. Adds to resampling_error of the reports (one for each
/// plan), and counts converted tracks. Errors: of GltfDocument; kInvalidInput where something else drives the weights.
[[nodiscard]] Status write_tracks(const GltfDocument& document, const std::vector<MeshPlan>& plans, double tolerance,
                                  GltfEdit& edit, std::vector<BakedMesh*>& reports, std::size_t& converted);

/// The product of two weights as text: "w0*w1".
[[nodiscard]] std::string formula_of(const GltfExtraTarget& extra);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_BAKE_MESH_H_
