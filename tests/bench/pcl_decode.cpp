// Velodyne packets to points: ours and the point cloud library's grabbers, on one capture in one run.
// Optional (CA2_BENCH_PCL): pcl_io drags a whole visualisation toolkit along, which `ca2` must not link.
//   pcl_decode VLP-16 capture.pcap     pcl_decode HDL-32E capture.pcap
#include <pcl/io/hdl_grabber.h>
#include <pcl/io/vlp_grabber.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>

#include "drivers/lidar/lidar_driver.h"
#include "drivers/net/pcap_reader.h"

namespace {

using Packets = std::vector<std::vector<std::uint8_t>>;

double cpu_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

/// The grabbers' decoding without their threads and queues. It is private, but naming a private member is
/// allowed in an explicit instantiation.
struct Names : pcl::HDLGrabber {
  using Packet = HDLDataPacket;
};
using Decode = void (pcl::HDLGrabber::*)(Names::Packet*);
Decode private_decode();
template <Decode member>
struct Expose {
  friend Decode private_decode() { return member; }
};
template struct Expose<&pcl::HDLGrabber::toPointClouds>;

double time_pcl(pcl::HDLGrabber& grabber, const Packets& packets) {
  const double start = cpu_ns();
  for (const auto& bytes : packets) {
    Names::Packet packet;
    std::memcpy(&packet, bytes.data(), bytes.size());
    (grabber.*private_decode())(&packet);
  }
  return cpu_ns() - start;
}

double time_ours(ca2::LidarDriver& driver, const Packets& packets, std::size_t& points) {
  points = 0;
  const ca2::LidarSink sink = [&](ca2::LidarScan&& scan) { points += scan.scan.size(); };
  const double start = cpu_ns();
  for (const auto& bytes : packets) {
    ca2::Datagram datagram;
    datagram.payload = bytes;
    driver.push(datagram, sink);
  }
  driver.flush(sink);
  return cpu_ns() - start;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: pcl_decode VLP-16|HDL-32E capture.pcap\n"), 64;
  const std::string model = argv[1];
  Packets packets;
  auto reader = ca2::PcapReader::open(argv[2]);
  while (reader) {
    const auto batch = (*reader)->next_batch();
    if (!batch || batch->event == ca2::PacketEvent::end) break;
    for (const ca2::Datagram& datagram : batch->datagrams) {
      if (datagram.payload.size() == 1206)
        packets.emplace_back(datagram.payload.begin(), datagram.payload.end());
    }
  }
  const std::unique_ptr<pcl::HDLGrabber> grabber =
      model == "VLP-16" ? std::make_unique<pcl::VLPGrabber>(argv[2])
                        : std::make_unique<pcl::HDLGrabber>(std::string(), std::string(argv[2]));
  std::vector<double> ours, theirs;
  std::size_t points = 0;
  // Both keep their memory from one pass to the next, as they do day and night.
  auto driver = ca2::LidarDriver::open({model, {}, {}, 0, 0});
  if (!driver) return std::fprintf(stderr, "%s\n", driver.error().text().c_str()), 78;
  time_ours(*driver, packets, points);
  time_pcl(*grabber, packets);
  for (int i = 0; i < 9; ++i) {
    ours.push_back(time_ours(*driver, packets, points) / static_cast<double>(points));
    theirs.push_back(time_pcl(*grabber, packets) / static_cast<double>(points));
  }
  std::sort(ours.begin(), ours.end());
  std::sort(theirs.begin(), theirs.end());
  std::printf("%s, %zu packets, %zu returns: ours %.2f ns, PCL %.2f ns per return, %.1f times\n",
              model.c_str(), packets.size(), points, ours[4], theirs[4], theirs[4] / ours[4]);
  return points > 0 ? 0 : 65;
}
