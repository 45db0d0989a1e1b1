/// Tables for people: aligned columns with a title and a unit.
///
/// The columns up to the first that is aligned to the left say what a row is about. Where a table is wider than the
/// output, the columns after them that do not fit stand below, in another table with the same rows:
///
///     scheme             sum  vs linear     mean
///                    degrees      ratio  degrees
///     linear     1,264,530.8     1.0000   2.6764
///
///     scheme      rms      max
///             degrees  degrees
///     linear   4.3540  19.6527
///
/// There a long name stands above the rest of its row, and a text in the last column takes several lines.
#ifndef CLI_TERMINAL_TABLE_H_
#define CLI_TERMINAL_TABLE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "cli/terminal/screen.h"
#include "core/text.h"

namespace chronormal::cli {

class Table {
 public:
  enum class Align { kLeft, kRight };

  /// Adds a column; all columns come before the first row. The unit stands under the title. A column without a title
  /// belongs to the one before it, and stays beside it.
  void add_column(std::string title, std::string unit, Align align);
  /// Adds a row, one cell per column.
  void add_row(std::vector<std::string> cells);

  /// The whole table in lines of at most so many columns, as far as two columns fit beside each other; every line
  /// ended, without trailing blanks.
  [[nodiscard]] std::string text(std::size_t columns = columns_of_output()) const;

 private:
  struct Column {
    std::string title, unit;
    Align align;
  };

  // The width of the titles and of all cells that are not wider than that.
  [[nodiscard]] std::size_t width_of_column(std::size_t column, std::size_t most) const;
  // The table of some of the columns with these widths, in lines of so many columns.
  [[nodiscard]] std::string text_of(const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& widths,
                                    std::size_t columns) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// The indices of so many of the largest values, ascending; of equal ones the first count. All where there are no more.
[[nodiscard]] std::vector<std::size_t> indices_of_largest(const std::vector<double>& values, std::size_t most);

/// An angle or a ratio with four decimals, in exponent form where those would say nothing: 12.3457, 2.1e-06, 0.
[[nodiscard]] std::string four_decimals(double value);

/// A sum with one decimal and groups of three, in exponent form below 0.1: 18,916.3, 3.4e-03, 0.
[[nodiscard]] std::string grouped_sum(double value);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_TABLE_H_
