/// Fills the template of a page with what a program has measured.
///
/// A template is Markdown. All prose of a page stands in it; a program only says what stands in its places:
///
///     {{name}}                a value that the program has set. A table or a whole part has a line of its own, and a
///                             picture is the address of an image: ![what it shows]({{name}})
///     {{table/row/column}}    a cell of a table: the row whose first cell, and the column whose title, is that text or
///                             has it in backticks
///
/// Paragraphs and items of lists are wrapped anew when their places are filled, and tables are aligned. A part of a
/// page that is repeated, or that may be missing, is a template of its own, and its text is a value of the page.
///
/// A place without a value is an error, and so is a value without a place: neither a template nor a program can be
/// changed alone. No figure is typed into prose. Where a sentence claims more than its figures say ("worse than
/// linear"), the program also calls require(): a page that would state something untrue is not written.
#ifndef SUPPORT_PAGE_H_
#define SUPPORT_PAGE_H_

#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/plot.h"

namespace chronormal::pages {

using Cells = std::vector<std::string>;

class Page {
 public:
  /// The template is a file of tools/. Pictures go to FOLDER/pictures.
  Page(std::string_view template_file, std::string folder);
  /// A page whose template is this text.
  static Page of_text(std::string text, std::string folder);

  void set(std::string name, std::string text);
  void set(std::initializer_list<std::pair<const char*, std::string>> values);
  /// The value is the aligned_table(); its cells have places too.
  void table(std::string name, Cells header, std::vector<Cells> rows, std::size_t text_column = 99);
  /// Draws a figure as pictures/FIGURE.svg; the value is that path.
  void picture(std::string name, const Figure& figure);

  /// Throws std::runtime_error, with the name, where a place has no value or a value no place.
  [[nodiscard]] std::string markdown() const;
  /// Writes the page to FOLDER/NAME.
  void write(std::string_view name) const;

 private:
  struct Table {
    Cells header;
    std::vector<Cells> rows;
  };
  explicit Page(std::string folder) : folder_(std::move(folder)) {}
  [[nodiscard]] const std::string& value(const std::string& name, std::set<std::string>& used) const;
  [[nodiscard]] std::string filled(std::string_view text, std::set<std::string>& used) const;

  std::string name_, template_, folder_;
  std::map<std::string, std::string> values_;
  std::map<std::string, Table> tables_;
};

/// A table as Markdown. Columns are aligned to the right; the first, and those from `text_column` on, to the left.
[[nodiscard]] std::string aligned_table(const Cells& header, const std::vector<Cells>& rows,
                                        std::size_t text_column = 99);

/// Throws std::runtime_error where a claim of the prose does not hold.
void require(bool holds, std::string_view claim);

/// What main() returns of a program that writes pages: 0, or 1 once it has said what was thrown.
[[nodiscard]] int run(const char* program, const std::function<void()>& write_pages);

}  // namespace chronormal::pages

#endif  // SUPPORT_PAGE_H_
