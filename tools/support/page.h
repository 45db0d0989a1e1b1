/// The document that is written: Markdown in the order in which the sections add to it.
///
/// No figure is typed into the prose of a section. Where a sentence claims more than the figure in it says ("worse than
/// linear"), the section also calls require(): a page that would state something untrue is not written.
#ifndef SUPPORT_PAGE_H_
#define SUPPORT_PAGE_H_

#include <string>
#include <string_view>
#include <vector>

#include "support/plot.h"

namespace chronormal::pages {

class Page {
 public:
  /// Pictures go to FOLDER/pictures.
  explicit Page(std::string folder) : folder_(std::move(folder)) {}

  void heading(std::string_view title);
  void subheading(std::string_view title);
  /// One paragraph, wrapped.
  void text(std::string_view paragraph);
  void bullet(std::string_view paragraph);
  /// Columns are aligned to the right; the first, and those from `text_column` on, to the left.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
             std::size_t text_column = 99);
  /// A line as it is.
  void line(std::string_view line);
  /// Draws a figure as pictures/NAME.svg and shows it. `alt` says in words what it shows.
  void picture(const Figure& figure, std::string_view alt);

  /// A row of the summary at the head of the page: what the paper states, what we find.
  void statement(std::string statement, std::string found, std::string section);
  [[nodiscard]] const std::vector<std::vector<std::string>>& statements() const { return statements_; }

  [[nodiscard]] const std::string& markdown() const { return markdown_; }
  void append(const Page& other) { markdown_ += other.markdown_; }

 private:
  std::string folder_;
  std::string markdown_;
  std::vector<std::vector<std::string>> statements_;
};

/// Throws std::runtime_error where a claim of the prose does not hold.
void require(bool holds, std::string_view claim);

[[nodiscard]] std::string grouped(double value, int decimals = 0);  ///< 1,234.5
/// Three decimals, and powers of ten where those would show nothing.
[[nodiscard]] std::string ratio(double value);
[[nodiscard]] std::string percent(double share, int decimals = 0);     ///< 12 %
[[nodiscard]] std::string scientific(double value, int decimals = 0);  ///< 1e-06 as 1e-6
/// "a, b and c"
[[nodiscard]] std::string listed(const std::vector<std::string>& items);

}  // namespace chronormal::pages

#endif  // SUPPORT_PAGE_H_
