/// Tables for people: aligned columns with a title and a unit.
#ifndef CLI_TABLE_H_
#define CLI_TABLE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "core/text.h"

namespace chronormal::cli {

class Table {
 public:
  enum class Align { kLeft, kRight };

  /// Adds a column; all columns come before the first row. The unit stands under the title.
  void add_column(std::string title, std::string unit, Align align);
  /// Adds a row, one cell per column.
  void add_row(std::vector<std::string> cells);

  /// The whole table, every line ended, without trailing blanks.
  [[nodiscard]] std::string text() const;

 private:
  struct Column {
    std::string title, unit;
    Align align;
  };

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

#endif  // CLI_TABLE_H_
