#include "report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foucault::page {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportHtml, AnEmptyPageIsWhole) {
  const std::string html = to_html({});
  EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0U);
  EXPECT_THAT(html, HasSubstr("</main>\n</body>\n</html>\n"));
  for (const char* part : {"<nav>", "class=\"tiles\"", "<footer>", "class=\"banner"}) {
    EXPECT_THAT(html, Not(HasSubstr(part)));
  }
}

TEST(ReportHtml, WordsAreEscaped) {
  ReportPage page;
  page.title = "a < b & \"c\" > d";
  EXPECT_THAT(to_html(page), HasSubstr("<h1>a &lt; b &amp; &quot;c&quot; &gt; d</h1>"));
}

TEST(ReportHtml, ABannerAlarmsOrNotes) {
  ReportPage page;
  page.banner = Banner{false, "Trustworthy", {"all is well"}};
  EXPECT_THAT(to_html(page), HasSubstr("<div class=\"banner\" role=\"note\"><b>Trustworthy</b>\n"
                                       "<p>all is well</p>\n</div>"));
  page.banner->alarming = true;
  EXPECT_THAT(to_html(page), HasSubstr("<div class=\"banner alarming\" role=\"alert\">"));
}

TEST(ReportHtml, KeyNumbersHaveAUnitAndANoteIfThereIsOne) {
  ReportPage page;
  page.key_numbers = {{"RMS", "1.2", "cm", "north"}, {"Fixes", "7", "", ""}};
  const std::string html = to_html(page);
  EXPECT_THAT(html, HasSubstr("<dd>1.2 <span>cm</span></dd><dd class=\"note\">north</dd>"));
  EXPECT_THAT(html, HasSubstr("<dt>Fixes</dt><dd>7</dd></dl>"));
}

TEST(ReportHtml, TablesHaveOnlyThePartsTheyHave) {
  ReportPage page;
  page.sections = {{"S"}};
  page.sections[0].tables = {{"", "", false, {}, {{"x", "1"}}}};
  std::string html = to_html(page);
  EXPECT_THAT(html, HasSubstr("<table>\n<tbody>\n<tr><td>x</td><td>1</td></tr>\n</tbody>"));
  page.sections[0].tables = {{"T", "n", true, {"a"}, {}}};
  html = to_html(page);
  EXPECT_THAT(html, HasSubstr("<table class=\"words\">\n<caption>T</caption>\n"
                              "<thead><tr><th>a</th></tr>\n</thead>"));
  EXPECT_THAT(html, HasSubstr("<p class=\"small\">n</p>"));
}

TEST(ReportHtml, FiguresAreNumberedOverAllSections) {
  ReportPage page;
  page.sections = {{"One"}, {"Two"}};
  page.sections[0].figures = {{"a", "First"}};
  page.sections[1].figures = {{"b", "Second", "", "What good looks like."}};
  const std::string html = to_html(page);
  EXPECT_THAT(html, HasSubstr("<b>Figure 1.</b> First. "));
  EXPECT_THAT(html, HasSubstr("<b>Figure 2.</b> What good looks like. "));
  EXPECT_THAT(html, HasSubstr("<img src=\"b.png\" alt=\"Second.\" width=\"1000\" height=\"600\">"));
  EXPECT_THAT(html, HasSubstr("<a href=\"#section-2\">Two</a>"));
}

}  // namespace
}  // namespace foucault::page
