/// Formats tables for people: aligned columns with a title and a unit.
///
/// The columns up to the first one that is aligned to the left identify a row. If a table is wider than the output, the
/// columns that do not fit follow below, in another table with the same rows:
///
///     scheme             sum  vs linear  average
///                    degrees      ratio  degrees
///     linear     1,264,530.8     1.0000   2.6764
///
///     scheme      rms    worst
///             degrees  degrees
///     linear   4.3540  19.6527
///
/// In such a table a long name stands above the rest of its row, and a long text in the last column takes several
/// lines.
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

  /// Adds a column. All columns must be added before the first row. The unit is printed below the title. A column
  /// without a title belongs to the previous column, and stays beside it.
  void add_column(std::string title, std::string unit, Align align);
  /// Adds a row, with one cell for each column.
  void add_row(std::vector<std::string> cells);

  /// Returns the whole table. Its lines have at most `columns` characters, unless not even two columns of the table fit
  /// beside each other. Every line has an end and no trailing blanks.
  [[nodiscard]] std::string text(std::size_t columns = columns_of_output()) const;

 private:
  struct Column {
    std::string title, unit;
    Align align;
  };

  // Returns the width in characters that a column needs for its title, its unit, and those cells that are at most
  // `most` characters wide.
  [[nodiscard]] std::size_t width_of_column(std::size_t column, std::size_t most) const;
  // Returns a table of the chosen columns, which have the given widths, in lines of at most `columns` characters.
  [[nodiscard]] std::string text_of(const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& widths,
                                    std::size_t columns) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Returns the indices of the `most` largest values, in ascending order. The first of equal values are chosen.
[[nodiscard]] std::vector<std::size_t> indices_of_largest(const std::vector<double>& values, std::size_t most);

/// Formats an angle or a ratio with four decimals, or with an exponent if four decimals would lose all its digits:
/// 12.3457, 2.1e-06, 0.
[[nodiscard]] std::string four_decimals(double value);

/// Formats a sum with one decimal and groups of three digits, or with an exponent below 0.1: 18,916.3, 3.4e-03, 0.
[[nodiscard]] std::string grouped_sum(double value);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_TABLE_H_
