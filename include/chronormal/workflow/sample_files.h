/// Files of the normals of a motion at chosen moments (workflow/sample.h).
///
///     npy    an array (moments, outputs, 3) of float32
///     npz    `normals` as above; `times` (moments) or `weights` (moments, targets) of float64; `positions` (moments,
///     V,
///            3); and, where all faces have as many corners, `faces`
///     ply    a file per moment, binary, of the mesh as it is then; nx, ny, nz of vertices or of faces
///     obj    a file per moment; vn of faces (f v//vn with one vn per face), vertices (one vn per vertex) or corners
///     (one
///            for each normal that differs)
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_FILES_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_FILES_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/sample.h"

namespace chronormal {

enum class SampleFormat { kNpy, kNpz, kPly, kObj };

/// Finds a format by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<SampleFormat> make_sample_format(std::string_view name);

/// The format of a file by its extension; nothing where that is none of these.
[[nodiscard]] std::optional<SampleFormat> find_sample_format(std::string_view path);

/// The most bytes that the arrays of one .npy or .npz file may have: they are in memory until the file is written,
/// those of .npz twice.
inline constexpr std::size_t kMostSampleBytes = std::size_t{4} << 30;

/// Moments in the order of the output. One list at most; where both are empty, the mesh stands still.
struct Moments {
  std::vector<double> times;
  std::vector<std::vector<double>> weights;

  [[nodiscard]] std::size_t count() const noexcept {
    return times.empty() && weights.empty() ? 1 : times.size() + weights.size();
  }
};

struct SampleOutput {
  std::string path;  ///< "-" is the standard output; %d or %0Nd in a name of .ply or .obj is the number of the moment
  SampleFormat format = SampleFormat::kNpy;
  bool force = false;
};

/// The files that `count` moments will be written to. Asks before a long computation whether that can be. Errors:
/// kUsage for normals of corners in PLY, and for several moments in one .ply or .obj; those of check_output().
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count);

struct SampleSummary {
  std::size_t normals = 0;  ///< that were written: moments x outputs
  std::size_t zeros = 0;    ///< how many of them are (0, 0, 0)
};

/// Computes and writes. One pose at a time is in memory, and for .npy and .npz the arrays.
/// progress(done, total), if given, is called after each moment.
///
/// Errors: of NormalSampler, sample_files() and write_output(); kUsage for more than kMostSampleBytes. All moments are
/// checked before the first is computed, and a file of the names that exist stops all unless force is given.
[[nodiscard]] Result<SampleSummary> write_samples(
    const Motion& motion, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_FILES_H_
