/// The numbers in the names of files: in which order files stand, and at which times, where nothing else says so.
/// Private to io.
///
/// A number has digits and may have a fraction: t_0.05. A minus belongs to it at the start of a name and after a blank,
/// and where the set also has names without one at the same place, so that frame-001 to frame-100 are counted upwards.
/// It has an exponent only where all names have one there: t_1e-05. A point between two numbers is no decimal point
/// where a version stands before it (v2.0001, 001.0001), nor where the digits behind it cannot be a fraction that a
/// program printed (1.9, 1.10).
#ifndef CHRONORMAL_IO_INPUT_NUMBERING_H_
#define CHRONORMAL_IO_INPUT_NUMBERING_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"

namespace chronormal::inline internal {

/// Sorts the files of one folder or one pattern by their numbers; files without numbers stand in plain order.
/// Errors: kInvalidInput with `input` as the place where they are several sequences, or a sequence and other files, and
/// where two of them have the same number; the message lists them.
[[nodiscard]] Status sort_as_sequence(const std::string& input, std::vector<std::string>& files);

/// Sorts three or more files that were listed in the order of their letters, as a shell lists them, where their numbers
/// have another order. Returns whether it did. Files that were listed in any other order stay as they are.
[[nodiscard]] bool sort_listed(std::vector<std::string>& files);

/// The times that the names of files give them.
struct FileTimes {
  /// Seconds, or frames from the first file on: 0, 1, 2, ... where the steps from one number to the next are even, and
  /// where numbers do not tell.
  std::vector<double> times;
  std::optional<FileSeries> series;  ///< where they do
};
[[nodiscard]] FileTimes times_of_files(const std::vector<std::string>& files);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_NUMBERING_H_
