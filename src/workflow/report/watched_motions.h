/// Collects the samples of an audit for a report: the moment of each sample, its errors, and the largest error of each
/// vertex. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_WATCHED_MOTIONS_H_
#define CHRONORMAL_WORKFLOW_REPORT_WATCHED_MOTIONS_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "workflow/audit/watched_audit.h"
#include "workflow/report/report_model.h"

namespace chronormal::inline internal {

/// The motions of one mesh, and the largest errors of its vertices.
struct WatchedPart {
  std::vector<ModelMotion> motions;
  std::vector<ModelPeak> peaks;  ///< the largest error of each vertex; empty if no vertex was judged
};

class WatchedMotions {
 public:
  /// Creates an object without motions. `audited` lists the viewers of the audit, and `kept` the viewers whose weights
  /// the report contains. vertex_of_corner has the report's vertex for each corner, and must outlive this object. If
  /// vertex_of_corner is empty, the report has the vertices of the audit.
  WatchedMotions(std::span<const Viewer> audited, std::span<const Viewer> kept,
                 std::span<const std::uint32_t> vertex_of_corner = {});

  void add(const AuditSample& sample);

  /// Moves the parts (the motions of each mesh) out of this object. The key is the index of the mesh. An input that is
  /// not glTF has one part, with the key nullopt.
  [[nodiscard]] std::map<std::optional<std::size_t>, WatchedPart> take();

 private:
  // The weights of a motion, sample by sample, without zeros. Zeros are left out because a file with many targets has a
  // motion for each target, in which all other weights are 0.
  class Weights {
   public:
    void add(std::span<const double> of_sample);
    [[nodiscard]] ModelWeights take();

   private:
    struct Weight {
      std::size_t sample;
      std::uint32_t target;
      float value;
    };
    std::vector<Weight> weights_;
    std::size_t samples_ = 0;
  };

  // The weights that one viewer plays in the motion that the audit is reporting.
  struct Played {
    const Viewer* viewer = nullptr;
    bool is_kept = false, is_specified = true;
    Weights weights;
  };

  void begin(const AuditSample& sample);
  void end();

  std::span<const std::uint32_t> vertex_of_corner_;
  std::map<std::optional<std::size_t>, WatchedPart> parts_;
  WatchedPart* now_ = nullptr;
  Weights specified_;
  std::vector<Played> played_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_WATCHED_MOTIONS_H_
