#pragma once

#include "foucault/page/report_page.h"
#include "jobs/learn_job.h"

namespace foucault::app {

/// Learned against told noise, how sure it is, and predictions before and after.
page::ReportPage learn_page(const LearnResult& result);

}  // namespace foucault::app
