#include "drivers/net/pcap_reader.h"

#include <gtest/gtest.h>

#include "tests/drivers/net/frames.h"
#include "tests/drivers/net/read_all.h"

namespace ca2 {
namespace {

using namespace ca2::test;

std::unique_ptr<PcapReader> reader_of(const Bytes& file, const PcapOptions& options = {}) {
  auto reader = PcapReader::open_memory(file, "capture", options);
  EXPECT_TRUE(reader) << (reader ? "" : reader.error().text());
  return reader ? std::move(*reader) : nullptr;
}

const Bytes payload = pattern(100);
const Bytes packet = ipv4({}, udp(5000, 7502, payload));

struct LinkCase {
  const char* name;
  std::uint32_t link_type;
  Bytes frame;
};

class LinkTypes : public testing::TestWithParam<LinkCase> {};

TEST_P(LinkTypes, LeadToTheSameDatagram) {
  const Bytes file = pcap(GetParam().link_type, {{12, 345678, GetParam().frame}});
  const auto reader = reader_of(file);
  const auto all = read_all(*reader);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].payload, payload);
  EXPECT_EQ(all[0].source_port, 5000);
  EXPECT_EQ(all[0].destination_port, 7502);
  EXPECT_EQ(all[0].time, 12'345'678'000);
  EXPECT_FALSE(all[0].truncated);
  EXPECT_EQ(reader->counters().lost(), 0u);
  EXPECT_EQ(reader->counters().datagrams, 1u);
  EXPECT_EQ(reader->counters().bytes, 100u);
}

TEST_P(LinkTypes, SurviveTruncationAtEveryByte) {
  for (std::size_t size = 0; size < GetParam().frame.size(); ++size) {
    const Bytes cut(GetParam().frame.begin(), GetParam().frame.begin() + static_cast<std::ptrdiff_t>(size));
    const Bytes file = pcap(GetParam().link_type, {{0, 0, cut, static_cast<int>(GetParam().frame.size())}});
    const auto reader = reader_of(file);
    for (const KeptDatagram& datagram : read_all(*reader)) {
      // Only Ethernet's padding may go unnoticed.
      EXPECT_EQ(datagram.truncated, datagram.payload.size() < payload.size());
      EXPECT_TRUE(datagram.truncated || size >= GetParam().frame.size() - 6);
    }
    const PacketCounters& counters = reader->counters();
    EXPECT_EQ(counters.records, 1u);
    EXPECT_EQ(counters.datagrams + counters.bad_headers + counters.not_ip, 1u) << "at " << size;
  }
}

const Bytes packet_v6 = ipv6("fe80::7", "ff02::1", 17, udp(5000, 7502, payload));

INSTANTIATE_TEST_SUITE_P(
    All, LinkTypes,
    testing::Values(LinkCase{"ethernet", 1, ethernet(0x0800, packet)},
                    LinkCase{"ethernet_v6", 1, ethernet(0x86dd, packet_v6)},
                    LinkCase{"padded", 1, ethernet(0x0800, packet + Bytes(6, 0))},
                    LinkCase{"vlan", 1, ethernet(0x8100, be16(42) + be16(0x0800) + packet)},
                    LinkCase{"qinq", 1,
                             ethernet(0x88a8, be16(1) + be16(0x8100) + be16(42) + be16(0x0800) + packet)},
                    LinkCase{"cooked", 113, Bytes(14, 0) + be16(0x0800) + packet},
                    LinkCase{"cooked_v6", 113, Bytes(14, 0) + be16(0x86dd) + packet_v6},
                    LinkCase{"cooked2", 276, be16(0x0800) + Bytes(18, 0) + packet},
                    LinkCase{"null_little_endian", 0, Bytes{2, 0, 0, 0} + packet},
                    LinkCase{"null_big_endian", 0, Bytes{0, 0, 0, 30} + packet_v6},
                    LinkCase{"loop", 108, Bytes{0, 0, 0, 2} + packet}, LinkCase{"raw", 101, packet},
                    LinkCase{"raw_v6", 101, packet_v6}, LinkCase{"ipv4", 228, packet},
                    LinkCase{"ipv6", 229, packet_v6}),
    [](const auto& chosen) { return chosen.param.name; });

TEST(PcapReader, ReadsBothResolutionsAndByteOrders) {
  const std::vector<Record> records{{1'700'000'000, 123'456, ethernet(0x0800, packet)}};
  for (const bool big_endian : {false, true}) {
    const Bytes us_file = pcap(1, records, 0xa1b2c3d4, big_endian);
    const Bytes ns_file = pcap(1, records, 0xa1b23c4d, big_endian);
    EXPECT_EQ(read_all(*reader_of(us_file)).at(0).time, 1'700'000'000'123'456'000);
    EXPECT_EQ(read_all(*reader_of(ns_file)).at(0).time, 1'700'000'000'000'123'456);
  }
}

TEST(PcapReader, FillsBatchesInOrder) {
  std::vector<Record> records;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    records.push_back({i, 0, ethernet(0x0800, ipv4({}, udp(1, 2, pattern(40 + i % 7, i))))});
  }
  const Bytes file = pcap(1, records);
  const auto all = read_all(*reader_of(file));
  ASSERT_EQ(all.size(), 1000u);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(all[i].time, i * std::int64_t{1'000'000'000});
    EXPECT_EQ(all[i].payload, pattern(40 + i % 7, i));
  }
}

TEST(PcapReader, FiltersByPortAndSource) {
  std::vector<Record> records;
  for (const char* source : {"192.0.2.7", "192.0.2.8"}) {
    for (const unsigned port : {7502u, 7503u}) {
      Ipv4Fields fields;
      fields.source = source;
      records.push_back({0, 0, ethernet(0x0800, ipv4(fields, udp(1, port, pattern(10))))});
    }
  }
  const Bytes file = pcap(1, records);
  PcapOptions options;
  options.ports = {7503};
  options.sources = {"192.0.2.8"};
  const auto reader = reader_of(file, options);
  const auto all = read_all(*reader);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].source_address, "192.0.2.8");
  EXPECT_EQ(all[0].destination_port, 7503);
  EXPECT_EQ(reader->counters().other_source, 2u);
  EXPECT_EQ(reader->counters().other_port, 1u);
}

TEST(PcapReader, RefusesASourceThatIsNoAddress) {
  PcapOptions options;
  options.sources = {"os-122.local", "192.0.2.8", "300.1.1.1"};
  const auto reader = PcapReader::open_memory(pcap(1, {}), "capture", options);
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::usage);
  EXPECT_EQ(reader.error().problems.size(), 2u) << "every wrong one is named";
}

TEST(PcapReader, BelievesTheCaptureWhereLengthsDisagree) {
  Ipv4Fields long_ip;
  long_ip.length = 1234;  // what VeloView's files say of every packet
  Ipv4Fields no_length;
  no_length.length = 0;  // segmentation offload
  const Bytes short_udp = be16(1) + be16(8308) + be16(0) + be16(0) + payload;
  const Bytes file = pcap(1, {{0, 0, ethernet(0x0800, ipv4(long_ip, udp(1, 8308, payload)))},
                              {0, 0, ethernet(0x0800, ipv4(no_length, udp(1, 8308, payload)))},
                              {0, 0, ethernet(0x0800, ipv4({}, short_udp))}});
  const auto reader = reader_of(file);
  const auto all = read_all(*reader);
  ASSERT_EQ(all.size(), 3u);
  for (const KeptDatagram& datagram : all) {
    EXPECT_EQ(datagram.payload, payload);
    EXPECT_FALSE(datagram.truncated);
  }
  EXPECT_EQ(reader->counters().length_mismatches, 2u);
}

TEST(PcapReader, MarksWhatTheHeadersPromiseButIsNotThere) {
  Bytes longer = udp(1, 2, payload);
  longer[5] = static_cast<std::uint8_t>(longer[5] + 50);
  const Bytes file = pcap(1, {{0, 0, ethernet(0x0800, ipv4({}, longer))}});
  const auto reader = reader_of(file);
  const auto all = read_all(*reader);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_TRUE(all[0].truncated);
  EXPECT_EQ(reader->counters().cut_short, 1u);
  EXPECT_EQ(reader->counters().length_mismatches, 1u);
}

TEST(PcapReader, CountsWhatIsNotUdpOverIp) {
  Ipv4Fields tcp;
  tcp.protocol = 6;
  const Bytes file = pcap(1, {{0, 0, ethernet(0x0806, Bytes(28, 0))},
                              {0, 0, ethernet(0x0800, ipv4(tcp, Bytes(40, 0)))},
                              {0, 0, ethernet(0x0800, Bytes(40, 0))},
                              {0, 0, ethernet(0x0800, ipv4({}, be16(1) + be16(2) + be16(7) + be16(0)))},
                              {0, 0, Bytes(5, 0)}});
  const auto reader = reader_of(file);
  EXPECT_TRUE(read_all(*reader).empty());
  EXPECT_EQ(reader->counters().not_ip, 1u);
  EXPECT_EQ(reader->counters().not_udp, 1u);
  EXPECT_EQ(reader->counters().bad_headers, 3u);
  EXPECT_EQ(reader->counters().lost(), 5u);
}

TEST(PcapReader, ReassemblesMixedFragmentsOfBothFamilies) {
  const Bytes big = pattern(24'896, 1), other = pattern(12'608, 2), big_v6 = pattern(8'448, 3);
  Ipv4Fields first, second;
  second.source = "192.0.2.8";
  const auto pieces = ipv4_fragments(first, udp(1, 7502, big), 1480);
  const auto others = ipv4_fragments(second, udp(1, 7502, other), 1480);
  const Bytes whole_v6 = udp(1, 7502, big_v6);
  std::vector<Record> records;
  for (std::size_t i = 0; i < std::max(pieces.size(), others.size()); ++i) {
    const auto time = static_cast<std::uint32_t>(i);
    if (i < pieces.size()) records.push_back({0, time, ethernet(0x0800, pieces[pieces.size() - 1 - i])});
    if (i < others.size()) records.push_back({0, time, ethernet(0x0800, others[i])});
  }
  for (std::size_t at = 0; at < whole_v6.size(); at += 1448) {
    const std::size_t end = std::min(at + 1448, whole_v6.size());
    const Bytes piece(whole_v6.begin() + static_cast<std::ptrdiff_t>(at),
                      whole_v6.begin() + static_cast<std::ptrdiff_t>(end));
    records.push_back({0, 100 + static_cast<std::uint32_t>(at),
                       ethernet(0x86dd, ipv6("fe80::7", "fe80::1", 44,
                                             ipv6_fragment(17, static_cast<unsigned>(at),
                                                           end < whole_v6.size(), 0xabcdef01, piece)))});
  }
  const Bytes file = pcap(1, records);
  const auto reader = reader_of(file);
  const auto all = read_all(*reader);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].payload, other);
  EXPECT_EQ(all[0].source_address, "192.0.2.8");
  EXPECT_EQ(all[1].payload, big);
  EXPECT_EQ(all[1].time, (static_cast<std::int64_t>(pieces.size()) - 1) * 1000) << "the last fragment's";
  EXPECT_EQ(all[2].payload, big_v6);
  EXPECT_EQ(all[2].source_address, "fe80::7");
  EXPECT_EQ(reader->counters().reassembled, 3u);
  EXPECT_EQ(reader->counters().lost(), 0u);
}

TEST(PcapReader, CountsALastRecordThatWasCutOff) {
  const Bytes whole = pcap(1, {{1, 0, ethernet(0x0800, packet)}, {2, 0, ethernet(0x0800, packet)}});
  const std::size_t record = (whole.size() - 24) / 2;
  for (std::size_t cut = 1; cut < record; ++cut) {
    const Bytes file(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(cut));
    const auto reader = reader_of(file);
    EXPECT_EQ(read_all(*reader).size(), 1u);
    EXPECT_EQ(reader->counters().cut_records, 1u);
  }
}

TEST(PcapReader, SaysWhereAFileIsDamagedAfterWhatWasGood) {
  Bytes file = pcap(1, {{1, 0, ethernet(0x0800, packet)}, {2, 0, ethernet(0x0800, packet)}});
  const std::size_t second = 24 + (file.size() - 24) / 2;
  std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(second) + 8, 4, std::uint8_t{0xff});  // its length
  Error error(ErrorCode::internal, "", "none");
  const auto reader = reader_of(file);
  EXPECT_EQ(read_all(*reader, &error).size(), 1u);
  EXPECT_EQ(error.code, ErrorCode::data);
  EXPECT_NE(error.text().find("record 2"), std::string::npos) << error.text();
}

TEST(PcapReader, RefusesWhatIsNoCapture) {
  for (const Bytes& file : {Bytes{}, Bytes{1, 2, 3}, pattern(1000)}) {
    const auto reader = PcapReader::open_memory(file, "capture");
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, ErrorCode::data);
    EXPECT_EQ(reader.error().problems[0].where, "capture");
  }
  const auto usb = PcapReader::open_memory(pcap(189, {}), "capture");
  ASSERT_FALSE(usb);
  EXPECT_NE(usb.error().text().find("link type"), std::string::npos);
  const auto missing = PcapReader::open("/nonexistent/file.pcap");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::io);
}

TEST(PcapReader, EndsAnEmptyFileAtOnceAndStaysAtTheEnd) {
  const Bytes file = pcap(1, {});
  const auto reader = reader_of(file);
  for (int i = 0; i < 3; ++i) {
    const auto batch = reader->next_batch();
    ASSERT_TRUE(batch);
    EXPECT_EQ(batch->event, PacketEvent::end);
  }
}

}  // namespace
}  // namespace ca2
