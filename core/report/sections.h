/// @file The parts of the report; each is empty where there is nothing to tell.
#pragma once

#include <string>

#include "core/report/html_report.h"

namespace ca2 {

std::string verdict_section(const ReportInput& input);
std::string transforms_section(const Calibration& calibration);
std::string sensors_section(const Calibration& calibration);
std::string evidence_section(const ReportInput& input);
std::string views_section(const ReportInput& input);
std::string pictures_section(const ReportInput& input);
std::string provenance_section(const ReportInput& input);

}  // namespace ca2
