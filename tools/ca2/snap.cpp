/// @file `ca2 snap SOURCE FILE.png`: one picture of a camera, as it is.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "core/io/files.h"
#include "tools/ca2/camera_source_text.h"
#include "tools/ca2/command.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/number_in.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string source;
  std::filesystem::path output;
  std::string imager;
  int skip = 0;
  double timeout = 10;  // s
};

/// The picture after `skip` others of that stream.
Result<CameraFrame> take(CameraSource& camera, int stream, const Options& options) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(options.timeout));
  const auto controls = camera.controls();
  const auto mode = controls.find("trigger");
  const bool triggered = mode != controls.end() && mode->second.value == "software";
  const Interrupt interrupt;
  int left = options.skip;
  bool ask = triggered;
  while (Clock::now() < end && !Interrupt::raised()) {
    if (ask) {
      if (auto fired = camera.trigger(); !fired) return fail(fired.error());
      ask = false;
    }
    CameraPoll poll = camera.next(std::chrono::milliseconds(200));
    switch (poll.event) {
      case CameraEvent::frame:
        if (poll.frame.stream != stream) break;
        if (left-- == 0) return std::move(poll.frame);
        ask = triggered;
        break;
      case CameraEvent::lost:
        return fail(ErrorCode::unavailable, options.source, poll.reason);
      case CameraEvent::end:
        return fail(ErrorCode::unavailable, options.source, "has no further pictures");
      case CameraEvent::stopped:
        return fail(ErrorCode::unavailable, options.source, "interrupted");
      case CameraEvent::timeout:
        break;
    }
  }
  if (Interrupt::raised()) return fail(ErrorCode::unavailable, options.source, "interrupted");
  const CameraCounters counters = camera.counters();
  return fail(
      ErrorCode::unavailable, options.source,
      "no picture came in time; " + std::to_string(counters.incomplete) + " came damaged",
      "`--timeout`; damaged ones on a network: larger receive buffers (net.core.rmem_max) and packets (MTU)");
}

Result<int> run(const Options& options) {
  auto source = parse_camera_source(options.source);
  if (!source) return fail(source.error());
  // As a rig's `source` names it, or by the option.
  std::string imager = options.imager;
  if (const auto named = source->extract("imager"); !named.empty()) {
    if (!imager.empty() && imager != named.mapped()) {
      return fail(ErrorCode::usage, "", "--imager " + imager + " and imager=" + named.mapped() + " differ");
    }
    imager = named.mapped();
  }
  const auto camera = open_camera(*source);
  if (!camera) return fail(camera.error());
  const auto stream = find_stream(**camera, imager);
  if (!stream) return fail(stream.error());
  if (auto started = (*camera)->start(); !started) return fail(started.error());
  for (const std::string& warning : (*camera)->warnings()) std::fprintf(stderr, "ca2: %s\n", warning.c_str());
  const auto frame = take(**camera, *stream, options);
  (*camera)->stop();
  if (!frame) return fail(frame.error());
  const Image& image = *frame->image;
  if (auto written = write_png(options.output, image); !written) return fail(written.error());
  std::printf("%s: %d x %d, %s, %d bits, %s\n", options.output.c_str(), image.width, image.height,
              image.channels == 1 ? "grey" : "colour", image.bits, (*camera)->description().c_str());
  return 0;
}

}  // namespace

CommandBody setup_snap(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("source", options->source, "The camera: driver:option=value,option=value")->required();
  app.add_option("output", options->output, "FILE.png, replaced if it is there")->required();
  app.add_option("--imager", options->imager, "Which one, of a device that has several");
  app.add_option("--skip", options->skip, "Pictures before it, while automatics settle")
      ->check(number_in(0, 100000));
  app.add_option("--timeout", options->timeout, "Seconds to wait for the picture")
      ->capture_default_str()
      ->check(seconds());
  app.footer(camera_drivers_help());
  return [options] { return run(*options); };
}

}  // namespace ca2
