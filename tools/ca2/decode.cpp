/// `ca2 decode FILE.pcap --output DIR`: a recording's packets as points.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/files.h"
#include "core/types/counted.h"
#include "drivers/lidar/capture_doubts.h"
#include "drivers/lidar/lidar_driver.h"
#include "drivers/net/ip_address.h"
#include "drivers/net/pcap_reader.h"
#include "tools/ca2/command.h"
#include "tools/ca2/number_in.h"
#include "tools/ca2/print_warnings.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, VelodyneAzimuth> azimuths{{"auto", VelodyneAzimuth::published},
                                                      {"times", VelodyneAzimuth::times},
                                                      {"veloview", VelodyneAzimuth::veloview},
                                                      {"blocks", VelodyneAzimuth::blocks}};

struct DecodeOptions {
  fs::path file, metadata, calibration, output;
  std::string model, source, format = "csv", azimuth = "auto";
  int port = 0;
  bool single = false, json = false;
};

/// Writes scans as they come: one CSV for all, or a PCD each.
class ScanWriter {
 public:
  static Result<ScanWriter> create(const fs::path& directory, bool csv) {
    std::error_code error;
    fs::create_directories(directory, error);
    if (error) return fail(ErrorCode::cannot_create, directory.string(), error.message());
    return ScanWriter(directory, csv);
  }

  Result<void> write(LidarScan& scan) {
    points_ += scan.scan.size();
    const std::size_t number = scans_++;
    if (rows_) {
      if (const Result<void> open = open_rows(); !open) return open;
      write_rows(scan, number);
      return {};
    }
    for (std::size_t i = 0; i < scan.scan.size(); ++i) {
      scan.scan.points[i] = scan.exact[i].point.cast<float>();
      scan.scan.range[i] = static_cast<float>(scan.exact[i].range);
    }
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.pcd", number);
    return write_pcd(directory_ / name, scan.scan);
  }

  Result<void> finish() {
    if (!csv_) return {};
    const bool good = std::ferror(csv_.get()) == 0 && std::fclose(csv_.release()) == 0;
    if (!good)
      return fail(ErrorCode::io, (directory_ / "scans.csv").string(), "writing failed", "is the disk full?");
    return {};
  }

  std::size_t scans() const { return scans_; }
  std::size_t points() const { return points_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  ScanWriter(fs::path directory, bool rows) : directory_(std::move(directory)), rows_(rows) {}

  /// With the first scan: what holds none leaves no file, and an earlier one as it is.
  Result<void> open_rows() {
    if (csv_) return {};
    const fs::path file = directory_ / "scans.csv";
    csv_.reset(std::fopen(file.c_str(), "w"));
    if (!csv_) return fail(ErrorCode::cannot_create, file.string(), std::strerror(errno));
    std::fputs("scan,ring,column,timestamp_ns,range_m,x,y,z,intensity\n", csv_.get());
    return {};
  }

  void write_rows(const LidarScan& scan, std::size_t number) {
    for (std::size_t i = 0; i < scan.scan.size(); ++i) {
      const ExactReturn& exact = scan.exact[i];
      std::fprintf(csv_.get(), "%zu,%u,%u,%lld,%.10g,%.10g,%.10g,%.10g,%.9g\n", number, scan.scan.ring[i],
                   scan.scan.column[i], static_cast<long long>(scan.scan.time[i]), exact.range,
                   exact.point.x(), exact.point.y(), exact.point.z(), scan.scan.intensity[i]);
    }
  }

  fs::path directory_;
  bool rows_;  ///< of one CSV, not a file per scan
  std::unique_ptr<std::FILE, Close> csv_;
  std::size_t scans_ = 0, points_ = 0;
};

/// Reads the whole file through the driver.
Result<PacketCounters> read_through(const DecodeOptions& options, LidarDriver& driver,
                                    const LidarSink& sink) {
  PcapOptions pcap;
  if (options.port != 0) pcap.ports.push_back(static_cast<std::uint16_t>(options.port));
  auto reader = PcapReader::open(options.file, pcap);
  if (!reader) return fail(reader.error());
  const bool progress = isatty(STDERR_FILENO) != 0;
  while (true) {
    const Result<PacketBatch> batch = (*reader)->next_batch();
    if (!batch) return fail(batch.error());
    if (batch->event == PacketEvent::end) break;
    for (const Datagram& datagram : batch->datagrams) driver.push(datagram, sink);
    if (progress) {
      std::fprintf(stderr, "\r%llu datagrams, %llu scans",
                   static_cast<unsigned long long>(driver.counters().datagrams),
                   static_cast<unsigned long long>(driver.counters().frames));
    }
  }
  driver.flush(sink);
  if (progress) std::fputs("\r\033[K", stderr);
  return (*reader)->counters();
}

Result<LidarDriver> open_driver(const DecodeOptions& options) {
  LidarModelSpec spec;
  spec.model = options.model;
  spec.metadata = options.metadata;
  spec.calibration = options.calibration;
  LidarDriverOptions driver;
  if (const auto source = parse_ip_address(options.source)) driver.source_address = source->text();
  driver.one_source = true;
  driver.second_returns = !options.single;
  driver.exact = true;
  driver.streamed_calibration = true;
  driver.azimuth = azimuths.at(options.azimuth);
  return LidarDriver::open(spec, driver);
}

/// An HDL-64E without a calibration file sends it: the recording is read once for it alone.
Result<void> find_calibration(const DecodeOptions& options, LidarDriver& driver) {
  if (driver.ready()) return {};
  if (const auto read = read_through(options, driver, [](LidarScan&&) {}); !read) return fail(read.error());
  driver.reset_counters();
  if (driver.ready()) return {};
  return fail(
      ErrorCode::config, options.file.string(),
      "the angles of a " + driver.model() + " are per unit, and this recording does not carry them whole",
      "give --calibration with the sensor's db.xml, or the YAML made from it");
}

void print_summary(const DecodeOptions& options, const LidarDriver& driver, const ScanWriter& writer) {
  if (options.json) {
    nlohmann::ordered_json json{
        {"model", driver.model()}, {"scans", writer.scans()}, {"points", writer.points()}};
    for (const LidarCounterInfo& info : lidar_counter_table()) {
      json["counters"][std::string(info.name)] = driver.counters().*info.value;
    }
    std::puts(json.dump(2).c_str());
    return;
  }
  std::printf("%s: %s, %s\n", driver.model().c_str(), counted(writer.scans(), "scan").c_str(),
              counted(writer.points(), "point").c_str());
  for (const LidarCounterInfo& info : lidar_counter_table()) {
    const auto count = static_cast<unsigned long long>(driver.counters().*info.value);
    if (count > 0) std::printf("%12llu  %s\n", count, std::string(info.help).c_str());
  }
}

Result<int> run(const DecodeOptions& options) {
  if (options.metadata.empty() == options.model.empty()) {
    return fail(
        ErrorCode::usage, "",
        options.model.empty() ? "decode needs to know the sensor" : "--metadata and --model name two sensors",
        "give --metadata (Ouster) or --model (Velodyne)");
  }
  if (!options.source.empty() && !parse_ip_address(options.source)) {
    return fail(ErrorCode::usage, "--source", "'" + options.source + "' is not a numeric address",
                "write it like 192.168.1.201");
  }
  Result<LidarDriver> driver = open_driver(options);
  if (!driver) return fail(driver.error());
  if (const Result<void> found = find_calibration(options, *driver); !found) return fail(found.error());
  Result<ScanWriter> writer = ScanWriter::create(options.output, options.format == "csv");
  if (!writer) return fail(writer.error());
  Result<void> written;
  const auto sink = [&](LidarScan&& scan) {
    if (written) written = writer->write(scan);
  };
  const Result<PacketCounters> packets = read_through(options, *driver, sink);
  if (!packets) return fail(packets.error());
  if (!written) return fail(written.error());
  if (const Result<void> finished = writer->finish(); !finished) return fail(finished.error());
  print_summary(options, *driver, *writer);
  const std::vector<Problem> doubts = capture_doubts(options.file.string(), *driver, *packets);
  if (writer->scans() == 0) return fail(ErrorCode::data, doubts);
  print_warnings(doubts);
  return 0;
}

}  // namespace

CommandBody setup_decode(CLI::App& app) {
  auto options = std::make_shared<DecodeOptions>();
  app.add_option("file", options->file, "Capture file (pcap or pcapng)")->required();
  app.add_option("--metadata", options->metadata, "Ouster: the sensor's metadata JSON");
  app.add_option("--model", options->model,
                 "Velodyne: VLP-16, Puck-Hi-Res, VLP-32C, HDL-32E, HDL-64E, VLS-128");
  app.add_option("--calibration", options->calibration,
                 "Velodyne: db.xml or YAML; an HDL-64E needs it or streams it");
  app.add_option("--output", options->output, "Directory for scans.csv or 000000.pcd, ...")->required();
  app.add_option("--format", options->format, "csv or pcd")->check(CLI::IsMember({"csv", "pcd"}));
  app.add_option("--source", options->source, "Only packets from this address");
  app.add_option("--port", options->port, "Only packets to this UDP port")->check(number_in(1, 65535));
  app.add_flag("--single", options->single, "Leave second returns out");
  app.add_option(
         "--azimuth", options->azimuth,
         "Velodyne, between encoder readings: `times` where the beam was when it fired; `veloview` that as\n"
         "VeloView rounds it (0.005 degree off); `blocks` as the ROS drivers compute it (up to 0.4 degree "
         "off);\n"
         "auto: what the model's published clouds are made with, `blocks` for a VLS-128 and a VLP-16's dual\n"
         "returns, else `veloview`. Calibration always uses `times`.")
      ->check(CLI::IsMember({"auto", "times", "veloview", "blocks"}));
  app.add_flag("--json", options->json, "Print the summary as JSON");
  return [options] { return run(*options); };
}

}  // namespace ca2
