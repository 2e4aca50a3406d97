#pragma once

#include <string>

#include "foucault/page/report_page.h"

namespace foucault::page {

/// What the page's script draws figures from, as JSON that may stand in HTML: their look, and their
/// numbers once each, as 24-bit shares of their range in base64. Long series are thinned; peaks
/// stay. Figures coloured by value stay images and are left out.
std::string live_data(const ReportPage& page);

/// The script, without its tag.
const char* live_script();

}  // namespace foucault::page
