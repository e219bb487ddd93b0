#include "core/report/html_report.h"

#include "core/report/html.h"
#include "core/report/sections.h"
#include "core/types/text.h"

namespace ca2 {
namespace {

std::string problems_section(const std::vector<Problem>& problems) {
  if (problems.empty()) return {};
  std::string out = "<h2>Problems with files</h2><ul>\n";
  for (const Problem& problem : problems) {
    out += "<li>" + escaped(Error(ErrorCode::data, {problem}).text()) + "</li>\n";
  }
  return out + "</ul>\n";
}

}  // namespace

std::string html_report(const ReportInput& input) {
  std::string out =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8>"
      "<meta name=viewport content=\"width=device-width,initial-scale=1\"><title>" +
      escaped(input.title) + "</title>\n" + report_style() + "</head><body>\n<h1>" + escaped(input.title) +
      "</h1>\n";
  out += verdict_section(input);
  if (input.calibration) out += transforms_section(*input.calibration);
  out += pictures_section(input);
  if (input.calibration) out += sensors_section(*input.calibration);
  out += evidence_section(input) + views_section(input) + problems_section(input.problems) +
         provenance_section(input);
  return out + "</body></html>\n";
}

}  // namespace ca2
