#pragma once
// Many studies at once, and what they say together: all public headers of this module.

#include "dynasurf/cohort/cases.hpp"
#include "dynasurf/cohort/claims.hpp"
#include "dynasurf/cohort/cohort_page.hpp"
#include "dynasurf/cohort/cohort_statistics.hpp"
#include "dynasurf/cohort/collect.hpp"
#include "dynasurf/cohort/job_key.hpp"
#include "dynasurf/cohort/statistics.hpp"
#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"
