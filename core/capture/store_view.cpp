#include "core/capture/store_view.h"

#include "core/capture/view_builder.h"
#include "core/features/search.h"
#include "core/session/view_writer.h"

namespace ca2 {
namespace {

const Pick* pick_of(const StoreView& view, const std::string& lidar) {
  const auto pick = view.picks.find(lidar);
  return pick == view.picks.end() ? nullptr : &pick->second;
}

}  // namespace

Result<ViewSights> store_view(Session& session, StoreView& view, const StoreProgress& progress) {
  progress(StoreStep::saving);
  Result<ViewWriter> writer = ViewWriter::begin(session.directory, view.id, view.details);
  if (!writer) return fail(writer.error());
  std::vector<SensorFile> files;
  const auto add_file = [&](const std::string& sensor, bool is_image, std::uint64_t content) {
    SensorFile& file = files.emplace_back();
    file.view = session.views.size();
    file.sensor = sensor;
    file.is_image = is_image;
    file.content = content;
  };
  for (const auto& [name, image] : view.images) {
    const auto content = writer->add(name, image, PngData::stored);
    if (!content) return fail(content.error());
    add_file(name, true, *content);
  }
  for (const auto& [name, scans] : view.scans) {
    std::vector<const Scan*> pointers;
    for (const auto& scan : scans) pointers.push_back(scan.get());
    const auto content = writer->add(name, pointers);
    if (!content) return fail(content.error());
    add_file(name, false, *content);
  }
  Result<SessionView> written = writer->finish();
  if (!written) return fail(written.error());
  for (SensorFile& file : files)
    file.path = (file.is_image ? written->images : written->clouds).at(file.sensor);
  session.views.push_back(std::move(*written));
  progress(StoreStep::searching);
  // It is on the disk: what has been searched is let go of, the largest first.
  for (SensorFile& file : files) {
    if (file.is_image) continue;
    file.pick = pick_of(view, file.sensor);
    std::vector<std::shared_ptr<const Scan>> scans = std::move(view.scans.at(file.sensor));
    view.scans.erase(file.sensor);
    if (scans.size() > 1) scans = {std::make_shared<const Scan>(gathered_scan(std::move(scans)))};
    search_cloud(file, session.rig.board, *scans.front());
  }
  for (SensorFile& file : files) {
    if (!file.is_image) continue;
    search_image(file, session.rig.board, view.images.at(file.sensor));
    view.images.erase(file.sensor);
  }
  keep_found(session, files);
  return view_sights(session, std::move(files));
}

}  // namespace ca2
