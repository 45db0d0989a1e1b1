/// The samples of an audit as a report keeps them: what it takes to place each, its errors, and where each vertex is
/// off the most. Private to workflow.
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

/// The motions of one mesh.
struct WatchedPart {
  std::vector<ModelMotion> motions;
  std::vector<ModelPeak> peaks;  ///< of vertices, as far as some were judged
};

class WatchedMotions {
 public:
  /// audited are the viewers of the audit; the weights that those of `kept` play are kept. vertex_of_corner, which must
  /// outlive this, says which vertex of the report shows a corner; where it is empty, vertices are those of the audit.
  WatchedMotions(std::span<const Viewer> audited, std::span<const Viewer> kept,
                 std::span<const std::uint32_t> vertex_of_corner = {});

  void add(const AuditSample& sample);

  /// By mesh; what is no glTF file has one, without a mesh.
  [[nodiscard]] std::map<std::optional<std::size_t>, WatchedPart> take();

 private:
  // The weights of a motion, sample after sample, without those that are 0: a file of many targets has a motion for
  // each, in which the others rest.
  class Weights {
   public:
    void add(std::span<const double> of_sample);
    // Empties it.
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

  // The weights that one viewer plays in the motion that the audit tells of.
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
