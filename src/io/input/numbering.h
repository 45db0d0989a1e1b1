/// Reads the numbers in the names of files. The numbers give the order and the times of the files if nothing else does.
/// Private to io.
///
/// A number has digits and may have a fraction: t_0.05. A minus before the digits is a sign at the start of a name,
/// after a blank, or if another name has the same texts around its numbers, but no minus there. The names frame-001 to
/// frame-100 thus have positive numbers. A number has an exponent only if all names have one at that place: t_1e-05. A
/// point between two numbers is not a decimal point if a version is before it (v2.0001, 001.0001), or if the digits
/// after it cannot be a fraction that a program printed (1.9, 1.10).
#ifndef CHRONORMAL_IO_INPUT_NUMBERING_H_
#define CHRONORMAL_IO_INPUT_NUMBERING_H_

#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"

namespace chronormal::inline internal {

/// Sorts the files of one folder or one pattern by the numbers in their names. Files without numbers are sorted as
/// text. Errors: kInvalidInput with `input` as the place if there are several sequences, or a sequence and other files,
/// or if two files have the same number; the message lists them.
[[nodiscard]] Status sort_as_sequence(const std::string& input, std::vector<std::string>& files);

/// Sorts three or more files by their numbers if they are in alphabetical order, as a shell lists them. Files in any
/// other order stay as they are. Returns true if the order changed.
[[nodiscard]] bool sort_listed(std::vector<std::string>& files);

/// The times of the keyframes of a sequence, as far as the numbers in the names of its files tell them.
struct FileTimes {
  /// The times in seconds, or the numbers of frames counted from the first file. The times are 0, 1, 2, ... if the
  /// numbers in the names increase in even steps, or if the names give no times.
  std::vector<double> times;
  std::optional<FileSeries> series;  ///< set if numbers in the names gave the times
};
[[nodiscard]] FileTimes times_of_files(const std::vector<std::string>& files);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_NUMBERING_H_
