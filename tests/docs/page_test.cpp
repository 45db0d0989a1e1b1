// A template and the values of its places: what is filled in, how it is laid out, and what is refused.

#include "support/page.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace chronormal::pages {
namespace {

// What a page says of its values; "" where it takes them.
std::string refusal(const Page& page) {
  try {
    (void)page.markdown();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Pages, paragraphs_and_items_are_wrapped_anew_once_they_are_filled) {
  Page page =
      Page::of_text("# A {{title}}\n\nTwo\nlines of {{what}}.\n\n* An item\n  with {{what}}\n* and another\n", ".");
  page.set({{"title", "b"}, {"what", std::string(60, 'x') + ' ' + std::string(60, 'y')}});
  const std::string x(60, 'x'), y(60, 'y');
  EXPECT_EQ(page.markdown(),
            "# A b\n\nTwo lines of " + x + '\n' + y + ".\n\n* An item with " + x + "\n  " + y + "\n* and another\n");
}

TEST(Pages, tables_are_aligned_and_prose_quotes_their_cells) {
  Page page = Page::of_text(
      "{{all}}\n\n{{all/b/large}} and {{all/one c/small, large}}\n\n| a | b |\n|---|--:|\n| {{d}} | 1 |\n", ".");
  page.table("all", {"what", "small", "large", "small, large"},
             {{"a", "1", "20", ""}, {"the `b`", "2", "3", ""}, {"one c", "", "", "5"}});
  page.set("d", "long");
  EXPECT_EQ(page.markdown(),
            "| what    | small | large | small, large |\n"
            "|---------|------:|------:|-------------:|\n"
            "| a       |     1 |    20 |              |\n"
            "| the `b` |     2 |     3 |              |\n"
            "| one c   |       |       |            5 |\n"
            "\n3 and 5\n\n"
            "| a    |   b |\n"
            "|------|----:|\n"
            "| long |   1 |\n");
}

TEST(Pages, a_part_that_is_missing_leaves_nothing) {
  Page page = Page::of_text("<!-- part -->\n{{part}}\n<!-- end of part -->\n", ".");
  page.set("part", "");
  EXPECT_EQ(page.markdown(), "<!-- part -->\n<!-- end of part -->\n");
}

TEST(Pages, a_place_without_a_value_and_a_value_without_a_place_are_errors) {
  Page page = Page::of_text("{{a}} {{all/row/column}}\n", ".");
  EXPECT_NE(refusal(page).find("no value for {{a}}"), std::string::npos);
  page.set("a", "1");
  EXPECT_NE(refusal(page).find("no value for {{all/row/column}}"), std::string::npos);
  page.table("all", {"", "column"}, {{"row", "2"}});
  EXPECT_NE(refusal(page).find("no place for the value all"), std::string::npos);
  EXPECT_THROW(page.set("a", "2"), std::runtime_error);
  EXPECT_NE(refusal(Page::of_text("{{a\n", ".")).find("{{ without }}"), std::string::npos);
}

TEST(Pages, a_claim_that_does_not_hold_is_an_error) {
  EXPECT_NO_THROW(require(true, "so"));
  EXPECT_THROW(require(false, "so"), std::runtime_error);
}

}  // namespace
}  // namespace chronormal::pages
