#include <array>

#include "core/export/exporter.h"

namespace ca2 {

#define CA2_EXPORTER(name, help) Result<ExportFiles> export_##name(const ExportRequest& request);
#include "core/export/exporters.def"
#undef CA2_EXPORTER

std::span<const Exporter> exporters() {
  static constexpr std::array list{
#define CA2_EXPORTER(name, help) Exporter{#name, help, &export_##name},
#include "core/export/exporters.def"
#undef CA2_EXPORTER
  };
  return list;
}

const Exporter* find_exporter(std::string_view name) {
  for (const Exporter& exporter : exporters()) {
    if (exporter.name == name) return &exporter;
  }
  return nullptr;
}

}  // namespace ca2
