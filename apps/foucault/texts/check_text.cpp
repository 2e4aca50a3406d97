#include "texts/check_text.h"

#include <fmt/format.h>

#include "foucault/export/json_object.h"

namespace foucault::app {
namespace {

using diagnosis::Finding;
using diagnosis::Severity;
using exports::Json;
using exports::Object;

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::ok:
      return "ok";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "";
}

}  // namespace

std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text +=
        fmt::format("{:<8} {:<20} {}\n", name_of(finding.severity), finding.subject, finding.text);
    if (!finding.remedy.empty())
      text += fmt::format("{:<8} {:<20} -> {}\n", "", "", finding.remedy);
  }
  return text;
}

std::string findings_json(const std::string& log, const std::vector<Finding>& findings) {
  Json json = Object()
                  .with("path", log)
                  .with("ok", subjects_to_mend(findings).empty())
                  .with("findings", Json::array());
  for (const Finding& finding : findings) {
    json["findings"].push_back(Object()
                                   .with("severity", name_of(finding.severity))
                                   .with("subject", finding.subject)
                                   .with("text", finding.text)
                                   .with("remedy", finding.remedy));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<std::string> subjects_to_mend(const std::vector<Finding>& findings) {
  std::vector<std::string> subjects;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::error) subjects.push_back(finding.subject);
  }
  return subjects;
}

}  // namespace foucault::app
