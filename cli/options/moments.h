/// Reads the options that choose the moments at which normals are computed: --times, --weights and --step.
///
///     --times 0,0.5,1            times in seconds
///     --times 0:0.25:2,5         a range with its step, and a time
///     --times keys               the times at which the input has keyframes
///     --weights 0.5,0,1          a weight for each target
///     --weights jawOpen=0.5,3=1  weights by the names or numbers of targets; all others are 0
///     --step 100                 every segment in 100 equal steps, each computed from the previous one
///     --step 100:0               the same; no step is ever computed anew, so rounding errors add up
///
/// The weight follows the last '=', so that names may contain this character. A name with a comma, or with blanks at
/// its ends, is written in double quotes, in which "" stands for one quotation mark.
#ifndef CLI_OPTIONS_MOMENTS_H_
#define CLI_OPTIONS_MOMENTS_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/workflow/sample.h"
#include "cli/options/options.h"

namespace chronormal::cli {

/// The arguments of --times, --weights and --step, as text.
struct MomentArguments {
  std::string times;                 ///< empty if not given
  std::vector<std::string> weights;  ///< one list for each pose
  std::string step;                  ///< empty if not given

  [[nodiscard]] std::vector<Option> table();
};

/// The moments that the user chose, parsed as far as this is possible before the input is read.
struct AskedMoments {
  /// The weights of targets in a pose, in the order of the targets or by their names.
  struct Pose {
    std::vector<double> numbers;
    std::vector<std::pair<std::string, double>> named;
  };

  bool at_keys = false;
  std::vector<double> times;
  std::vector<Pose> poses;
  std::optional<Stepping> stepping;

  /// Returns the number of moments that the user chose, or 1 if the number depends on the input.
  [[nodiscard]] std::size_t count() const noexcept;
};

/// Parses the values of --times, --weights and --step. Errors: kUsage, with the option as the place.
[[nodiscard]] Result<AskedMoments> understand(const MomentArguments& arguments);

/// Returns the moments for this input, or no moments for a mesh at rest. Errors: those of Input::motion(); kUsage if
/// the moments do not fit the motion, for a name that no target has, and for a name that several targets have.
[[nodiscard]] Result<Moments> moments_of(Input& input, const AskedMoments& asked);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_MOMENTS_H_
